"""Paths for runs with few effects give bit for bit what the step for all effects gives."""

from __future__ import annotations

import math

import numpy as np
import pytest

from analytic import slots
from analytic.effects import Acting, acting, parameters_with
from analytic.kernel import Grid, integrate
from analytic.law import OF_SENSOR
from analytic.lean_step import DAMPED, DAMPED_DRY, DRY, GENERAL, SMOOTH, path_of
from analytic.models import CAM, CUM, CUM_LINEAR, MODELS, Model, coefficients
from analytic.motion import BeamMotion, FloatArray
from analytic.rig import Rig
from analytic.step import advance
from tests.motions import Fixed, Ramp, Sines

RIG = Rig(level_angle=0.002)
STAMPS = np.concatenate(([0.0], np.sort(np.random.default_rng(3).uniform(0.0, 10.0, 400)), [10.0]))
GRID = Grid.over(STAMPS)
VISCOUS, QUADRATIC = (acting(name, {"coefficient": 0.02}) for name in ("viscous_damping", "quadratic_drag"))
STRIBECK = acting(
    "stribeck_friction", {"static_coefficient": 0.02, "kinetic_coefficient": 0.004, "stribeck_velocity": 0.03}
)
DAMPINGS = ((VISCOUS,), (QUADRATIC,), (VISCOUS, QUADRATIC))
STARTS = np.array([(0.36, 0.05), (0.36, 0.0), (-0.2, -0.3), (0.0, 1.0)])
MOTIONS = {
    "sines": Sines(),
    "shaken so that the ball lifts off": Sines(((0.05, 40.0, 0.3),)),
    "at rest": Fixed(0.0),
    "ramp": Ramp(0.01, -0.05),
}


def stepwise(table: FloatArray, p: FloatArray, start: FloatArray) -> FloatArray:
    """s and ṡ at the stamps by `advance` alone, shape (n, 2)."""
    s, v, w = float(start[0]), float(start[1]), 0.0
    rows = [(s, v)]
    for begin, end in zip(GRID.marks[:-1], GRID.marks[1:], strict=True):
        for j in range(begin, end):
            s, v, w = advance(s, v, w, GRID.steps[j], table, 2 * j, p)
        rows.append((s, v))
    return np.array(rows)


def check(motion: BeamMotion, vectors: list[FloatArray]) -> None:
    """Compare every run of a batch of all vectors and starts with the step for all effects."""
    table = GRID.tabulate(motion)
    cases = [(p, start) for p in vectors for start in STARTS]
    runs = integrate(GRID, table, np.array([p for p, _ in cases]), np.array([start for _, start in cases]))
    for run, (p, start) in enumerate(cases):
        expected = stepwise(table, p, start)
        np.testing.assert_array_equal(runs.position[run], expected[:, 0])
        np.testing.assert_array_equal(runs.velocity[run], expected[:, 1])


@pytest.mark.parametrize("motion", MOTIONS.values(), ids=MOTIONS)
def test_smooth_path_is_the_general_step(motion: BeamMotion) -> None:
    """Give the models without friction, linear or not, at two level angles, the bits of the general step."""
    vectors = [coefficients(m, rig) for rig in (RIG, RIG.with_(level_angle=-0.01)) for m in (CAM, CUM, CUM_LINEAR)]
    assert {path_of(p) for p in vectors} == {SMOOTH}
    check(motion, vectors)


@pytest.mark.parametrize("motion", MOTIONS.values(), ids=MOTIONS)
def test_dry_path_is_the_general_step(motion: BeamMotion) -> None:
    """Stop, stick, start again and turn round with the bits of the general step, alike and unlike by direction."""
    terms: list[Acting] = [acting("rolling_resistance", {"coefficient": c}) for c in (1e-4, 0.003, 0.03)]
    terms.append(acting("directional_resistance", {"coefficient_plus": 0.004, "coefficient_minus": 0.012}))
    terms.append(STRIBECK)
    vectors = [parameters_with(CAM, RIG, [one]) for one in terms]
    assert {path_of(p) for p in vectors} == {DRY}
    check(motion, vectors)
    if isinstance(motion, Sines) and math.isclose(motion.evaluate(np.zeros(1))[0], Sines().evaluate(np.zeros(1))[0]):
        table = GRID.tabulate(motion)
        sticking = integrate(GRID, table, vectors[2], STARTS).velocity == 0.0
        assert 0.05 < sticking.mean() < 0.95  # the comparison is about stops as much as about motion


@pytest.mark.parametrize("motion", MOTIONS.values(), ids=MOTIONS)
def test_damped_path_is_the_general_step(motion: BeamMotion) -> None:
    """Slow down with the bits of the general step, by one law of the velocity or by both."""
    vectors = [parameters_with(model, RIG, one) for model in (CAM, CUM_LINEAR) for one in DAMPINGS]
    assert {path_of(p) for p in vectors} == {DAMPED}
    check(motion, vectors)


@pytest.mark.parametrize("motion", MOTIONS.values(), ids=MOTIONS)
def test_damped_dry_path_is_the_general_step(motion: BeamMotion) -> None:
    """Stop, stick and turn round with the bits of the general step where a damping acts beside a dry friction."""
    resistances = (
        acting("rolling_resistance", {"coefficient": 0.003}),
        acting("rolling_resistance", {"coefficient": 0.03}),
        acting("directional_resistance", {"coefficient_plus": 0.004, "coefficient_minus": 0.012}),
        STRIBECK,
    )
    vectors = [parameters_with(CAM, RIG, [dry, *one]) for dry in resistances for one in DAMPINGS]
    assert {path_of(p) for p in vectors} == {DAMPED_DRY}
    check(motion, vectors)


def test_negative_resistance_is_none() -> None:
    """Clip a coefficient below zero, which a fit may try, as the general step does."""
    p = coefficients(CAM, RIG)
    p[slots.DRY_PLUS], p[slots.DRY_MINUS] = -0.01, 0.01
    assert path_of(p) == DRY
    check(Sines(), [p])


@pytest.mark.parametrize(("name", "path"), [("none", SMOOTH), ("rolling_resistance", DRY)])
def test_an_error_of_the_sensor_moves_no_ball(name: str, path: int) -> None:
    """Leave a run on its lean path where a spline term says what the sensor makes of a position."""
    p = parameters_with(CAM, RIG, [] if name == "none" else [acting(name, {"coefficient": 0.01})])
    p[slots.SHAPE : slots.SHAPE_NODES + 4] = OF_SENSOR, -0.4, 0.3, 4.0, 1e-3, 2e-3, -1e-3, 3e-3
    assert path_of(p) == path
    check(Sines(), [p])


@pytest.mark.parametrize("model", MODELS.values(), ids=lambda model: model.name)
def test_friction_of_the_paper_takes_the_general_path(model: Model) -> None:
    """Keep the paper's laws of friction off the lean paths, which have no tanh."""
    assert (path_of(coefficients(model, RIG)) == GENERAL) is model.name.startswith("friction")


def test_every_slot_of_an_effect_decides_the_path() -> None:
    """Send a run to the general path for each slot whose effect the lean ones do not have."""
    dry = (slots.DRY_PLUS, slots.DRY_MINUS, slots.DRY_STATIC)
    lean = {**dict.fromkeys(dry, DRY), slots.VISCOUS: DAMPED, slots.QUADRATIC: DAMPED}
    switches = {slots.READING, *range(slots.VISCOUS, slots.SHAPE + 1)} - {slots.PHASE, slots.ORIGIN, slots.ROLL}
    for slot in sorted(switches - {slots.TURN, slots.STRIBECK_VELOCITY}):  # these five are no effect by themselves
        p = coefficients(CAM, RIG)
        p[slot] = 1.0
        assert path_of(p) == lean.get(slot, GENERAL), slot
    assert path_of(np.append(coefficients(CAM, RIG), np.zeros(slots.LAW_SLOTS))) == GENERAL


@pytest.mark.parametrize(
    ("name", "values", "path"),
    [
        ("rolling_resistance", {"coefficient": 0.01}, DRY),
        ("level_error", {"angle": 0.01}, SMOOTH),
        ("eccentric_pivot", {"eccentricity": 0.02}, SMOOTH),
        ("viscous_damping", {"coefficient": 0.01}, DAMPED),
        ("quadratic_drag", {"coefficient": 0.01}, DAMPED),
        ("contact_slip", {"friction_coefficient": 0.1}, GENERAL),
        ("beam_compliance", {"compliance": 0.01}, GENERAL),
    ],
)
def test_effects_take_the_path_that_has_them(name: str, values: dict[str, float], path: int) -> None:
    """Keep on the lean paths what changes a coefficient that they read, and nothing else."""
    assert path_of(parameters_with(CAM, RIG, [acting(name, values)])) == path
