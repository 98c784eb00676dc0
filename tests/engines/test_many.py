"""Runs side by side, in MuJoCo's own loop or not, are the runs that each variant has alone."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

import harness.engines.mujoco as mujoco_engine
from analytic.motion import State
from analytic.rig import Rig
from harness.engines.catalogue import engine_of, parameters_of
from harness.engines.health import Failure
from harness.engines.many import Variant, run_many
from harness.engines.protocol import EngineRun
from harness.errors import EngineFailure
from tests.motions import Sines

RIG, START = Rig(), State(0.36, 0.0)
STAMPS = np.linspace(0.0, 6.0, 301)  # more steps than one chunk of MuJoCo's own loop
MUJOCO = engine_of("mujoco")


def variant(settings: dict[str, object], **changes: object) -> Variant:
    """A run in MuJoCo with some settings changed."""
    kept = {"rig": RIG, "motion": Sines(), "start": START, "time": STAMPS}
    return Variant(**(kept | changes), parameters=parameters_of(MUJOCO, settings))  # type: ignore[arg-type]


VARIANTS = [
    variant({}),
    variant({"time_step": 5e-4, "friction": 0.1}),
    variant({"friction": 0.01}),  # slides
    variant({"solref_timeconst": 0.02, "margin": 0.0}, rig=RIG.with_(level_angle=-0.003)),
    variant({}, rig=Rig(rolling_radius=Rig.radius)),  # a scene with other sensors
    variant({"refsafe": False, "solref_timeconst": 1e-5}),  # explodes
    variant({}, start=State(20.0, 0.5)),  # runs off
    variant({}, motion=Sines(((0.1, 16.0 * math.pi, 0.0),))),  # is thrown off
]


def same(one: EngineRun | EngineFailure, other: EngineRun | EngineFailure) -> bool:
    """Whether two results agree in every bit."""
    if isinstance(one, EngineFailure) or isinstance(other, EngineFailure):
        return str(one) == str(other)
    return (
        np.array_equal(one.trajectory.position, other.trajectory.position)
        and np.array_equal(one.trajectory.velocity, other.trajectory.velocity)
        and np.array_equal(one.rolled_angle, other.rolled_angle)
        and one.health == other.health
    )


def test_variants_are_what_they_are_alone() -> None:
    """Return runs, failures and health of each variant in order, whoever ran beside it."""
    done: list[int] = []
    together, alone = run_many(MUJOCO, VARIANTS, workers=3, on_done=done.append), run_many(MUJOCO, VARIANTS)
    assert all(map(same, together, alone))
    failed = [one.failure if isinstance(one, EngineFailure) else None for one in alone]
    assert failed[:3] == [None, None, Failure.SLIPPED]
    assert failed[3:5] == [None, None]
    assert failed[6] is Failure.RAN_OFF
    assert None not in failed[5:]
    assert done == list(range(1, len(VARIANTS) + 1))


@pytest.mark.parametrize("one", VARIANTS, ids=range(len(VARIANTS)))
def test_own_loop_of_mujoco_is_steps_from_python(one: Variant, monkeypatch: pytest.MonkeyPatch) -> None:
    """Give the bits of the step loop, in sound runs and in those that MuJoCo resets or that stop early."""
    (natively,) = run_many(MUJOCO, [one])
    monkeypatch.setattr(mujoco_engine, "_natively", lambda *_: 0)
    (stepped,) = run_many(MUJOCO, [one])
    assert same(natively, stepped)


@pytest.mark.parametrize("name", ["mujoco", "pybullet"])
def test_forces_run_side_by_side_too(name: str) -> None:
    """Hand runs with an additional force, which is Python's, to processes, and a failure back from them."""
    engine = engine_of(name)

    def push(size: float) -> Callable[[float, float, float, float], float]:
        return lambda s, v, angle, t: size * v

    variants = [Variant(RIG, Sines(), START, STAMPS, force=push(size)) for size in (-0.02, -0.01, math.nan)]
    together, alone = run_many(engine, variants, workers=2), run_many(engine, variants)
    assert all(map(same, together, alone))
    assert isinstance(together[2], EngineFailure)
    assert not same(together[0], together[1])
