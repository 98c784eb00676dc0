"""What was found, in the engines: each law acts there as it does in CAM, wherever it enters."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from analytic.effects import Acting, acting
from analytic.motion import FloatArray
from analytic.rig import Rig
from harness.engines.health import Failure
from harness.engines.parameters import EngineParameters
from harness.errors import EngineFailure
from harness.failures import Failures
from harness.identify.estimate.fit import Fit, fit
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.problem import PreparedRecording, Problem
from harness.identify.problem.settings import DEFAULT
from harness.identify.problem.spline_term import KINDS, Kind, Regressor, SplineTerm, blank
from harness.identify.validation.engine_errors import engine_errors, entries
from harness.identify.validation.engine_run import _Scene
from harness.identify.validation.held_out import HeldOut, errors
from tests.own_scenes import crank_and_link, written
from tests.posed import Posed

SECONDS = 6.0


@pytest.fixture(scope="module")
def short(plain: Posed) -> Problem:
    """The first seconds of one recording; nothing acts in it beyond what is declared."""
    record = plain.problem.recordings[0]
    first = record.time - record.time[0] < SECONDS
    return replace(
        plain.problem, recordings=(PreparedRecording("first", record.time[first], record.reading[first], record.drive),)
    )


@pytest.fixture(scope="module")
def base(short: Problem) -> Fit:
    """The model as declared."""
    return fit(short, Hypothesis(()))


def supposed(base: Fit, effects: Sequence[Acting] = (), spline: SplineTerm | None = None, phase: float = 0.0) -> Fit:
    """A model with effects that are not there, so that it predicts wrongly by what they do."""
    at = replace(base.terms, effects=tuple(effects), spline=spline, phases=np.array([phase]))
    return replace(base, hypothesis=Hypothesis(tuple(one.effect.name for one in effects), spline), terms=at)


def spline_term(problem: Problem, kind: Kind) -> SplineTerm:
    """A law that varies by its own size over what the recording visits, a periodic one five times as fast."""
    known = problem.recordings[0].reading[np.isfinite(problem.recordings[0].reading)]
    low, high = {
        Regressor.POSITION: (known.min(), known.max()),
        Regressor.VELOCITY: (-0.2, 0.2),
        Regressor.ANGLE: (-0.05, 0.05),
        Regressor.ROLL_ANGLE: (0.0, 2.0 * np.pi),
        Regressor.TIME: (0.0, SECONDS),
    }[kind.depends]
    high = low + (high - low) / (5.0 if kind.periodic else 1.0)
    nodes = np.sin(np.arange(DEFAULT.spline_nodes)) * (0.004 if kind.friction or kind.sensor else 0.02)
    return replace(blank(kind, float(low), float(high)), nodes=nodes)


def agree(problem: Problem, base: Fit, found: Fit) -> None:
    """Hold the engines' errors to CAM's, over every horizon.

    CAM takes steps of 10 ms and leaves 2 µm in 10 s, the engines of 4 ms sixteen times the 1 µm that those of 1 ms
    leave (README), less in 6 s; where friction stops the ball their steps round the stop off by c g h²/2, below a
    micrometre. What remains of a difference is the state from which a window begins, the same for both, and corners
    that the engines' beam rounds: 1 % and 20 µm hold them all.
    """
    cam = errors(problem, found, problem.recordings).rms
    plain = errors(problem, base, problem.recordings).rms
    assert cam["whole"] > 3.0 * plain["whole"], "the effect must be felt for this to say anything"
    for name, run in engine_errors(HeldOut(problem, base, found, problem.recordings)).items():
        assert set(run["after"]["rms_m"]) == set(cam)
        for horizon, value in cam.items():
            assert run["after"]["rms_m"][horizon] == pytest.approx(value, rel=1e-2, abs=2e-5), (name, horizon)
            assert run["before"]["rms_m"][horizon] == pytest.approx(plain[horizon], rel=1e-2, abs=2e-5), (name, horizon)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "values", "enters"),
    [
        ("rolling_resistance", {"coefficient": 0.006}, "force on the ball"),
        ("ball_imbalance", {"offset": 1e-4}, "force on the ball"),
        ("level_error", {"angle": 0.002}, "force on the ball, as a tilt of gravity gives it"),
        ("rolling_radius", {"radius": 0.0105}, "the scene's geometry"),
        ("angle_gain", {"gain": 1.05}, "angle of the driven beam"),
        ("linkage_backlash", {"width": 0.01}, "angle of the driven beam"),
        ("channel_delay", {"delay": 0.03}, "sensor side: the stamps at which the ball is read"),
        ("position_gain", {"gain": 1.05}, "sensor side: what is recorded of the position"),
        ("position_lag", {"time_constant": 0.05}, "sensor side: what is recorded of the position"),
    ],
)
def test_an_effect_does_the_same_in_the_engines(
    short: Problem, base: Fit, name: str, values: dict[str, float], enters: str
) -> None:
    """Predict with both engines as wrongly as CAM does with an effect that is not there, and say where it enters."""
    found = supposed(base, [acting(name, values)], phase=0.7)
    assert entries(found) == {name: enters}
    agree(short, base, found)


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_a_spline_term_is_the_same_in_the_engines(short: Problem, base: Fit, kind: Kind) -> None:
    """Predict with both engines as wrongly as CAM does with an unlisted law, of a force, a friction or the sensor."""
    found = supposed(base, spline=spline_term(short, kind), phase=0.7)
    enters = "friction on the ball" if kind.friction else "force on the ball"
    assert entries(found) == {
        "spline term": enters if not kind.sensor else "sensor side: what is recorded of the position"
    }
    agree(short, base, found)


def test_an_engine_that_fails_says_so(short: Problem, base: Fit) -> None:
    """Put the message in place of the figures where the ball leaves the rails."""
    found = supposed(base, [acting("angle_gain", {"gain": 10.0})])
    for run in engine_errors(HeldOut(short, base, found, short.recordings)).values():
        assert run["after"]["rms_m"] == {}
        assert "failed at t" in run["after"]["failed"]
        assert run["before"]["rms_m"]


def test_a_run_that_fails_costs_its_horizon_alone(short: Problem, base: Fit, monkeypatch: pytest.MonkeyPatch) -> None:
    """Lose the error of the whole recording, and of no shorter window, where its run fails; no engine is to blame."""
    undisturbed = engine_errors(HeldOut(short, base, base, short.recordings))

    def run(scene: _Scene, parameters: EngineParameters, state: FloatArray, at: FloatArray, *rest: Any) -> FloatArray:
        if at[-1] - at[0] > 3.5:  # [s]: of the 4 s after the known ones, and no window of 3 s
            raise EngineFailure(scene.engine.name, Failure.RAN_OFF, float(at[-1]), "s = 20.00 m")
        return ran(scene, parameters, state, at, *rest)

    ran, failures = _Scene._run, Failures()
    monkeypatch.setattr(_Scene, "_run", run)
    for name, one in engine_errors(HeldOut(short, base, base, short.recordings), failures=failures).items():
        expected = dict(undisturbed[name]["before"]["rms_m"])
        assert expected.pop("whole") > 0.0
        assert one["before"]["rms_m"] == pytest.approx(expected, rel=1e-3)
        assert "s = 20.00 m" in one["before"]["failed"]
    assert failures.all == ()


def test_a_run_that_fails_is_tried_in_finer_steps(short: Problem, base: Fit, monkeypatch: pytest.MonkeyPatch) -> None:
    """Take the engine's own step where the ball loses its contacts in wider ones."""

    def run(scene: _Scene, parameters: EngineParameters, *rest: Any) -> FloatArray:
        if parameters.time_step > 1e-3:
            raise EngineFailure(scene.engine.name, Failure.LOST_CONTACT, 0.0, "0 contacts")
        return ran(scene, parameters, *rest)

    ran = _Scene._run
    monkeypatch.setattr(_Scene, "_run", run)
    for one in engine_errors(HeldOut(short, base, base, short.recordings)).values():
        assert "whole" in one["before"]["rms_m"]
        assert "failed" not in one["before"]


def test_an_engine_that_fails_in_windows_is_to_blame(
    short: Problem, base: Fit, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Count it as a failure where shorter windows than the whole recording fail, too."""

    def run(scene: _Scene, *_: Any) -> FloatArray:
        raise EngineFailure(scene.engine.name, Failure.LOST_CONTACT, 0.0, "0 contacts")

    monkeypatch.setattr(_Scene, "_run", run)
    failures = Failures()
    for one in engine_errors(HeldOut(short, base, base, short.recordings), failures=failures).values():
        assert one["before"]["rms_m"] == {}
    assert [each.name for each in failures.all] == ["pybullet on first", "mujoco on first"]


def test_a_ball_that_lifts_off_is_not_tried_again(short: Problem, base: Fit, monkeypatch: pytest.MonkeyPatch) -> None:
    """Run every window once where its ball lifts off, which no step changes."""
    steps = set()

    def run(scene: _Scene, parameters: EngineParameters, *_: Any) -> FloatArray:
        steps.add(parameters.time_step)
        raise EngineFailure(scene.engine.name, Failure.LIFTED_OFF, 0.0, "it lifts off")

    monkeypatch.setattr(_Scene, "_run", run)
    failures = Failures()
    engine_errors(HeldOut(short, base, base, short.recordings), failures=failures)
    assert len(steps) == 1
    assert failures.all == ()


def test_a_linkage_that_gives_way_is_told(short: Problem, base: Fit, tmp_path: Path) -> None:
    """Warn once by how much the beam of the user's scene departs from the recorded angle, and only in that engine."""
    soft = crank_and_link(Rig()).replace('solref="0.002 1" solimp="0.9999 0.9999 0.001"', "")
    scene = written(tmp_path, soft, beam_joint="beam_hinge", driven_joint="motor")
    split = HeldOut(short, base, base, short.recordings)
    runs = engine_errors(split, scene=scene)
    (told,) = [text for text in runs["mujoco"]["warnings"] if "linkage" in text]
    assert re.search(r"depart from the recorded angle by up to 0\.000\d+ rad", told)
    assert runs["pybullet"]["warnings"] == ()
    assert engine_errors(split)["mujoco"]["warnings"] == ()


def test_of_many_recordings_the_engines_run_six(short: Problem, base: Fit) -> None:
    """Run the first, the last and what lies evenly between, held out in the same recordings, and name them."""
    many = tuple(replace(short.recordings[0], name=f"{number}") for number in range(11))
    whole = HeldOut(replace(short, recordings=many), base, base, many)
    held = [replace(whole, compared=many[first::6]) for first in range(6)]
    for run in engine_errors(whole, held).values():
        assert run["recordings"] == ["0", "2", "4", "6", "8", "10"]
        # The recordings are the same one under many names, so any mean over them is that of one.
        assert run["heldout"]["before"]["rms_m"] == pytest.approx(run["before"]["rms_m"])


def test_a_part_of_a_recording_drifts_from_the_begin_of_the_whole(plain: Posed, base: Fit) -> None:
    """Predict as CAM does in the last seconds of a recording, in which a drift has long begun."""
    record = plain.problem.recordings[0]
    late = record.time > record.time[-1] - SECONDS
    last = PreparedRecording("last", record.time[late], record.reading[late], record.drive)
    problem = replace(plain.problem, recordings=(last,))
    # of the 10 s before these a drift that begins with them would lose 5 mrad, 16 cm after 3 s
    agree(problem, base, supposed(base, [acting("level_drift", {"rate": 5e-4})]))
