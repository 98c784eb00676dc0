"""What `pytest --case DIR` shows a user. The bundled case's own limits are checked here, through the plugin.

The inner sessions run in this process: what they need is imported here, so that they meet it loaded.
"""

from __future__ import annotations

import functools
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from collections.abc import Callable
from pathlib import Path

import pytest

from harness.comparison import Study
from harness.recording.case import BUNDLED
from harness.tolerances import read_tolerances
from tests.tolerances.short_case import write_case

pytest_plugins = ["pytester"]

MakeCase = Callable[..., Path]

LIMITS = """
[mujoco.against_cam."1 s"]
max_difference_m = 5e-6  # validated for 10 s of a smooth motion

[pybullet.against_cam."1 s"]
max_difference_m = 2.5e-6

[cam."1 s"]
max_error_m = 0.0251  # as in the bundled case
"""
MUJOCO, PYBULLET, CAM = (
    "mujoco against_cam 1 s: max_difference_m <= 5e-06 m",
    "pybullet against_cam 1 s: max_difference_m <= 2.5e-06 m",
    "cam 1 s: max_error_m <= 0.0251 m",
)
SOFT = "mujoco.solref_timeconst=0.02"  # MuJoCo's own default, ten times this project's: strays by some 25 µm


@pytest.fixture(autouse=True)
def _warm(short_study: Study) -> None:
    """Everything an inner session imports late has been imported by a study of the outer one."""


@pytest.fixture
def make_case(pytester: pytest.Pytester) -> MakeCase:
    """Writes the short case into the folder `rig`, with these tolerances or with none of its own."""
    return functools.partial(write_case, Path("rig"))


def run(pytester: pytest.Pytester, *arguments: object) -> pytest.RunResult:
    """Run pytest in an empty folder."""
    return pytester.runpytest_inprocess("-p", "no:cacheprovider", *map(str, arguments))


@pytest.mark.slow
def test_the_bundled_case_keeps_its_limits(pytester: pytest.Pytester) -> None:
    """Keep every limit of the bundled case, also with the friction halved: a ball that rolls does not feel it."""
    count = len(read_tolerances(BUNDLED / "tolerances.toml").limits)
    result = run(pytester, "--case", "bundled", "--set", "mujoco.friction=0.25")
    result.assert_outcomes(passed=count)
    result.stdout.fnmatch_lines(
        [
            f"limits: {BUNDLED / 'tolerances.toml'} (of the case)",
            "*tolerances*",
            "set: mujoco.friction = 0.25 (default 0.5)",
            "kept  mujoco against_cam: max_difference_m <= * m *e-0* m *+* %",
            f"{count} of {count} limits kept",
        ]
    )


@pytest.mark.slow
@pytest.mark.parametrize("recording", ["rec_02.csv", "rec_03.csv"])
def test_the_other_bundled_recordings_keep_the_same_limits(pytester: pytest.Pytester, recording: str) -> None:
    """Keep every limit on every recording of the bundled case: they are derived from the rig, not from one of them."""
    result = run(pytester, "--case", BUNDLED, "--recording", recording)
    result.assert_outcomes(passed=len(read_tolerances(BUNDLED / "tolerances.toml").limits))


@pytest.mark.slow
def test_a_soft_contact_breaks_the_limit_against_cam(pytester: pytest.Pytester, make_case: MakeCase) -> None:
    """Show which limit a tweaked contact parameter breaks, with value, limit, margin and tweak, and no traceback."""
    result = run(pytester, "--case", make_case(tolerances=LIMITS), "--set", SOFT)
    result.assert_outcomes(passed=2, failed=1)
    assert result.ret == pytest.ExitCode.TESTS_FAILED
    result.stdout.fnmatch_lines(
        [
            f"_* {MUJOCO} _*",
            "*e-05 m, limit <= 5e-06 m, margin -* %",
            "set: mujoco.solref_timeconst = 0.02 (default None)",
            f"BROKEN  {MUJOCO} *e-05 m *-* %",
            f"kept    {PYBULLET} *",
            f"kept    {CAM} *",
            "1 of 3 limits broken",
            f"FAILED rig::{MUJOCO} - *",
        ]
    )
    result.stdout.no_fnmatch_line("*.py:*")


@pytest.mark.slow
def test_a_ball_that_slides_breaks_every_limit_on_its_engine(pytester: pytest.Pytester, make_case: MakeCase) -> None:
    """Name the engine's failure where friction is too low to roll: at 3° that takes more than 0.016."""
    result = run(pytester, "--case", make_case(tolerances=LIMITS), "--set", "mujoco.friction=0.001")
    result.assert_outcomes(passed=2, failed=1)
    result.stdout.fnmatch_lines(["mujoco failed at t = * s: *raise the friction coefficient*"])


@pytest.mark.slow
def test_an_angle_of_the_wrong_sense_breaks_the_limits_on_the_measurement(
    pytester: pytest.Pytester, make_case: MakeCase
) -> None:
    """Break CAM's limit where the recorded angle has the other sign, as eq. 3 and eq. 14 have."""
    result = run(pytester, "--case", make_case(tolerances=LIMITS, angle_factor=-1.0))
    result.assert_outcomes(passed=2, failed=1)
    result.stdout.fnmatch_lines([f"BROKEN  {CAM} *"])


def test_a_case_without_limits_gets_those_of_the_package(pytester: pytest.Pytester, make_case: MakeCase) -> None:
    """Hold the engines against CAM where a case brings no limits, and say that these are defaults."""
    result = run(pytester, "--case", make_case())
    result.assert_outcomes(passed=2)
    result.stdout.fnmatch_lines(["limits: * (defaults of the package)", "kept  mujoco against_cam 2 s: *"])


def test_a_settings_file_that_changes_the_rig_is_told(pytester: pytest.Pytester, make_case: MakeCase) -> None:
    """Name the quantities of the rig that the table [rig] of a settings file replaces."""
    settings = pytester.path / "tuned.toml"
    settings.write_text("[rig]\nlevel_angle_rad = 1e-4\n", encoding="utf-8")
    result = run(pytester, "--case", make_case(tolerances=LIMITS), "--parameters", settings)
    result.stdout.fnmatch_lines(["set: tuned.toml replaces quantities of the rig *: level angle 0.0001."])


def test_a_case_runs_alone_unless_tests_are_named(pytester: pytest.Pytester, make_case: MakeCase) -> None:
    """Leave the tests of the folder one stands in alone, and run them beside the limits where they are named."""
    pytester.makepyfile(test_mine="def test_mine(): pass")
    case = make_case(tolerances=LIMITS)
    alone = run(pytester, "--case", case, "--collect-only", "-q")
    alone.stdout.fnmatch_lines([f"rig::{MUJOCO}", f"rig::{PYBULLET}", f"rig::{CAM}", "3 tests collected in *"])
    both = run(pytester, "test_mine.py", "--case", case, "--collect-only", "-q")
    both.stdout.fnmatch_lines(["test_mine.py::test_mine", f"rig::{MUJOCO}", "4 tests collected in *"])


@pytest.mark.slow
def test_limits_are_chosen_by_word_and_by_engine(pytester: pytest.Pytester, make_case: MakeCase) -> None:
    """Run the limits that `-k` or `--engine` choose and say how many were not checked."""
    case = make_case(tolerances=LIMITS)
    by_word = run(pytester, "--case", case, "-k", "against_cam and mujoco")
    by_word.assert_outcomes(passed=1, deselected=2)
    by_word.stdout.fnmatch_lines(["2 of 3 limits not checked: 1 on pybullet, 1 on cam"])
    by_engine = run(pytester, "--case", case, "--engine", "mujoco", "-q")
    by_engine.assert_outcomes(passed=2, deselected=1)
    by_engine.stdout.fnmatch_lines(["1 of 3 limits not checked: 1 on pybullet"])


@pytest.mark.slow
def test_the_first_broken_limit_may_end_the_session(pytester: pytest.Pytester, make_case: MakeCase) -> None:
    """Stop at the first broken limit with `-x`, and list what was checked until then."""
    result = run(pytester, "--case", make_case(tolerances=LIMITS), "--set", SOFT, "-x")
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(["1 of 1 limits broken", "2 of 3 limits not checked: 1 on pybullet, 1 on cam"])


def test_junit_holds_value_limit_and_margin(pytester: pytest.Pytester, make_case: MakeCase) -> None:
    """Write value, limit and margin into JUnit's file, as properties of the test."""
    run(
        pytester, "--case", make_case(tolerances=LIMITS), "--engine", "mujoco", "--junitxml", "found.xml", "--set", SOFT
    )
    case = ElementTree.parse(pytester.path / "found.xml").getroot().find(f".//testcase[@name='{MUJOCO}']")
    assert case is not None
    properties = {one.attrib["name"]: one.attrib["value"] for one in case.iter("property")}
    value, limit = float(properties["value"]), float(properties["limit"])
    assert limit == 5e-6 < value
    assert float(properties["margin"]) == pytest.approx(1.0 - value / limit)
    assert case.find("failure") is not None


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--case", "nowhere"], "nowhere: there is no such file or folder*"),
        (
            ["--case", "RIG", "--set", "mujoco.frictoin=0.3"],
            "mujoco has no parameter 'frictoin'. Did you mean 'friction'?*",
        ),
        (["--case", "RIG", "--recording", "rec_9.csv"], "*there is no recording 'rec_9.csv'*"),
        (["--case", "RIG", "--tolerances", "nowhere.toml"], "nowhere.toml: there is no such file*"),
        (["--case", "RIG", "--engine", "dart"], "*sets no limit on dart*"),
        (["--case", "RIG", "--engine", "mujoco", "--set", "pybullet.contact_erp=0.1"], "*pybullet*does not run*"),
        (["--case", "RIG", "--tolerances", "long.toml"], "long.toml: cam 5 s: *no window of 5 s*"),
        (["--set", "mujoco.friction=0.3"], "--set needs --case*"),
    ],
)
def test_bad_input_is_a_usage_error(
    pytester: pytest.Pytester, make_case: MakeCase, arguments: list[str], message: str
) -> None:
    """Answer bad input with one clear message and pytest's exit code 4 before anything runs."""
    Path("long.toml").write_text('[cam."5 s"]\nmax_error_m = 1\n', encoding="utf-8")
    case = str(make_case(tolerances=LIMITS))
    result = run(pytester, *(case if argument == "RIG" else argument for argument in arguments))
    assert result.ret == pytest.ExitCode.USAGE_ERROR
    result.stderr.fnmatch_lines([f"ERROR: {message}"])
    assert "Traceback" not in result.stderr.str() + result.stdout.str()


def test_a_flat_rail_is_held_to_its_limits(pytester: pytest.Pytester, make_case: MakeCase) -> None:
    """Run the engines on a rig whose ball rolls on a plane, and answer with a table as for any other rig."""
    case = make_case(tolerances=LIMITS)
    text = (case / "rig.toml").read_text(encoding="utf-8")
    (case / "rig.toml").write_text(text.replace("= 0.0118", "= 0.0132"), encoding="utf-8")
    result = run(pytester, "--case", case)
    assert result.ret in (pytest.ExitCode.OK, pytest.ExitCode.TESTS_FAILED)
    result.stdout.fnmatch_lines([f"* {MUJOCO} *", f"* {PYBULLET} *"])


@pytest.mark.slow
def test_limits_spread_over_processes(pytester: pytest.Pytester, make_case: MakeCase) -> None:
    """Report the same table when pytest-xdist spreads the limits over two processes."""
    result = pytester.runpytest_subprocess("--case", str(make_case(tolerances=LIMITS)), "--set", SOFT, "-n", "2")
    result.assert_outcomes(passed=2, failed=1)
    result.stdout.fnmatch_lines([f"BROKEN  {MUJOCO} *", f"kept    {PYBULLET} *", f"kept    {CAM} *", "1 of 3 *broken"])


def test_other_sessions_are_left_alone(pytester: pytest.Pytester) -> None:
    """Change nothing and import no numerics without a case, as the plugin is loaded in every pytest run."""
    pytester.makepyfile(test_mine="def test_mine(): pass")
    result = run(pytester)
    result.assert_outcomes(passed=1)
    result.stdout.no_fnmatch_line("*tolerances*")
    heavy = "sorted({'numpy', 'scipy', 'numba', 'pydantic', 'mujoco', 'click'} & set(sys.modules))"
    code = f"import harness.pytest_plugin, sys; print({heavy})"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "[]"
