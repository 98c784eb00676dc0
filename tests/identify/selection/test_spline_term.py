"""Curves of unknown law, and how hypotheses become numbers and back."""

from __future__ import annotations

import pickle
from dataclasses import replace

import numpy as np
import pytest
from scipy.interpolate import CubicHermiteSpline

from analytic.effects import acting
from analytic.law import acceleration, dry_limit
from analytic.models import CAM, coefficients
from analytic.motion import FloatArray
from analytic.rig import Rig
from analytic.slots import MOST_NODES, ORIGIN, RESPONSE, SHAPE, SLOTS, WEIGHT
from harness.identify.estimate.starts import starting_points
from harness.identify.filter import run as filter_run
from harness.identify.problem.hypothesis import Hypothesis, Terms
from harness.identify.problem.settings import DEFAULT
from harness.identify.problem.spline_term import KINDS, Kind, Regressor, SplineTerm, blank
from tests.posed import Posed

NODES = DEFAULT.spline_nodes
BENT = SplineTerm(Regressor.POSITION, False, 0.1, 0.04, np.sin(np.arange(NODES)))
ROUND = replace(blank(Kind(Regressor.ROLL_ANGLE), 0.0, 2.0 * np.pi), nodes=np.sin(np.arange(NODES)))
WAVY = blank(Kind(Regressor.POSITION, periodic=True), 0.1, 0.18).with_numbers(np.array([0.08, 0.2, -0.7, 0.4]))


def by_scipy(spline: SplineTerm, where: FloatArray) -> FloatArray:
    """The spline term by scipy: slopes are central differences, at the ends those of the last two nodes."""
    places, nodes = spline.places, spline.nodes
    if spline.closed:  # three turns of it, of which the middle one is far from either end
        places = spline.low + spline.step * np.arange(-len(nodes), 2 * len(nodes))
        nodes, where = np.tile(nodes, 3), (where - spline.low) % spline.period + spline.low
    inside = np.clip(where, places[0], places[-1])
    return np.asarray(CubicHermiteSpline(places, nodes, np.gradient(nodes, spline.step))(inside))


@pytest.mark.parametrize("spline", [BENT, BENT.finer(), ROUND, ROUND.finer(), WAVY, WAVY.finer()])
def test_a_spline_term_is_the_spline_through_its_nodes(spline: SplineTerm) -> None:
    """Meet the nodes, run cubically between them, and keep the last value outside, or begin again after a period."""
    np.testing.assert_allclose(spline.at(spline.places), spline.nodes, rtol=1e-12)
    where = np.linspace(-3.0, 13.0, 1001)
    # The place among the nodes is rounded by 1e-16 · 13/0.0033 = 4e-13, times slopes of order 1 a node.
    np.testing.assert_allclose(spline.at(where), by_scipy(spline, where), atol=1e-12)


@pytest.mark.parametrize("spline", [BENT, ROUND], ids=["bent", "round"])
def test_a_finer_spline_term_is_nearly_the_same_with_twice_the_nodes(spline: SplineTerm) -> None:
    """Keep every node, add one between two, and move no further than a spline's slopes change."""
    finer = spline.finer()
    assert len(finer.nodes) == 2 * NODES - (0 if spline.closed else 1) <= MOST_NODES
    np.testing.assert_allclose(finer.nodes[::2], spline.nodes, rtol=1e-12)
    where = np.linspace(0.1, 0.54, 101)
    # Nodes are sin n: slopes by differences are cos n sin(1), by half as wide ones cos n · 2 sin(1/2) (both before what
    # the first spline rounds off); they differ by 0.12, which a cubic turns into 0.12 · 4/27 at most, twice.
    np.testing.assert_allclose(finer.at(where), spline.at(where), atol=2.0 * 0.12 * 4.0 / 27.0)


@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind.depends is not Regressor.TIME])
def test_the_kernel_feels_the_spline_term(kind: Kind) -> None:
    """Push or hold the ball by the spline term at its position, velocity, rolled angle or at the beam's angle.

    Leave it alone where only the sensor errs.
    """
    p = coefficients(CAM, Rig())
    p[ORIGIN] = 0.2
    without, resisted = acceleration(0.3, 0.1, 0.02, 0.0, 0.0, p), dry_limit(0.3, 0.1, 1.0, 0.02, 0.0, 0.0, p)
    spline = replace(blank(kind, -1.0, 1.0), nodes=np.linspace(0.01, 0.03, NODES))
    if spline.turning:
        spline = replace(ROUND, friction=kind.friction, nodes=spline.nodes)
    spline.write(p, phase=1.0)
    felt = {
        Regressor.POSITION: 0.3,
        Regressor.VELOCITY: 0.1,
        Regressor.ANGLE: 0.02,
        Regressor.ROLL_ANGLE: (0.3 - 0.2) / Rig().rolling_radius + 1.0,
    }[kind.depends]
    (expected,) = spline.at(np.array([felt])) * p[RESPONSE]
    if kind.sensor:
        assert acceleration(0.3, 0.1, 0.02, 0.0, 0.0, p) == without
        assert dry_limit(0.3, 0.1, 1.0, 0.02, 0.0, 0.0, p) == resisted
    elif kind.friction:
        assert resisted == 0.0
        held = dry_limit(0.3, 0.1, 1.0, 0.02, 0.0, 0.0, p)
        assert held == pytest.approx(expected * p[WEIGHT] * np.cos(0.02), rel=1e-12)
    else:
        # a difference of accelerations of order 0.1 is rounded by 1e-17, of forces of order 0.01
        assert acceleration(0.3, 0.1, 0.02, 0.0, 0.0, p) - without == pytest.approx(expected, rel=1e-12)


def test_an_error_of_the_sensor_that_grows_with_the_position_is_a_gain(plain: Posed) -> None:
    """Predict with an error of 3 % of the position what is predicted with a gain of 1.03, and read positions back.

    A spline through points of a line is that line; its slope as a difference has an error of 1e-16/1e-6.
    """
    straight = blank(Kind(Regressor.POSITION, sensor=True), 0.0, 0.7)
    straight = replace(straight, nodes=0.03 * straight.places)
    gain = Terms((), (acting("position_gain", {"gain": 1.03}),), np.zeros(0), None)
    error = Terms((), (), np.zeros(0), straight)
    expected, got = (filter_run.deviance(plain.problem, one, 1e-8) for one in (gain, error))
    assert got == pytest.approx(expected, rel=1e-9)
    where = np.linspace(0.05, 0.6, 12).reshape(3, 4)
    law = error.sensor_in(plain.problem)
    np.testing.assert_allclose(law.curve(where), 1.03 * where, rtol=1e-12)
    np.testing.assert_allclose(law.position(law.curve(where)), where, rtol=1e-12)
    np.testing.assert_allclose(law.slope(where), 1.03, rtol=1e-9)


@pytest.mark.parametrize("spline", [BENT, ROUND.finer(), WAVY])
def test_a_record_holds_all_but_the_values(spline: SplineTerm) -> None:
    """Come back from JSON as the same spline term that is nothing yet."""
    again = SplineTerm.of(spline.record())
    assert replace(again, nodes=spline.nodes).record() == spline.record()
    np.testing.assert_array_equal(again.places, spline.places)
    with pytest.raises(ValueError, match="99 nodes"):
        SplineTerm.of(spline.record().model_copy(update={"nodes": 99}))


def test_a_force_of_time_is_a_tilt(plain: Posed) -> None:
    """Add f/g to the angle and nothing to its rates; a friction of time becomes a column of its own."""
    record, gravity = plain.problem.recordings[0], plain.problem.rig.gravity
    force = SplineTerm(Regressor.TIME, False, 0.0, 16.0 / (NODES - 1), np.linspace(0.0, 0.5, NODES))
    loaded = force.load(record.table, record.times, gravity)
    np.testing.assert_allclose(loaded[:, 0] - record.table[:, 0], force.at(record.times) / gravity, atol=1e-15)
    np.testing.assert_array_equal(loaded[:, 1:], record.table[:, 1:])
    p = np.zeros(SLOTS)
    force.write(p)
    assert p[SHAPE] == 0.0
    dry = SplineTerm(Regressor.TIME, True, force.low, force.step, force.nodes)
    column = dry.load(record.table, record.times, gravity)
    np.testing.assert_array_equal(column[:, -1], dry.at(record.times))


@pytest.mark.parametrize(
    ("kind", "count", "refined"),
    [
        (Kind(Regressor.POSITION), 45, 89),
        (Kind(Regressor.POSITION), 49, None),
        (Kind(Regressor.ROLL_ANGLE), 48, 96),
    ],
)
def test_a_spline_term_is_refined_while_the_kernel_has_room(kind: Kind, count: int, refined: int | None) -> None:
    """Halve the distance of the nodes, one fewer between them unless they lie on a circle, up to 96 nodes."""
    spline = blank(kind, 0.0, 1.0, count)
    assert spline.refinable is (refined is not None)
    if refined is not None:
        assert len(spline.finer().nodes) == refined


def test_a_periodic_spline_term_is_a_sum_of_harmonics() -> None:
    """Be a sine after a mean, the same with twice the harmonics, and have these while three nodes make a wave."""
    where = np.linspace(-1.0, 1.0, 401)
    turn = 2.0 * np.pi * (where - WAVY.low) / 0.08
    # Slopes by differences at h = 2π/24 lack h²/6 of themselves, a cubic makes 4 h/27 of that: of an amplitude of 0.81.
    left = 0.81 * (2.0 * np.pi / 24.0) ** 3 / 6.0 * 4.0 / 27.0
    np.testing.assert_allclose(WAVY.at(where), 0.2 - 0.7 * np.cos(turn) + 0.4 * np.sin(turn), atol=left)
    np.testing.assert_allclose(WAVY.finer().nodes, WAVY.nodes)
    np.testing.assert_allclose(WAVY.finer().numbers, [0.08, 0.2, -0.7, 0.0, 0.4, 0.0], atol=1e-12)
    finest = WAVY
    while finest.refinable:
        finest = finest.finer()
    assert finest.harmonics == 8


def test_nodes_of_a_periodic_spline_term_are_as_sure_as_its_harmonics() -> None:
    """Carry the errors of mean, cosine and sine to the nodes: alike everywhere where these two are."""
    covariance = np.diag([9.0, 1e-3, 0.04, 0.01, 0.01])  # another parameter, the period, mean, cosine, sine
    np.testing.assert_allclose(WAVY.deviations(covariance), np.sqrt(0.04 + 0.01))
    np.testing.assert_allclose(BENT.deviations(np.diag(np.arange(1.0, 14.0))), np.sqrt(np.arange(2.0, 14.0)))


@pytest.mark.parametrize("kind", KINDS)
def test_a_blank_spline_term_changes_nothing(plain: Posed, kind: Kind) -> None:
    """Predict with a spline term of zeros exactly what is predicted without one.

    Beside a force of the velocity, of zeros too, steps of a ball that friction brakes are split (`analytic.step`).
    Their path differs by h³/12 · K c g · α̇² = 2e-10 m or less, of readings of 0.3 mm: of n = 3200 the deviance
    changes by 2 √n z · 2e-10/3e-4 = 1e-4 for each standard deviation z of their sum, and is 5e4.
    """
    spline = blank(kind, 0.0, 1.0)
    without, with_spline_term = (
        filter_run.deviance(plain.problem, Terms((), (), np.zeros(0), one), 1e-8) for one in (None, spline)
    )
    assert with_spline_term == pytest.approx(without, rel=1e-8 if kind == Kind(Regressor.VELOCITY) else 1e-9)


@pytest.mark.parametrize("spline", [BENT, WAVY])
@pytest.mark.parametrize("names", [(), ("track_curvature", "rolling_radius"), ("level_error", "ball_imbalance")])
def test_numbers_and_values_are_one_to_one(plain: Posed, names: tuple[str, ...], spline: SplineTerm) -> None:
    """Read starts as effects with values, within bounds, a phase a recording, numbers of a spline term; and back."""
    hypothesis = Hypothesis(names, spline)
    known = dict.fromkeys(hypothesis.parameters, 0.01)
    (start,) = starting_points(plain.problem, hypothesis, known, 1e-5)
    low, high = hypothesis.bounds(plain.problem)
    assert len(start) == len(low) == len(high) == hypothesis.size(plain.problem)
    assert np.all((low <= start) & (start <= high))
    read = hypothesis.terms(start, plain.problem)
    assert [value for one in read.effects for value in one.values.values()] == pytest.approx(list(known.values()))
    assert len(read.phases) == len(plain.problem.recordings)
    assert read.spline is not None
    np.testing.assert_allclose(read.spline.nodes, spline.nodes, rtol=1e-12)
    np.testing.assert_allclose(read.spline.places, spline.places, rtol=1e-12)


@pytest.mark.parametrize("kind", KINDS)
def test_a_hypothesis_from_another_process_is_equal(kind: Kind) -> None:
    """Compare a hypothesis with what its pickle gives by content, and tell one of other values from it."""
    one = Hypothesis(("viscous_damping",), blank(kind, 0.0, 1.0))
    assert one.effects  # what follows from the fields is kept, and not pickled
    other = pickle.loads(pickle.dumps(one))
    assert other == one
    assert other.spline is not one.spline
    assert hash(other) == hash(one)
    assert other.spline is not None
    moved = replace(other.spline, nodes=other.spline.nodes + 1e-9)
    assert Hypothesis(other.names, moved) != one
