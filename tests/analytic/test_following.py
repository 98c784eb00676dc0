"""What follows a motion of quintics obeys its law to rounding, at stamps and between them."""

from __future__ import annotations

import numpy as np
import pytest

from analytic.effects import acting, motion_with
from analytic.motion import BeamMotion, DelayedMotion, FloatArray, ScaledMotion, beam_states
from analytic.quintic import QuinticMotion, finely, through
from tests.motions import Sines

STAMPS = np.concatenate((np.linspace(0.0, 2.0, 101), 2.0 + np.cumsum(np.tile([0.005, 0.03, 0.011], 40))))
FINE = np.linspace(STAMPS[0], STAMPS[-1], 20_001)
# α̈ scatters as that of a drive behind a coarse encoder does: its derivative jumps by some 100 rad/s³ at the stamps.
_BENT = np.random.default_rng(1).normal(0.0, 0.5, len(STAMPS))
_RATE = np.cumsum(np.append(0.02, 0.5 * np.diff(STAMPS) * (_BENT[1:] + _BENT[:-1])))
_ANGLE = np.cumsum(np.append(0.01, 0.5 * np.diff(STAMPS) * (_RATE[1:] + _RATE[:-1])))
ROUGH = QuinticMotion(STAMPS, np.column_stack((_ANGLE, _RATE, _BENT)))


def lagging(constant: float, motion: BeamMotion = ROUGH) -> BeamMotion:
    """The motion behind a lag."""
    return motion_with(motion, STAMPS, [acting("angle_lag", {"time_constant": constant})])


def rounding(constant: float) -> float:
    """What is left where the terms T^j α^(j) cancel, each rounded, also in what is left of all pieces before [rad]."""
    terms = [constant**j * np.max(np.abs(ROUGH.spline(FINE, j))) for j in range(6)]
    return float(8.0 * np.finfo(float).eps * max(terms) * (1.0 + constant / 0.005))


def integrated(time: FloatArray, rate: FloatArray) -> FloatArray:
    """∫ of `rate` over `time` from its start on, by trapezoids, same shape."""
    return np.concatenate(([0.0], np.cumsum(0.5 * np.diff(time) * (rate[1:] + rate[:-1]))))


@pytest.mark.parametrize("constant", [0.002, 0.05, 0.3, 1.0])
def test_a_lagging_beam_obeys_its_equation(constant: float) -> None:
    """Fulfil T β̇ + β = α and its derivative everywhere, with β̇ and β̈ that are derivatives of β."""
    beam = lagging(constant)
    angle, rate, bent = beam.evaluate(FINE), beam.derivative(FINE), beam.derivative(FINE, 2)
    bound = rounding(constant)
    np.testing.assert_allclose(constant * rate + angle, ROUGH.evaluate(FINE), rtol=0.0, atol=bound)
    np.testing.assert_allclose(constant * bent + rate, ROUGH.derivative(FINE), rtol=0.0, atol=bound / constant)
    # Trapezoids of h leave h²/12 of the change of the slope, added up over all changes.
    varies = np.sum(np.abs(np.diff(bent)))
    limit = (FINE[1] - FINE[0]) ** 2 / 12.0 * varies + bound
    assert np.max(np.abs(integrated(FINE, rate) - (angle - angle[0]))) < limit


def test_a_lagging_beam_has_settled_before_it_begins() -> None:
    """Begin where it would be had the beam always turned at the rate of the first stamp: late by T."""
    beam, first, bound = lagging(0.2), STAMPS[:1], rounding(0.2)
    assert beam.evaluate(first)[0] == pytest.approx(ROUGH.states[0, 0] - 0.2 * ROUGH.states[0, 1], abs=bound)
    assert beam.derivative(first)[0] == pytest.approx(ROUGH.states[0, 1], abs=bound / 0.2)
    assert beam.derivative(first, 2)[0] == pytest.approx(0.0, abs=bound / 0.2**2)
    np.testing.assert_array_equal(beam.evaluate(np.array([-1.0, 99.0])), beam.evaluate(STAMPS[[0, -1]]))


def test_a_lag_of_a_sine_is_known() -> None:
    """Answer sin ω t by (sin ω t − ω T cos ω t)/(1 + ω² T²) once what it began with has faded."""
    constant, omega = 0.1, 4.0
    beam = lagging(constant, Sines(((0.05, omega, 0.0),)))
    late = FINE[FINE > 3.0]
    follows = np.sin(omega * late) - omega * constant * np.cos(omega * late)
    # quintics through stamps up to 0.03 s apart: 0.03⁶/46080 of ω⁶ 0.05 rad, 3e-12; exp(−30) of the start, 1e-15
    expected = 0.05 * follows / (1.0 + (omega * constant) ** 2)
    np.testing.assert_allclose(beam.evaluate(late), expected, rtol=0.0, atol=4e-12)


def served(lag: float, damping: float, motion: BeamMotion = ROUGH) -> BeamMotion:
    """The motion behind a servo."""
    return motion_with(motion, STAMPS, [acting("angle_servo", {"lag": lag, "damping": damping})])


# weakly and strongly damped, at the critical damping and beside it, where the two exponents are all but one
@pytest.mark.parametrize("damping", [0.05, 0.6, 1.0 - 1e-9, 1.0, 1.0 + 1e-9, 1.02, 5.0])
@pytest.mark.parametrize("lag", [0.003, 0.1, 1.0])
def test_a_beam_behind_a_servo_obeys_its_equation(lag: float, damping: float) -> None:
    """Fulfil (T/2ζ)² β̈ + T β̇ + β = α everywhere, with β̇ and β̈ that are derivatives of β."""
    beam, square = served(lag, damping), (0.5 * lag / damping) ** 2
    angle, rate, bent = beam.evaluate(FINE), beam.derivative(FINE), beam.derivative(FINE, 2)
    # As of a lag: Σ c_j α^(j) cancels, with c_j of the order of (T + T/2ζ)^j.
    bound = rounding(lag + 0.5 * lag / damping)
    np.testing.assert_allclose(square * bent + lag * rate + angle, ROUGH.evaluate(FINE), rtol=0.0, atol=bound)
    for whole, slope in ((angle, rate), (rate, bent)):
        # trapezoids: h²/12 of all changes of the slope's slope, itself from differences
        h = FINE[1] - FINE[0]
        bends = np.gradient(slope, h)
        limit = h**2 / 12.0 * np.sum(np.abs(np.diff(bends))) * 2.0 + 20.0 * bound / np.sqrt(square)
        assert np.max(np.abs(integrated(FINE, slope) - (whole - whole[0]))) < limit


def test_a_beam_behind_a_servo_has_settled_before_it_begins() -> None:
    """Begin where it would be had the beam always turned at the rate of the first stamp: late by T."""
    beam, first = served(0.2, 0.6), STAMPS[:1]
    assert beam.evaluate(first)[0] == pytest.approx(ROUGH.states[0, 0] - 0.2 * ROUGH.states[0, 1], abs=1e-12)
    assert beam.derivative(first)[0] == pytest.approx(ROUGH.states[0, 1], abs=1e-12)
    assert beam.derivative(first, 2)[0] == pytest.approx(0.0, abs=1e-10)


@pytest.mark.parametrize("damping", [0.4, 1.0, 1.7])
def test_a_servos_answer_to_a_sine_is_known(damping: float) -> None:
    """Answer as 1/(1 − q ω² + i T ω), q = (T/2ζ)², says, once what it began with has faded."""
    lag, omega = 0.05, 4.0
    beam = served(lag, damping, Sines(((0.05, omega, 0.0),)))
    late = FINE[FINE > 3.5]  # exp(−2 ζ² t/T): exp(−22) at the weakest of what it begins with, some 1e-4 rad
    answer = 1.0 / (1.0 - (0.5 * lag / damping) ** 2 * omega**2 + 1j * lag * omega)
    expected = (0.05 * answer * np.exp(1j * omega * late)).imag
    # quintics: as of the lag above
    np.testing.assert_allclose(beam.evaluate(late), expected, rtol=0.0, atol=4e-12)


def test_two_real_poles_are_two_lags_in_a_row() -> None:
    """Be, where it is damped beyond the critical, a lag behind another, T = T₁ + T₂ and (T/2ζ)² = T₁ T₂."""
    first, second = 0.08, 0.03
    steps = [acting("angle_lag", {"time_constant": first}), acting("angle_lag", {"time_constant": second})]
    row = motion_with(Sines(), STAMPS, steps[:1])
    row = motion_with(row, FINE, steps[1:])  # quintics through stamps 0.2 ms apart
    late = FINE > 2.0  # they begin otherwise: exp(−2/0.08), 1e-11 of it
    both = served(first + second, 0.5 * (first + second) / np.sqrt(first * second), Sines())
    np.testing.assert_allclose(both.evaluate(FINE[late]), row.evaluate(FINE[late]), rtol=0.0, atol=1e-11)


def test_no_lag_changes_nothing() -> None:
    """Be the motion itself without a lag, and with one of two microseconds the motion that much earlier."""
    assert lagging(0.0) is ROUGH
    assert served(0.0, 0.7) is ROUGH
    late = lagging(2e-6).evaluate(FINE) - ROUGH.evaluate(FINE)
    assert np.max(np.abs(late)) < 2.001e-6 * np.max(np.abs(ROUGH.derivative(FINE)))


def test_a_motion_of_quintics_is_taken_as_it_is() -> None:
    """Take quintics between the same stamps for themselves, and run through the states of any other motion."""
    assert through(ROUGH, STAMPS) is ROUGH
    other = through(Sines(), STAMPS)
    np.testing.assert_array_equal(other.states[:, 0], Sines().evaluate(STAMPS))
    # 0.03⁴/384 of the sixth derivative
    np.testing.assert_allclose(other.derivative(FINE, 2), Sines().derivative(FINE, 2), rtol=0.0, atol=1e-7)
    # trapezoids of 0.2 ms of 0.05 rad at some 3 rad/s: h² ω²/12
    np.testing.assert_allclose(other.integral(FINE), integrated(FINE, other.evaluate(FINE)), rtol=0.0, atol=1e-8)


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("angle_lag", {"time_constant": 0.2}),
        ("angle_servo", {"lag": 0.2, "damping": 0.6}),
        ("angle_hold", {"interval": 0.2}),
    ],
)
def test_behind_a_multiple_of_a_motion_a_beam_moves_by_that_multiple(name: str, values: dict[str, float]) -> None:
    """Give behind a gain and a lag what the lag of the multiplied motion gives, to rounding."""
    behind_gain = motion_with(ROUGH, STAMPS, [acting("angle_gain", {"gain": 0.7}), acting(name, values)])
    multiplied = motion_with(QuinticMotion(STAMPS, 0.7 * ROUGH.states), STAMPS, [acting(name, values)])
    one, other = beam_states(behind_gain, FINE), beam_states(multiplied, FINE)
    for order in range(3):
        np.testing.assert_allclose(one[:, order], other[:, order], rtol=0.0, atol=rounding(0.2) / 0.2**order)


def test_a_fine_grid_is_evaluated_once_for_all_gaps_and_gains() -> None:
    """Keep the angle on the grid on which a gap is followed, and multiply it by a gain."""
    time, angle = finely(ROUGH, STAMPS)
    assert finely(ROUGH, STAMPS)[1] is angle
    np.testing.assert_array_equal(angle, ROUGH.evaluate(time))
    np.testing.assert_array_equal(finely(ScaledMotion(ROUGH, 0.7), STAMPS)[1], 0.7 * angle)
    assert time[0] == STAMPS[0]
    assert time[-1] == STAMPS[-1]
    other = Sines()
    np.testing.assert_array_equal(finely(other, STAMPS)[1], other.evaluate(time))


@pytest.mark.parametrize("interval", [0.001, 0.0123, 0.3])
def test_a_held_beam_takes_the_mean_of_the_last_interval(interval: float) -> None:
    """Be (1/T) ∫ α over the last T, and turn by what α has changed in it over T."""
    beam = motion_with(ROUGH, STAMPS, [acting("angle_hold", {"interval": interval})])
    late = FINE[interval < FINE][::500]
    for now in late:
        inside = np.linspace(now - interval, now, 4001)
        mean = np.trapezoid(ROUGH.evaluate(inside), inside) / interval
        # trapezoids: h²/12 of a slope that changes by some rad/s over the interval
        assert beam.evaluate(np.array([now]))[0] == pytest.approx(mean, abs=1e-9)
    change = ROUGH.evaluate(late) - ROUGH.evaluate(late - interval)
    np.testing.assert_allclose(beam.derivative(late), change / interval, rtol=0.0, atol=1e-15 / interval)
    change = ROUGH.derivative(late) - ROUGH.derivative(late - interval)
    np.testing.assert_allclose(beam.derivative(late, 2), change / interval, rtol=0.0, atol=1e-14 / interval)
    # Begun as if it had always turned at the first rate: late by T/2, without a jolt.
    assert beam.evaluate(STAMPS[:1])[0] == pytest.approx(_ANGLE[0] - 0.5 * interval * _RATE[0], rel=1e-12)
    assert beam.derivative(STAMPS[:1])[0] == pytest.approx(_RATE[0], rel=1e-9)
    assert beam.derivative(STAMPS[:1], 2)[0] == pytest.approx(0.0, abs=1e-12)


def test_a_held_beam_is_late_by_half_its_interval() -> None:
    """Answer sin ω t by sin ω (t − T/2), smaller by sin x/x with x = ω T/2; without an interval by itself."""
    interval, omega = 0.2, 4.0
    beam = motion_with(Sines(((0.05, omega, 0.0),)), STAMPS, [acting("angle_hold", {"interval": interval})])
    late = FINE[FINE > 0.5]
    x = 0.5 * omega * interval
    expected = 0.05 * np.sin(omega * late - x) * np.sin(x) / x
    # as of the lag above
    np.testing.assert_allclose(beam.evaluate(late), expected, rtol=0.0, atol=4e-12)
    assert motion_with(ROUGH, STAMPS, [acting("angle_hold", {"interval": 0.0})]) is ROUGH


def test_a_curve_bends_angle_and_rates() -> None:
    """Be α + a α² + b α³, with rates by the chain rule as differences show them."""
    beam = motion_with(Sines(), STAMPS, [acting("angle_nonlinearity", {"square": 0.6, "cube": -2.0})])
    angle = Sines().evaluate(FINE)
    np.testing.assert_allclose(beam.evaluate(FINE), angle + 0.6 * angle**2 - 2.0 * angle**3, rtol=0.0, atol=1e-16)
    step = 1e-5
    for order, of in ((1, beam.evaluate), (2, beam.derivative)):
        # central differences: h²/6 of a derivative two orders higher, rounding over h
        slopes = (of(FINE + step) - of(FINE - step)) / (2.0 * step)
        np.testing.assert_allclose(beam.derivative(FINE, order), slopes, rtol=0.0, atol=1e-10)


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("angle_gain", {"gain": 1.1}),
        ("angle_lag", {"time_constant": 5e-4}),
        ("angle_lag", {"time_constant": 0.2}),
        ("angle_servo", {"lag": 0.1, "damping": 0.6}),
        ("angle_hold", {"interval": 0.1}),
        ("angle_nonlinearity", {"square": 0.3, "cube": 0.2}),
    ],
)
def test_angle_and_rates_come_at_once_as_one_by_one(name: str, values: dict[str, float]) -> None:
    """Give the angle and its derivatives in one go as each for itself, within and beyond the stamps, delayed too."""
    motion = DelayedMotion(motion_with(ROUGH, STAMPS, [acting(name, values)]), 0.12, STAMPS[0], STAMPS[-1])
    time = np.linspace(STAMPS[0] - 0.5, STAMPS[-1] + 0.5, 5000)
    found = beam_states(motion, time)
    alone = (motion.evaluate(time), motion.derivative(time), motion.derivative(time, 2))
    for order, (column, expected) in enumerate(zip(found.T, alone, strict=True)):
        # A lag's rates follow from differences over it; else some roundings of α̈, the largest of the three.
        constant = values.get("time_constant")
        bound = 1e-13 if constant is None else rounding(constant) / constant**order
        np.testing.assert_allclose(column, expected, rtol=1e-12, atol=bound)
