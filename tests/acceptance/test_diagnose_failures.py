"""Whatever an engine, a candidate or a section cannot do: the user gets the diagnosis, the reason, and exit code 3."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from harness.engines.mujoco import MuJoCo
from harness.engines.protocol import EngineRun
from harness.engines.pybullet import PyBullet
from harness.simulator import Experiment, write_case
from tests.acceptance.conftest import Harness, Outcome

pytestmark = pytest.mark.slow

HIDDEN = "rolling_resistance"


def raising(error: Exception) -> Any:
    """A function that takes anything and raises."""

    def fail(*_: Any, **__: Any) -> Any:
        raise error

    return fail


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two recordings of 5 s of a ball that rolls with resistance, and one to predict."""
    folder = tmp_path_factory.mktemp("failing") / "case"
    write_case(folder, Experiment(hidden={HIDDEN: {"coefficient": 0.004}}, duration=5.0))
    return folder


@pytest.fixture
def broken(case: Path, harness: Harness, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Outcome:
    """`harness diagnose` where something fails in every part."""
    from harness.api.saved import LoadedDiagnosis
    from harness.identify import diagnosis
    from harness.identify.selection import candidates
    from harness.report.diagnosis import SECTIONS

    def not_finite(engine: PyBullet, *arguments: Any, **options: Any) -> EngineRun:
        found = original_run(engine, *arguments, **options)
        return replace(found, trajectory=replace(found.trajectory, position=found.trajectory.position * np.nan))

    def screen(problem: Any, hypothesis: Any, *arguments: Any, **options: Any) -> Any:
        if "track_bump" in hypothesis.names:
            raise np.linalg.LinAlgError("SVD did not converge")
        return original_screen(problem, hypothesis, *arguments, **options)

    original_run, original_screen = PyBullet.run, candidates.screen
    monkeypatch.setattr(MuJoCo, "drive", raising(RuntimeError("no display")))
    monkeypatch.setattr(PyBullet, "run", not_finite)
    monkeypatch.setattr(candidates, "screen", screen)
    monkeypatch.setattr(diagnosis, "on_held_out", raising(ZeroDivisionError("division by zero")))
    monkeypatch.setattr(diagnosis, "compare_with_baselines", raising(FloatingPointError("overflow")))
    monkeypatch.setattr(diagnosis, "_next_experiment", raising(IndexError("list index out of range")))
    monkeypatch.setattr(LoadedDiagnosis, "_predicted", raising(OSError("disk")))
    monkeypatch.setitem(SECTIONS, "residual_acceleration", raising(KeyError("angle")))
    return harness("diagnose", case, "--out", tmp_path / "out")


@pytest.mark.filterwarnings("ignore:invalid value")
def test_failures_cost_their_own_part_and_are_told(broken: Outcome, case: Path, tmp_path: Path) -> None:
    """Find the effect, write json and report with all that worked, name every failure in both and on stderr: exit 3."""
    assert broken.code == 3
    folder = tmp_path / "out"
    found = json.loads((folder / "diagnosis.json").read_text(encoding="utf-8"))
    page = (folder / "diagnosis.html").read_text(encoding="utf-8")

    assert found["verdict"] == "effect"
    assert "held-out errors could not be computed" in found["sentence"]
    assert [one["name"] for one in found["effects"]] == [HIDDEN]
    low, high = (found["effects"][0]["parameters"]["coefficient"][end] for end in ("low", "high"))
    assert low < 0.004 < high
    assert not any("track_bump" in one["tried"] for one in found["ledger"])

    told = {
        "engine": "RuntimeError: no display",
        "candidate": "LinAlgError: SVD did not converge",
        "validation": "ZeroDivisionError: division by zero",
        "baselines": "FloatingPointError: overflow",
        "next_experiment": "IndexError: list index out of range",
        "prediction": "OSError: disk",
        "report": "KeyError: 'angle'",
    }
    for part, message in told.items():
        assert any(one["part"] == part and message in one["message"] for one in found["failures"]), part
        assert any(message in line for line in broken.errors), part
        assert message.replace("'", "&#39;") in page, part
    assert all(line.startswith("error: ") for line in broken.errors)
    assert "Traceback" not in broken.err
    # what raised is named by file and line, as it may be a fault of the program
    for part in ("engine", "candidate", "report"):
        places = [one["where"] for one in found["failures"] if one["part"] == part]
        assert any(place.startswith("test_diagnose_failures.py, line") for place in places), part

    for engine, message in {"mujoco": "no display", "pybullet": "not a finite number"}.items():
        for run in (found["errors"]["engines"][engine], found["errors"]["engines"][engine]["heldout"]):
            assert run["after"]["rms_m"] == {}
            assert message in run["after"]["failed"]
    assert found["baselines"] is found["next_experiment"] is None
    assert found["errors"]["heldout"]["after"]["rms_m"] == {}
    assert found["errors"]["identify"]["after"]["rms_m"]["1 s"] > 0.0
    assert not (folder / "prediction_rec_03.csv").exists()

    # the section that raised says so; the others are there
    assert 'id="failed-residual_acceleration"' in page
    for anchor in ("verdict", "errors", "rivals", "ledger", "inputs"):
        assert f'<section id="{anchor}"' in page
    assert page.count("SVD did not converge") >= 2  # at the top, and beside the ledger
    assert "not tried since something failed, hence neither found nor excluded: " in page
    assert page.index("Not everything worked") < page.index('<section id="verdict"')


def test_an_incomplete_diagnosis_is_read_and_predicts(broken: Outcome, case: Path, tmp_path: Path) -> None:
    """Read the file that failures are in, name them, and find the rest of its ledger reproduced."""
    import harness as package

    kept = package.load_diagnosis(tmp_path / "out")
    assert {one.part for one in kept.failures} >= {"engine", "candidate", "baselines"}
    assert "SVD did not converge" in repr(kept)
    assert package.replay(kept, case).reproduced


def test_an_engine_that_is_not_installed_costs_its_own_errors(
    case: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Give the other engine's errors, and say how the missing one is installed."""
    from harness.engines.catalogue import engine_of
    from harness.errors import InputError
    from harness.failures import Failures
    from harness.identify.estimate.fit import fit
    from harness.identify.pose import problem_of
    from harness.identify.problem.hypothesis import Hypothesis
    from harness.identify.validation import engine_errors as module
    from harness.identify.validation.held_out import HeldOut
    from harness.recording import load_case

    def without_mujoco(name: str) -> Any:
        if name == "mujoco":
            raise InputError("engine mujoco cannot be loaded; install its requirements")
        return engine_of(name)

    monkeypatch.setattr(module, "engine_of", without_mujoco)
    problem = problem_of(load_case(case))
    base, failures = fit(problem, Hypothesis(())), Failures()
    found = module.engine_errors(HeldOut(problem, base, base, problem.recordings), failures=failures)
    assert "install its requirements" in found["mujoco"]["before"]["failed"]
    assert found["pybullet"]["before"]["rms_m"]["1 s"] > 0.0
    (failure,) = failures.all
    assert (failure.part, failure.name, failure.where) == ("engine", "mujoco", "")
