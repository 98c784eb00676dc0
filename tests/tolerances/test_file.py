"""What may stand in a tolerances.toml, and what is said of what may not."""

from __future__ import annotations

from pathlib import Path

import pytest

from harness.comparison import Choices
from harness.errors import InputError
from harness.metrics import METRICS
from harness.recording.case import BUNDLED
from harness.tolerances import read_tolerances, tolerances_for
from harness.tolerances.limits import DIFFERENCES


def written(folder: Path, text: str) -> Path:
    """A file of these limits."""
    path = folder / "limits.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_one_line_is_one_limit(tmp_path: Path) -> None:
    """Read source, horizon, metric and value from a table's head and a line below it."""
    limits = read_tolerances(
        written(tmp_path, '[mujoco.whole]\nmax_error_m = 0.02\n[cam."2 s"]\nrms_error_mm = 5\n')
    ).limits
    assert [str(limit) for limit in limits] == [
        "mujoco whole: max_error_m <= 0.02 m",
        "cam 2 s: rms_error_mm <= 5 mm",
    ]
    assert [limit.seconds for limit in limits] == [None, 2.0]


@pytest.mark.parametrize("spelling", ["2s", '"2 s"', '"2.0 s"', '"2s"'])
def test_windows_may_be_spelled_freely(tmp_path: Path, spelling: str) -> None:
    """Take `2s` and `"2 s"` for the same windows."""
    (limit,) = read_tolerances(written(tmp_path, f"[cam.{spelling}]\nmax = 0.1\n")).limits
    assert limit.horizon == "2 s"


def test_the_guide_shows_a_file_that_can_be_read(tmp_path: Path) -> None:
    """Read the example of docs/tolerances.md as it stands."""
    guide = (Path(__file__).parents[2] / "docs" / "tolerances.md").read_text(encoding="utf-8")
    example = guide.partition("```toml\n")[2].partition("```")[0]
    assert len(read_tolerances(written(tmp_path, example)).limits) == 5


def test_every_metric_can_be_limited_by_name_and_alias(tmp_path: Path) -> None:
    """Accept every column of metrics.csv, and each of its aliases, as the same metric."""
    for metric in METRICS.values():
        for name in (metric.name, *metric.aliases):
            (limit,) = read_tolerances(written(tmp_path, f"[cam.whole]\n{name} = 1\n")).limits
            assert limit.metric is metric


def test_engines_can_be_held_against_cam(tmp_path: Path) -> None:
    """Read limits against CAM for the free run and, one table deeper, for windows."""
    text = '[mujoco.against_cam]\nmax_difference_m = 2e-5\n[mujoco.against_cam."2 s"]\nrms = 1e-6\n'
    limits = read_tolerances(written(tmp_path, text)).limits
    assert [str(limit) for limit in limits] == [
        "mujoco against_cam: max_difference_m <= 2e-05 m",
        "mujoco against_cam 2 s: rms_difference_m <= 1e-06 m",
    ]
    assert all(limit.against_cam and limit.metric in DIFFERENCES.values() for limit in limits)


@pytest.mark.parametrize(
    ("text", "named"),
    [
        ("[mujocco.whole]\nmax = 1\n", ["mujocco", "mujoco", "pybullet", "cam"]),
        ("[mujoco.whole]\nmax_eror_m = 1\n", ["[mujoco.whole]", "max_eror_m", "max_error_m"]),
        ("[mujoco.hole]\nmax = 1\n", ["[mujoco.hole]", "whole", "against_cam"]),
        ("[mujoco.2.5s]\nmax = 1\n", ["[mujoco.2]", "Quote a length"]),
        ('[mujoco."0 s"]\nmax = 1\n', ['[mujoco."0 s"]', "not a horizon"]),
        ("[mujoco]\nmax_error_m = 1\n", ["[mujoco] max_error_m", "[mujoco.whole]"]),
        ("mujoco = 1\n", ["mujoco is not a table", "[mujoco.whole]"]),
        ("[mujoco.whole]\nmax_difference_m = 1\n", ["[mujoco.whole] max_difference_m", "[mujoco.against_cam]"]),
        ("[mujoco.against_cam]\nmax_error_m = 1\n", ["[mujoco.against_cam]", "max_error_m", "max_difference_m"]),
        ("[cam.against_cam]\nmax = 1\n", ["[cam.against_cam]", "itself"]),
        ("[mujoco]\nagainst_cam = 1\n", ["[mujoco.against_cam] is not a table"]),
        ("[mujoco.whole]\nmax = '1 mm'\n", ["[mujoco.whole] max", "'1 mm'", "not a number"]),
        ("[mujoco.whole]\nmax = true\n", ["[mujoco.whole] max", "not a number"]),
        ("[mujoco.whole]\nmax = nan\n", ["[mujoco.whole] max", "finite"]),
        ("[mujoco.whole]\nmax = -1\n", ["[mujoco.whole] max", "cannot be satisfied"]),
        ("[mujoco.whole]\nlag = -1\n", ["[mujoco.whole] lag", "cannot be satisfied"]),
        ('[cam."2 s"]\nmax = 1\n[cam.2s]\nmax_error_m = 2\n', ["cam 2 s", "max_error_m", "two limits"]),
        ("[tube]\ntolerance_mm = 1\n[cam.whole]\nmax = 1\n", ["[tube]", "tolerance_mm", "tolerance_m"]),
        ("[tube]\ntolerance_m = 0\n[cam.whole]\nmax = 1\n", ["[tube] tolerance_m", "metres"]),
        ("tube = 0.01\n[cam.whole]\nmax = 1\n", ["tube is not a table"]),
        ("# nothing\n", ["sets no limit"]),
        ("[cam.whole\nmax = 1\n", ["not valid TOML", "line 1"]),
    ],
)
def test_what_cannot_be_is_named_with_its_place(tmp_path: Path, text: str, named: list[str]) -> None:
    """Name file, table and invalid entry, and list the valid ones."""
    path = written(tmp_path, text)
    with pytest.raises(InputError) as caught:
        read_tolerances(path)
    assert str(caught.value).startswith(f"{path}: ")
    assert all(word in str(caught.value) for word in named), str(caught.value)


def test_a_limit_from_below_may_be_negative(tmp_path: Path) -> None:
    """Allow a fit of at least −50 %: fits are negative where a model is worse than the mean."""
    (limit,) = read_tolerances(written(tmp_path, "[cam.whole]\nfit = -50\n")).limits
    assert str(limit) == "cam whole: fit_percent >= -50 %"


def test_limits_ask_for_their_windows_and_tube(tmp_path: Path) -> None:
    """Have the study run the windows that are limited, beside those asked for, with the file's tube."""
    tolerances = read_tolerances(written(tmp_path, '[tube]\ntolerance_m = 0.004\n[cam."0.5 s"]\ntube = 0.05\n'))
    choices = tolerances.applied_to(Choices(lengths=(2.0,)))
    assert (choices.lengths, choices.tolerance) == ((0.5, 2.0), 0.004)


def test_a_named_file_wins_over_the_case_and_the_case_over_the_package(tmp_path: Path) -> None:
    """Look for limits in the file named, then in the case, then in the package, and say where they are from."""
    named = written(tmp_path, "[cam.whole]\nmax = 1\n")
    case = tmp_path / "case"
    case.mkdir()
    assert tolerances_for(case).chosen == "defaults of the package"
    (case / "tolerances.toml").write_text("[cam.whole]\nmax = 2\n", encoding="utf-8")
    assert tolerances_for(case).path == case / "tolerances.toml"
    assert tolerances_for(case / "rig.toml").path == case / "tolerances.toml"
    assert tolerances_for(case / "swing.csv").chosen == "defaults of the package"
    assert tolerances_for(case, named).path == named


def test_the_package_sets_limits_on_its_default_engines() -> None:
    """Ship limits on MuJoCo and PyBullet, for the bundled case and for any other."""
    for case in (BUNDLED, BUNDLED.parent):
        assert set(tolerances_for(case).engines) == {"mujoco", "pybullet"}
    assert tolerances_for(BUNDLED).chosen == "of the case"
