"""A force of any law in Python acts on the ball as written down, whatever one quantity it depends on."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from analytic.effects import CATALOGUE, Acting, Effect, EffectError, Force, Parameter, joined, parameters_with
from analytic.kernel import Grid, integrate
from analytic.law import acceleration, hermite
from analytic.models import CAM, coefficients
from analytic.motion import FloatArray, beam_states
from analytic.rig import Rig
from analytic.slots import LAW_NODES, ORIGIN, SLOTS
from tests.motions import Sines

RIG, MOTION = Rig(), Sines()
TIME = np.arange(0.0, 5.001, 0.01)
START = (0.36, 0.05)
SIZE = Parameter("size", "1", -1e3, 1e3, 1.0)


def acting(force: Force, size: float) -> Acting:
    """A nameless effect of one size."""
    return Acting(Effect("own", "F", (SIZE,), "here", force=force), {"size": size})


def cubic_spring(s: FloatArray, size: float) -> FloatArray:
    """−k (s − 0.3)³ [N]."""
    return -size * (s - 0.3) ** 3


def cubic_drag(v: FloatArray, size: float) -> FloatArray:
    """−c ṡ³ [N]."""
    return -size * v**3


def cable(angle: FloatArray, size: float) -> FloatArray:
    """F sin(20 α) [N]."""
    return size * np.sin(20.0 * angle)


def unbalance(rolled: FloatArray, size: float) -> FloatArray:
    """F sin φ [N]."""
    return size * np.sin(rolled)


LAWS: dict[str, tuple[Callable[..., FloatArray], float]] = {
    "position": (cubic_spring, 3.0),
    "velocity": (cubic_drag, 0.3),
    "angle": (cable, 0.01),
    "roll_angle": (unbalance, 0.01),
}


def run(*effects: Acting) -> FloatArray:
    """s of CAM with effects, the rolled angle counting from the start, shape (n,) [m]."""
    grid = Grid.over(TIME)
    vector = parameters_with(CAM, RIG, effects)
    vector[ORIGIN] = START[0]
    return integrate(grid, grid.tabulate(MOTION), vector, np.array([START])).position[0]


@pytest.mark.parametrize("by", LAWS)
def test_force_obeys_its_law(by: str) -> None:
    """Follow eq. 14 with the law typed anew, integrated adaptively."""
    law, size = LAWS[by]
    m, r, J = RIG.mass, RIG.rolling_radius, RIG.inertia

    def slope(t: float, y: FloatArray) -> tuple[float, float]:
        s, v = y
        angle, rate, angular = beam_states(MOTION, np.array([t]))[0].tolist()
        at = {"position": s, "velocity": v, "angle": angle, "roll_angle": (s - START[0]) / r}[by]
        right = m * RIG.gravity * math.sin(angle) + m * s * rate**2 + float(law(np.array(at), size))
        return v, (right - (m * (RIG.eccentricity + r) + J / r) * angular) / (J / r**2 + m)

    expected = solve_ivp(slope, (0.0, TIME[-1]), START, "DOP853", TIME, rtol=1e-11, atol=1e-12).y[0]
    assert np.max(np.abs(expected - run())) > 1e-3  # it matters
    # Between nodes a cubic is exact and sin(20 α), the worst of them, off by F (20 h)⁴/384 = 1e-9 N at h = 1/256; that
    # moves the ball by K/m × 1e-9 × t²/2 = 1e-7 m in 5 s. The kernel's step leaves 1e-9 m.
    np.testing.assert_allclose(run(acting(Force(by, law), size)), expected, atol=1e-7)


def test_a_force_of_the_rolled_angle_knows_how_the_ball_lay() -> None:
    """Count the rolled angle from φ₀ where the effect says that it matters, as the imbalance of a ball does."""
    effect = acting(Force("roll_angle", unbalance), 0.01)
    turned = replace(effect, effect=replace(effect.effect, turning=True))
    vector, bare = parameters_with(CAM, RIG, [turned], phase=0.7), coefficients(CAM, RIG)
    vector[ORIGIN] = START[0]
    state = (START[0] + 0.05, 0.1, 0.02, 0.0, 0.0)
    pushed = (acceleration(*state, vector) - acceleration(*state, bare)) / RIG.rolling_ratio * RIG.mass
    # nodes are 2π/256 apart: sin φ between them is off by h⁴/384 = 1e-9 of the force, slopes by as little
    expected = float(unbalance(np.array(0.05 / RIG.rolling_radius + 0.7), 0.01))
    assert pushed == pytest.approx(expected, abs=1e-9)


def test_error_between_nodes_falls_with_the_fourth_power_of_their_distance() -> None:
    """Stay within h⁴/384 of the fourth derivative, over a narrower range too."""
    at = np.linspace(-0.4, 0.4, 4001)
    for reach in (2.0, 1.0, 0.5):
        vector = parameters_with(CAM, RIG, [acting(Force("position", cable, (-reach, reach)), 1.0)])
        found = RIG.mass * np.array([hermite(s, SLOTS, vector) for s in at])
        h = 2.0 * reach / (LAW_NODES - 1)
        # Slopes are off by h⁴/30 of the fifth derivative, which adds 0.1 (20 h)⁵/30 at most: a fifth at 20 h = 0.16.
        bound = (20.0 * h) ** 4 / 384.0
        assert 0.5 * bound < np.max(np.abs(found - cable(at, 1.0))) < 1.2 * bound


def test_force_is_constant_beyond_its_range() -> None:
    """Keep the value of the last node beyond it."""
    vector = parameters_with(CAM, RIG, [acting(Force("position", cubic_spring, (0.1, 0.5)), 1.0)])
    for place, edge in ((-3.0, 0.1), (0.7, 0.5)):
        expected = float(cubic_spring(np.array(edge), 1.0)) / RIG.mass
        assert hermite(place, SLOTS, vector) == pytest.approx(expected, rel=1e-12)


def test_forces_of_several_laws_add_up() -> None:
    """Act together, of the same quantity and of others, as the sum of what each does to the acceleration."""
    both = [acting(Force("position", cubic_spring), size) for size in (1.0, 2.0)]
    np.testing.assert_allclose(run(*both), run(acting(Force("position", cubic_spring), 3.0)), atol=1e-12)
    drag, pull = acting(Force("velocity", cubic_drag), 0.3), acting(Force("angle", cable), 0.01)
    np.testing.assert_allclose(run(*both, drag, pull), run(pull, *both, drag), atol=1e-12)
    assert np.max(np.abs(run(*both, drag, pull) - run(*both, drag))) > 1e-3


def test_no_force_leaves_the_vector_as_it_was() -> None:
    """Cost nothing where there is none: the vector ends with its slots."""
    np.testing.assert_array_equal(parameters_with(CAM, RIG, []), coefficients(CAM, RIG))


def test_constant_law_may_be_one_number() -> None:
    """Push the same everywhere."""
    vector = parameters_with(CAM, RIG, [acting(Force("position", lambda s, size: size), 0.02)])
    assert hermite(0.123, SLOTS, vector) == pytest.approx(0.02 / RIG.mass, rel=1e-14)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Force("time", cable), "cannot depend on 'time'; it can on position"),
        (lambda: Force("position", cable, (0.5, 0.1)), "the lower one first"),
        (lambda: Force("roll_angle", cable, (0.0, 1.0)), "over one turn"),
        (lambda: Parameter("size", "1", 1.0, 0.0, 0.5), "the lower one first"),
        (lambda: Parameter("size", "1", 0.0, math.inf, 0.5), "must be finite"),
        (lambda: Parameter("size", "1", 0.0, 1.0, 2.0), "2 lies outside its bounds"),
        (lambda: Parameter("size", "1", 0.0, 1.0, 0.5, starts=(3.0,)), "3 lies outside its bounds"),
        (lambda: Parameter("size", "1", -1.0, 1.0, 0.0), "typical is 0"),
        (lambda: Effect("two words", "F", (SIZE,), "here", force=Force("angle", cable)), "is no name"),
        (lambda: Effect("own", "F", (), "here", force=Force("angle", cable)), "give it parameters"),
        (lambda: Effect("own", "F", (SIZE, SIZE), "here", force=Force("angle", cable)), "each name once"),
        (lambda: Effect("own", "", (SIZE,), "here", force=Force("angle", cable)), "say its law"),
        (lambda: Effect("own", "F", (SIZE,), "here"), "does nothing"),
    ],
)
def test_what_cannot_be_is_refused(make: Callable[[], object], message: str) -> None:
    """Say what is wrong with an effect when it is made."""
    with pytest.raises(EffectError, match=message):
        make()


@pytest.mark.parametrize(
    ("force", "message"),
    [
        (Force("position", lambda s, size: size / (s - s)), "the law gives"),
        (Force("position", lambda s, size: s[:3]), r"gives \(3,\) forces for"),
        (Force("roll_angle", lambda turn, size: size * turn), "after a turn of the ball"),
    ],
)
def test_law_that_gives_no_force_is_refused(force: Force, message: str) -> None:
    """Say what the law gives, where, and with which values."""
    with pytest.raises(EffectError, match=message):
        parameters_with(CAM, RIG, [acting(force, 1.0)])


def test_catalogue_takes_effects_for_a_while() -> None:
    """Know an effect as long as it has joined, and refuse a name that is taken, leaving the catalogue as it was."""
    effect, before = acting(Force("angle", cable), 1.0).effect, list(CATALOGUE)
    with joined([effect]):
        assert list(CATALOGUE) == [*before, "own"]
    with pytest.raises(EffectError, match="'own' is taken"), joined([effect, effect]):
        pass
    assert list(CATALOGUE) == before
