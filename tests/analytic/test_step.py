"""One step of the integrator, where it can be solved by hand: smooth forces, stops, slip, presliding."""

from __future__ import annotations

import math

import numpy as np
import pytest

from analytic.effects import acting, parameters_with
from analytic.kernel import Grid, integrate
from analytic.law import DRY_OF_TIME
from analytic.models import CAM, Model
from analytic.motion import FloatArray
from analytic.rig import Rig
from analytic.slots import SHAPE
from analytic.step import advance

RIG = Rig()
K, G, M, r = RIG.rolling_ratio, RIG.gravity, RIG.mass, RIG.rolling_radius
IOTA = RIG.inertia_ratio
H = 0.01  # [s]
ROUNDING = 1e-15  # some ten operations on positions and velocities below 1


def stepped(
    start: tuple[float, float],
    *effects: tuple[str, dict[str, float]],
    beam: tuple[tuple[float, float, float], ...] = ((0.0, 0.0, 0.0),) * 3,
    steps: int = 1,
    model: Model = CAM,
) -> FloatArray:
    """(s, ṡ) after each step of 10 ms, shape (steps, 2); the beam's start, middle and end are alike in every step."""
    grid = Grid.over(H * np.arange(steps + 1), H)
    table = np.array([*beam[:2] * steps, beam[2]])
    vector = parameters_with(model, RIG, [acting(name, values) for name, values in effects])
    runs = integrate(grid, table, vector, np.array([start]))
    return np.column_stack((runs.position[0, 1:], runs.velocity[0, 1:]))


def slope(angle: float) -> tuple[tuple[float, float, float], ...]:
    """A beam at rest at this angle [rad]."""
    return ((angle, 0.0, 0.0),) * 3


def test_constant_force_is_integrated_exactly() -> None:
    """Fall along a slope by ½ a t²."""
    a = K * G * math.sin(0.1)
    ((s, v),) = stepped((0.3, 0.2), beam=slope(0.1))
    assert s == pytest.approx(0.3 + 0.2 * H + 0.5 * a * H**2, abs=ROUNDING)
    assert v == pytest.approx(0.2 + a * H, abs=ROUNDING)


def test_force_of_time_is_integrated_by_simpsons_rule() -> None:
    """Weigh α̈ at the start, middle and end of the step by 1, 4, 1 for the velocity, and by 1, 2, 0 for the position."""
    beam = ((0.0, 0.0, 1.0), (0.0, 0.0, 2.0), (0.0, 0.0, 5.0))
    worth = -K * RIG.lever
    ((s, v),) = stepped((0.3, 0.2), beam=beam)
    assert v == pytest.approx(0.2 + worth * H * (1.0 + 4.0 * 2.0 + 5.0) / 6.0, abs=ROUNDING)
    assert s == pytest.approx(0.3 + 0.2 * H + worth * H**2 * (1.0 + 2.0 * 2.0) / 6.0, abs=ROUNDING)


def test_damping_is_the_exponential_up_to_fourth_order() -> None:
    """Multiply ṡ by the first five terms of e⁻ˣ, and s by their integral."""
    x = K * 5.0 / M * H  # so strong that every term counts: x = 0.47
    ((s, v),) = stepped((0.3, 0.2), ("viscous_damping", {"coefficient": 5.0}))
    assert v == pytest.approx(0.2 * (1.0 - x + x**2 / 2 - x**3 / 6 + x**4 / 24), abs=ROUNDING)
    assert s == pytest.approx(0.3 + 0.2 * H * (1.0 - x / 2 + x**2 / 6 - x**3 / 24), abs=ROUNDING)


def test_centrifugal_force_is_the_hyperbola_up_to_fourth_order() -> None:
    """Follow s̈ = K α̇² s by the first terms of cosh and sinh."""
    rate = 40.0  # K α̇² h² = 0.107
    y = K * (rate * H) ** 2
    ((s, v),) = stepped((0.3, 0.2), beam=((0.0, rate, 0.0),) * 3)
    even, odd = 1.0 + y / 2.0 + y**2 / 24.0, 1.0 + y / 6.0
    assert s == pytest.approx(0.3 * even + 0.2 * H * odd, abs=ROUNDING)
    assert v == pytest.approx(0.2 * even + 0.3 * y / H * odd, abs=ROUNDING)


@pytest.mark.parametrize("speed", [0.2, -0.2, 1.0, -1.0])
def test_dry_friction_slows_a_ball_down(speed: float) -> None:
    """Lose K c g h either way, and half of that times h on the way."""
    ((s, v),) = stepped((0.3, speed), ("rolling_resistance", {"coefficient": 0.05}))
    a = math.copysign(K * 0.05 * G, speed)
    assert v == pytest.approx(speed - a * H, abs=ROUNDING)
    assert s == pytest.approx(0.3 + speed * H - 0.5 * a * H**2, abs=ROUNDING)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_dry_friction_feels_the_normal_force_of_mid_step(sign: float) -> None:
    """Press the ball by g cos α − s α̈ as at mid-step, where the smooth forces weigh start, middle and end 1, 4, 1."""
    beam = ((0.3, 0.0, 4.0), (0.2, 0.0, 6.0), (0.1, 0.0, 2.0))
    start, middle, end = (K * (G * math.sin(angle) - RIG.lever * angular) for angle, _, angular in beam)
    limit = K * 0.05 * (G * math.cos(0.2) - 0.3 * 6.0)
    ((s, v),) = stepped((0.3, sign * 0.2), ("rolling_resistance", {"coefficient": 0.05}), beam=beam)
    smooth = (start + 4.0 * middle + end) / 6.0
    assert v == pytest.approx(sign * 0.2 + H * (smooth - sign * limit), abs=ROUNDING)
    moved = sign * 0.2 * H + H**2 * (start + 2.0 * middle) / 6.0 - 0.5 * sign * limit * H**2
    assert s == pytest.approx(0.3 + moved, abs=ROUNDING)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_ball_that_stops_within_a_step_stays_where_it_stopped(sign: float) -> None:
    """Come to rest after v²/2a, on the level and where a slope is too gentle to pull it on."""
    c, v0 = 0.05, 0.002
    ((s, v),) = stepped((0.3, sign * v0), ("rolling_resistance", {"coefficient": c}))
    assert v == 0.0
    assert s == pytest.approx(0.3 + sign * v0**2 / (2.0 * K * c * G), abs=ROUNDING)
    ((s, v),) = stepped((0.3, sign * v0), ("rolling_resistance", {"coefficient": c}), beam=slope(-sign * 0.04))
    assert v == 0.0
    deceleration = K * G * (c * math.cos(0.04) + math.sin(0.04))
    assert s == pytest.approx(0.3 + sign * v0**2 / (2.0 * deceleration), abs=ROUNDING)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_ball_that_turns_round_within_a_step_is_resisted_both_ways(sign: float) -> None:
    """Stop up the slope, then roll down it for the rest of the step against the same friction."""
    c, tilt, v0 = 0.05, 0.2, 0.01
    up, down = (K * G * (math.sin(tilt) + way * c * math.cos(tilt)) for way in (1.0, -1.0))
    stop = v0 / up
    rest = H - stop
    assert 0.2 * H < stop < 0.8 * H
    ((s, v),) = stepped((0.3, sign * v0), ("rolling_resistance", {"coefficient": c}), beam=slope(-sign * tilt))
    assert v == pytest.approx(-sign * down * rest, abs=ROUNDING)
    assert s == pytest.approx(0.3 + sign * (0.5 * v0 * stop - 0.5 * down * rest**2), abs=ROUNDING)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_direction_of_the_pull_decides_what_holds_a_ball_at_rest(sign: float) -> None:
    """Hold against the pull with the coefficient of that direction, and be let go beyond it."""
    weak_down = {"coefficient_plus": 0.01, "coefficient_minus": 0.03}
    held = stepped((0.3, 0.0), ("directional_resistance", weak_down), beam=slope(sign * 0.02), steps=2)
    if sign < 0.0:
        np.testing.assert_array_equal(held, [[0.3, 0.0]] * 2)
        return
    a = K * G * (math.sin(0.02) - 0.01 * math.cos(0.02))
    np.testing.assert_allclose(held[:, 1], [a * H, 2.0 * a * H], rtol=0.0, atol=ROUNDING)
    np.testing.assert_allclose(held[:, 0], 0.3 + 0.5 * a * H**2 * np.array([1.0, 4.0]), rtol=0.0, atol=ROUNDING)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_direction_of_the_motion_decides_what_slows_a_ball(sign: float) -> None:
    """Resist motion to either side with that side's coefficient."""
    values = {"coefficient_plus": 0.01, "coefficient_minus": 0.03}
    ((_, v),) = stepped((0.3, sign * 0.2), ("directional_resistance", values))
    assert v == pytest.approx(sign * (0.2 - K * (0.01 if sign > 0.0 else 0.03) * G * H), abs=ROUNDING)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_friction_that_falls_with_speed_is_taken_at_mid_step(sign: float) -> None:
    """Take Stribeck's coefficient at the velocity that the one of the step's start leads to by half the step."""
    values = {"static_coefficient": 0.09, "kinetic_coefficient": 0.05, "stribeck_velocity": 0.05}
    v0, tilt = 0.06, 0.03
    pull = K * G * math.sin(tilt)

    def limit(v: float) -> float:
        return K * G * math.cos(tilt) * (0.05 + 0.04 * math.exp(-((v / 0.05) ** 2)))

    ((s, v),) = stepped((0.3, sign * v0), ("stribeck_friction", values), beam=slope(sign * tilt))
    expected = limit(v0 + 0.5 * H * (pull - limit(v0)))
    assert v == pytest.approx(sign * (v0 + H * (pull - expected)), abs=ROUNDING)
    assert s == pytest.approx(0.3 + sign * (v0 * H + 0.5 * H**2 * (pull - expected)), abs=ROUNDING)


@pytest.mark.parametrize(("of_time", "c"), [(0.03, 0.08), (-0.03, 0.02), (-0.09, 0.0)])
def test_friction_that_depends_on_time_stands_in_the_beams_table(of_time: float, c: float) -> None:
    """Add the coefficient of mid-step to what is known, but never drive the ball."""
    p = parameters_with(CAM, RIG, [acting("rolling_resistance", {"coefficient": 0.05})])
    p[SHAPE] = DRY_OF_TIME
    angle, angular = 0.2, 6.0
    beam = np.array([(angle, 0.0, angular, at) for at in (9.0, of_time, 9.0)])
    s, v, _ = advance(0.3, 0.2, 0.0, H, beam, 0, p)
    normal = G * math.cos(angle) - 0.3 * angular
    a = K * (G * math.sin(angle) - RIG.lever * angular - c * normal)
    assert v == pytest.approx(0.2 + a * H, abs=ROUNDING)
    assert s == pytest.approx(0.3 + 0.2 * H + 0.5 * a * H**2, abs=ROUNDING)


def test_stribeck_friction_holds_by_its_static_coefficient() -> None:
    """Hold a ball at rest by the greater coefficient, also where both are."""
    values = {"static_coefficient": 0.03, "kinetic_coefficient": 0.0, "stribeck_velocity": 0.05}
    for tilt in (0.029, -0.029):
        np.testing.assert_array_equal(
            stepped((0.3, 0.0), ("stribeck_friction", values), beam=slope(tilt)), [[0.3, 0.0]]
        )
    assert stepped((0.3, 0.0), ("stribeck_friction", values), beam=slope(0.031))[0, 1] > 0.0


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_ball_without_grip_slides_down_a_slope(sign: float) -> None:
    """Slide by g (sin α − μ cos α R/r), the friction of two leaning contacts, from rest and on and on."""
    mu, tilt = 0.02, 0.5
    grip = mu * RIG.radius / r * G * math.cos(tilt)
    a = G * math.sin(tilt) - grip
    found = stepped((0.3, 0.0), ("contact_slip", {"friction_coefficient": mu}), beam=slope(sign * tilt), steps=3)
    times = H * np.arange(1, 4)
    np.testing.assert_allclose(found[:, 1], sign * a * times, rtol=0.0, atol=ROUNDING)
    np.testing.assert_allclose(found[:, 0], 0.3 + sign * 0.5 * a * times**2, rtol=0.0, atol=ROUNDING)


def test_ball_with_grip_rolls_as_if_it_could_not_slip() -> None:
    """Roll where the traction (1 − K) g sin α is within μ cos α R/r g, and not just beyond."""
    tilt = 0.1
    needed = (1.0 - K) * math.tan(tilt) * r / RIG.radius
    free = stepped((0.3, 0.1), beam=slope(tilt), steps=2)
    for share, alike in ((1.001, True), (0.999, False)):
        slip = ("contact_slip", {"friction_coefficient": share * needed})
        found = stepped((0.3, 0.1), slip, beam=slope(tilt), steps=2)
        assert np.array_equal(found, free) is alike


STEEP = 3  # steps


def slid(sign: float, *effects: tuple[str, dict[str, float]], steps: int = 60) -> tuple[FloatArray, float, float]:
    """Speed at each stamp of a ball that slides down a steep beam for three steps, then on until it rolls again.

    And what the slope gave the centre in ṡ, and the slip that it left: pull less friction. Friction that slows the
    centre by τ slows the slip by τ (1 + 1/ι).
    """
    tilt, grip = 0.5, 0.02 * RIG.radius / r * G
    table = np.zeros((2 * steps + 1, 3))
    table[: 2 * STEEP, 0] = sign * tilt
    grid = Grid.over(H * np.arange(steps + 1), H)
    own = acting("contact_slip", {"friction_coefficient": 0.02})
    vector = parameters_with(CAM, RIG, [own, *(acting(name, values) for name, values in effects)])
    runs = integrate(grid, table, vector, np.array([(0.3, 0.0)]))
    # the smooth forces of a step weigh the beam at its end by a sixth, and that of the last steep step is level
    pull = G * math.sin(tilt) * (STEEP - 1.0 / 6.0) * H
    friction = grip * math.cos(tilt) * STEEP * H
    return sign * runs.velocity[0], pull - friction, pull - friction * (1.0 + 1.0 / IOTA)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_ball_that_slid_rolls_again(sign: float) -> None:
    """Be braked by the grip until the slip ends, then keep what the centre of percussion had, ṡ − w/(1 + 1/ι)."""
    v, first, slip = slid(sign)
    grip = 0.02 * RIG.radius / r * G
    ends = slip / (grip * (1.0 + 1.0 / IOTA))
    assert 15 * H < ends < 50 * H
    assert v[STEEP] == pytest.approx(first, abs=ROUNDING)
    assert v[STEEP + 10] == pytest.approx(first - 10.0 * grip * H, abs=10 * ROUNDING)
    after = STEEP + math.ceil(ends / H)
    np.testing.assert_allclose(v[after:], first - slip / (1.0 + 1.0 / IOTA), rtol=0.0, atol=60 * ROUNDING)
    assert v[after - 2] > v[after - 1] > v[after]


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_sliding_ball_is_braked_by_grip_alone_and_turned_by_resistance_too(sign: float) -> None:
    """Slide as without resistance, which brakes the turning by c N/(m ι), so that ṡ − w/(1 + 1/ι) falls by K c g.

    So it slides for longer, and in the end has lost what a ball that rolled all the time would have.
    """
    c = 0.005
    (v, first, slip), (free, _, _) = slid(sign, ("rolling_resistance", {"coefficient": c})), slid(sign)
    np.testing.assert_allclose(v[: STEEP + 10], free[: STEEP + 10], rtol=0.0, atol=10 * ROUNDING)
    grip = 0.02 * RIG.radius / r * G
    braking = np.count_nonzero(np.isclose(np.diff(v)[STEEP:], -grip * H, rtol=1e-9, atol=0.0))
    longer = (slip + c * G / IOTA * STEEP * H) / (grip * (1.0 + 1.0 / IOTA) - c * G / IOTA)
    # the resistance of the first step, in which the ball does not turn yet, and cos 0.5 of three steps: 3 of 176 ms
    assert braking * H == pytest.approx(longer, abs=1.5 * H)
    assert np.count_nonzero(np.isclose(np.diff(free)[STEEP:], -grip * H, rtol=1e-9, atol=0.0)) < braking
    late = np.arange(STEEP + braking + 2, len(v))
    expected = first - slip / (1.0 + 1.0 / IOTA) - K * c * G * H * late
    # the same step and cosine: 1 + 3 · (1 − cos 0.5) = 1.4 steps of K c g
    np.testing.assert_allclose(v[late], expected, rtol=0.0, atol=1.5 * K * c * G * H)


@pytest.mark.parametrize(
    "other",
    [("viscous_damping", {"coefficient": 0.05}), ("quadratic_drag", {"coefficient": 0.05})],
    ids=["viscous", "drag"],
)
def test_a_resistance_beside_a_force_of_the_velocity_is_of_second_order(other: tuple[str, dict[str, float]]) -> None:
    """Roll down and up a swinging beam, and be off by a hundredth or little more with a tenth of the step.

    A force of the velocity that acts on a ball too fast by K c g h/2 = 7e-5 m/s is too large by K c' · 7e-5/m, or
    3e-5 m/s² of a viscous one, which six seconds turn into 5e-4 m at the most and 1e-5 m here, as the ball turns round.
    Where it stops within a step, the beam of mid-step stands for that of the stop: a micrometre.
    """
    vector = parameters_with(CAM, RIG, [acting(*other), acting("rolling_resistance", {"coefficient": 0.002})])
    ends = []
    for h in (1e-2, 1e-3, 1e-4):
        grid = Grid.over(np.arange(0.0, 6.0 + 0.5e-2, 1e-2), h)
        swing = 0.02 * np.cos(grid.edges)
        runs = integrate(
            grid, np.column_stack((swing, -0.02 * np.sin(grid.edges), -swing)), vector, np.array([(0.3, 0.0)])
        )
        ends.append((runs.position[0, -1], runs.velocity[0, -1]))
    coarse, fine = (np.abs(np.subtract(one, ends[-1])).max() for one in ends[:2])
    assert coarse < 1e-6
    assert fine < coarse / 15.0  # of first order it would be a tenth


@pytest.mark.parametrize("effects", [(), (("rolling_resistance", {"coefficient": 0.0017}),)], ids=["free", "resisted"])
@pytest.mark.parametrize(("grip", "rate", "seconds"), [(0.0027, 4.0, 3.0), (0.004, 3.0, 6.0)])
def test_a_ball_that_slips_is_of_second_order(
    effects: tuple[tuple[str, dict[str, float]], ...], grip: float, rate: float, seconds: float
) -> None:
    """Slide to and fro on a swinging beam, and be off by a hundredth or little more with a tenth of the step.

    By how much is that of a mean force: the swing's third derivative, h²/24 · K g 0.03 rate³, acts for a piece of
    1/rate before it changes sign, and moves the ball by h²/24 · 6.6 · 0.03 · rate² · seconds/rate = 1e-5 m with 10 ms.
    A step of wrong sense would change ṡ by 2 grip g h/2 = 3e-4 m/s, which three seconds turn into 1e-3 m.
    """
    own = [acting("contact_slip", {"friction_coefficient": grip}), *(acting(*one) for one in effects)]
    vector = parameters_with(CAM, RIG, own)
    ends = []
    for h in (1e-2, 1e-3, 1e-4):
        grid = Grid.over(np.arange(0.0, seconds + 0.5e-2, 1e-2), h)
        swing = 0.03 * np.cos(rate * grid.edges)
        table = np.column_stack((swing, -0.03 * rate * np.sin(rate * grid.edges), -(rate**2) * swing))
        s, v, w, slipping, turning = 0.3, 0.0, 0.0, [], []
        for step in range(len(grid.steps)):
            s, v, w = advance(s, v, w, grid.steps[step], table, 2 * step, vector)
            slipping.append(np.sign(w))
            turning.append(np.sign(v - w))
        ends.append((s, v))
    assert np.count_nonzero(np.diff(slipping)) >= 3  # of the shortest steps: it begins, ends, or turns round
    assert np.count_nonzero(np.diff(turning)) >= 3
    coarse, fine = (np.abs(np.subtract(one, ends[-1])).max() for one in ends[:2])
    assert coarse < 1e-5
    assert fine < coarse / 15.0  # of first order it would be a tenth


def test_ball_that_grips_is_resisted_in_rolling() -> None:
    """Roll against the resistance as if it could not slip, where the grip is more than both need."""
    effects = ("rolling_resistance", {"coefficient": 0.005})
    slip = ("contact_slip", {"friction_coefficient": 0.5})
    for start in (0.2, -0.2, 0.0):
        found = stepped((0.3, start), slip, effects, beam=slope(0.02), steps=3)
        np.testing.assert_array_equal(found, stepped((0.3, start), effects, beam=slope(0.02), steps=3))


def test_presliding_is_a_spring_before_the_ball_rolls() -> None:
    """Oscillate about the stretch at which the spring carries the slope, at ω² = K σ/m."""
    stiffness, tilt = 200.0, 1e-4
    spring = ("presliding_hysteresis", {"coefficient": 0.01, "stiffness": stiffness})
    grid = Grid.over(1e-3 * np.arange(101), 1e-3)
    vector = parameters_with(CAM, RIG, [acting(*spring)])
    runs = integrate(grid, np.array([(tilt, 0.0, 0.0)] * 201), vector, np.array([(0.3, 0.0)]))
    omega, stretch = math.sqrt(K * stiffness / M), M * G * math.sin(tilt) / stiffness
    expected = stretch * (1.0 - np.cos(omega * grid.time))
    # the spring gives way by F/(c N) < 2 % at twice the load, and a split step errs by (ω h)²/24 = 8e-5 a cycle
    assert np.max(np.abs(runs.position[0] - 0.3 - expected)) < 0.04 * 2.0 * stretch


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_presliding_ends_as_rolling_resistance(sign: float) -> None:
    """Slow a ball down by K c g once it has rolled far further than the spring reaches."""
    values = {"coefficient": 0.01, "stiffness": 1000.0}
    found = stepped((0.3, sign * 0.5), ("presliding_hysteresis", values), steps=10)
    # c m g/σ = 7 µm is passed within the first step, which begins without a pull at all
    np.testing.assert_allclose(np.diff(found[:, 1]), -sign * K * 0.01 * G * H, rtol=1e-9)
    ends = found[:-1, 0] + found[:-1, 1] * H - sign * 0.5 * K * 0.01 * G * H**2
    np.testing.assert_allclose(found[1:, 0], ends, rtol=0.0, atol=1e-12)


@pytest.mark.parametrize("v0", [0.05, 1.0])
def test_presliding_stretches_exactly_within_a_step(v0: float) -> None:
    """Pull after half a step at ṡ with c m g (1 − e^(−σ ṡ h/2 / (c m g))), over the whole step."""
    c, stiffness = 0.01, 5.0
    ((s, v),) = stepped((0.3, v0), ("presliding_hysteresis", {"coefficient": c, "stiffness": stiffness}))
    pull = K * c * G * (1.0 - math.exp(-stiffness * v0 * 0.5 * H / (c * M * G)))
    assert v == pytest.approx(v0 - H * pull, abs=ROUNDING)
    assert s == pytest.approx(0.3 + v0 * H - 0.5 * H**2 * pull, abs=ROUNDING)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_presliding_pulls_by_the_normal_force_of_each_half_step(sign: float) -> None:
    """Relax by half a step towards K c N/m before the pull acts and after it, N = m (g cos α − s α̈) then and there."""
    c, stiffness, angle, angular = 0.01, 20.0, 0.3, 4.0
    a = K * (G * math.sin(angle) - RIG.lever * angular)

    def relaxed(pull: float, s: float, v: float) -> float:
        limit = K * c * (G * math.cos(angle) - s * angular)
        target = -math.copysign(limit, v)
        return target + (pull - target) * math.exp(-K * stiffness / M * abs(v) * 0.5 * H / limit)

    s, v, pull, expected = 0.3, sign * 0.2, 0.0, []
    for _ in range(3):
        pull = relaxed(pull, s, v)
        s, v = s + v * H + 0.5 * H**2 * (a + pull), v + H * (a + pull)
        pull = relaxed(pull, s, v)
        expected.append((s, v))
    values = {"coefficient": c, "stiffness": stiffness}
    beam = ((angle, 0.0, angular),) * 3
    found = stepped((0.3, sign * 0.2), ("presliding_hysteresis", values), beam=beam, steps=3)
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=3 * ROUNDING)
