"""`harness.comparison`: tables, plot, report, all from one object and none of them unasked."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pandas as pd
import pytest

import harness
from tests.acceptance.short import write_short_case


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A short case."""
    return write_short_case(tmp_path_factory.mktemp("compare") / "case")


@pytest.fixture(scope="module")
def comparison(folder: Path) -> harness.Comparison:
    """Its first recording through one engine, with a parameter of it set."""
    return harness.compare(folder, settings={"pybullet": {"time_step": 0.002}}, engines=["pybullet"], windows=[1.0])


def test_scores_and_trajectories_are_tables(comparison: harness.Comparison) -> None:
    """Give a row a source and horizon, and a column a source."""
    scores, trajectories = comparison.scores, comparison.trajectories
    assert set(scores["horizon"]) == {"whole", "1 s"}
    assert {"cam", "pybullet"} <= set(scores["source"])
    assert list(trajectories.columns[:2]) == ["time_s", "measured_m"]
    assert f"{scores['source'].iloc[0]}_m" in trajectories.columns


def test_it_shows_itself(comparison: harness.Comparison) -> None:
    """Say which model to trust, and how far each is off, as text and as HTML."""
    for shown in (repr(comparison), comparison._repr_html_()):
        assert "pybullet" in shown
        assert "RMS" in shown
    assert comparison.answer[0] in " ".join(repr(comparison).split())


def test_it_is_plotted(comparison: harness.Comparison) -> None:
    """Draw the recording against every source."""
    figure = comparison.plot()
    assert figure.axes[0].get_ylabel() == "ball position s [m]"
    assert any("PyBullet" in text.get_text() for text in figure.legends[0].get_texts())


@pytest.mark.slow
def test_it_is_saved(comparison: harness.Comparison, tmp_path: Path) -> None:
    """Write what the command writes, with the numbers that the tables have."""
    out = comparison.save(tmp_path / "out")
    assert {file.name for file in out.iterdir()} == {"report.html", "trajectories.csv", "metrics.csv", "manifest.json"}
    written = pd.read_csv(out / "trajectories.csv")
    # Written to the micrometre.
    pd.testing.assert_frame_equal(written, comparison.trajectories, check_exact=False, atol=0.51e-6, rtol=0.0)
    manifest = json.loads((out / "manifest.json").read_text(encoding="utf-8"))
    assert manifest["command"] == ""  # of the process that called, nothing is known
    assert manifest["settings"]["engines"]["pybullet"]["time_step"] == 0.002


def test_nothing_is_said_and_nothing_written_unasked(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Print nothing, and leave the working folder as it was."""
    monkeypatch.chdir(tmp_path)
    harness.compare(folder, engines=["pybullet"], windows=[1.0])
    assert capsys.readouterr() == ("", "")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"tube": float("nan")}, "tube: nan is not a finite length"),
        ({"windows": [1.0, float("inf")]}, "windows: inf is not a finite length"),
        ({"seed": -1}, "seed: -1 is negative"),
        ({"settings": {"pybullet": {"time_step": 1e-12}}}, r"pybullet\.time_step is 1e-12 s: .* GB of memory"),
    ],
)
def test_a_number_that_cannot_be_is_refused(folder: Path, options: dict[str, Any], said: str) -> None:
    """Raise an error before anything is computed."""
    with pytest.raises(harness.InputError, match=said):
        harness.compare(folder, **options)


def test_a_bad_setting_raises_the_message_of_the_command(folder: Path) -> None:
    """Raise an error that names what there is."""
    with pytest.raises(harness.InputError, match=r"mujoco has no parameter 'frction'\. Did you mean 'friction'"):
        harness.compare(folder, settings={"mujoco": {"frction": 0.3}})
