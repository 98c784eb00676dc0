"""Combinations that recordings do not tell apart, in words."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from harness.tuning.estimate.fit import Fitted
from harness.tuning.estimate.free import Free
from harness.tuning.estimate.selection import Screened, Selection
from harness.tuning.identifiability import INDEX, combinations

RADIUS = Free("rolling_radius_m", "m", 0.0118, 0.004, 0.0132, True, (0.011,), quantity="rolling_radius")
INERTIA = Free("inertia_kg_m2", "kg m²", 5e-6, 1.6e-6, 1.5e-5, True, (4e-6,), quantity="inertia")
RADIUS_ALONE = (RADIUS.name,)


def selection(jacobian: np.ndarray) -> Selection:
    """A fit of both quantities with these sensitivities, shape (readings, 2)."""
    count = len(jacobian)
    values = {"rolling_radius_m": 0.0118, "inertia_kg_m2": 5e-6}
    free = (RADIUS, INERTIA)
    window, starts = np.zeros(count, dtype=np.int64), np.zeros((1, 2))
    found = Fitted(tuple(values), free, values, starts, np.zeros(count), 0.0, jacobian, window)
    return Selection(found, found, {}, (), tuple(values))


def test_quantities_that_act_alike_are_not_identifiable_together() -> None:
    """Name both where only J/(m r²) acts, and by how much one undoes the other: 2 % of J for 1 % of r."""
    run = np.linspace(0.0, 1.0, 50) ** 2
    wiggle = 1e-3 * np.sin(np.arange(50))
    (one,) = combinations(selection(np.column_stack((2.0 * run, -run + wiggle))), (RADIUS, INERTIA))
    assert one.index > INDEX
    assert set(one.moves) == {"rolling_radius_m", "inertia_kg_m2"}
    ratio = one.moves["inertia_kg_m2"] / one.moves["rolling_radius_m"]
    assert np.isclose(ratio, 2.0, rtol=0.02)  # the wiggle is a thousandth of the run and turns it by as little
    assert "is undone by" in one.text


def test_quantities_that_act_differently_are_told_apart() -> None:
    """Name no combination where the sensitivities are orthogonal."""
    time = np.linspace(0.0, 2.0 * np.pi, 50, endpoint=False)
    assert combinations(selection(np.column_stack((np.sin(time), np.cos(time)))), (RADIUS, INERTIA)) == ()


def test_a_quantity_that_was_not_fitted_moves_as_if_it_were() -> None:
    """Give the same combination where the inertia, at its default, has only been screened."""
    run = np.linspace(0.0, 1.0, 50) ** 2
    wiggle = 1e-3 * np.sin(np.arange(50))
    both = selection(np.column_stack((2.0 * run, -run + wiggle)))
    found = replace(both.found, names=RADIUS_ALONE, free=(RADIUS,), jacobian=both.found.jacobian[:, :1])
    (at,) = INERTIA.tried
    assert INERTIA.default is not None
    response = both.found.jacobian[:, 1] * (INERTIA.scaled(at) - INERTIA.scaled(INERTIA.default))
    screened = {INERTIA.name: Screened(INERTIA.name, 10.0, (at,), (), 0.0, response, at)}
    alone = Selection(found, found, screened, (), RADIUS_ALONE)
    (fitted,), (one,) = (combinations(each, (RADIUS, INERTIA)) for each in (both, alone))
    assert one.moves == pytest.approx(fitted.moves)
