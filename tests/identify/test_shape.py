"""Curves of unknown law, and how hypotheses become numbers and back."""

from __future__ import annotations

import numpy as np
import pytest

from analytic.law import curve
from analytic.models import NODES, SHAPE, SLOTS
from harness.identify.hypothesis import Hypothesis
from harness.identify.shape import KINDS, Depends, Shape, blank
from tests.identify.conftest import Posed

BENT = Shape(Depends.POSITION, False, 0.1, 0.04, np.sin(np.arange(NODES)))


def test_a_curve_is_linear_between_nodes_and_constant_beyond() -> None:
    """Meet the nodes, halve between two, and keep the last value outside."""
    np.testing.assert_allclose(BENT.at(BENT.places), BENT.nodes, rtol=1e-12)
    between = 0.5 * (BENT.places[1:] + BENT.places[:-1])
    np.testing.assert_allclose(BENT.at(between), 0.5 * (BENT.nodes[1:] + BENT.nodes[:-1]), rtol=1e-12)
    np.testing.assert_array_equal(BENT.at(np.array([-9.0, 9.0])), BENT.nodes[[0, -1]])


def test_the_kernel_reads_the_same_curve() -> None:
    """Write a curve so that the compiled law sees what `at` says, on nodes, between and beyond them."""
    p = np.zeros(SLOTS)
    BENT.write(p)
    where = np.linspace(0.0, 0.7, 101)
    # Both are one linear interpolation: rounding of the place, 1e-16 · 0.5/0.04, times slopes of order 1.
    np.testing.assert_allclose([curve(x, p) for x in where], BENT.at(where), atol=1e-14)


def test_a_force_of_time_is_a_tilt(plain: Posed) -> None:
    """Add f/g to the angle and nothing to its rates; a friction of time becomes a column of its own."""
    record, gravity = plain.problem.records[0], plain.problem.rig.gravity
    force = Shape(Depends.TIME, False, 0.0, 16.0 / (NODES - 1), np.linspace(0.0, 0.5, NODES))
    loaded = force.load(record.table, record.times, gravity)
    np.testing.assert_allclose(loaded[:, 0] - record.table[:, 0], force.at(record.times) / gravity, atol=1e-15)
    np.testing.assert_array_equal(loaded[:, 1:], record.table[:, 1:])
    p = np.zeros(SLOTS)
    force.write(p)
    assert p[SHAPE] == 0.0
    dry = Shape(Depends.TIME, True, force.low, force.step, force.nodes)
    column = dry.load(record.table, record.times, gravity)
    np.testing.assert_array_equal(column[:, -1], dry.at(record.times))


@pytest.mark.parametrize(("depends", "friction"), KINDS)
def test_a_blank_curve_changes_nothing(plain: Posed, depends: Depends, friction: bool) -> None:
    """Predict with a curve of zeros exactly what is predicted without one."""
    shape = blank(depends, friction, 0.0, 1.0)
    without, with_curve = (plain.problem.deviance((), np.zeros(2), 1e-8, one) for one in (None, shape))
    assert with_curve == pytest.approx(without, rel=1e-9)


@pytest.mark.parametrize("names", [(), ("track_curvature", "rolling_radius"), ("level_error", "ball_imbalance")])
def test_numbers_and_values_are_one_to_one(plain: Posed, names: tuple[str, ...]) -> None:
    """Read starts as effects with values, within bounds, a phase a recording and a node a number; and back."""
    hypothesis = Hypothesis(names, BENT)
    known = dict.fromkeys(hypothesis.parameters, 0.01)
    (start,) = hypothesis.starts(plain.problem, known, 1e-5)
    low, high = hypothesis.bounds(plain.problem)
    assert len(start) == len(low) == len(high) == hypothesis.size(plain.problem)
    assert np.all((low <= start) & (start <= high))
    read = hypothesis.read(start, plain.problem)
    assert [value for one in read.effects for value in one.values.values()] == pytest.approx(list(known.values()))
    assert len(read.phases) == len(plain.problem.records)
    assert read.shape is not None
    np.testing.assert_allclose(read.shape.nodes, BENT.nodes, rtol=1e-12)
