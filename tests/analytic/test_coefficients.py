"""The kernel's parameters carry the units they claim: a change of units changes numbers, not motions."""

from __future__ import annotations

import math

import pytest

from analytic import models, slots
from analytic.law import acceleration
from analytic.models import MODELS, Model, Reading, coefficients
from analytic.rig import Rig
from tests.analytic.dimensions import ACCELERATION, LENGTH, MASS, NUMBER, TIME, VELOCITY, Dimension, dimension_of

# New units: 1 kg = 3 of the new ones, 1 m = 7, 1 s = 5; without a common factor, so that no two units are confused.
NEW = (3.0, 7.0, 5.0)
RIG = Rig(level_angle=0.01)
RIG_DIMENSIONS = {
    "mass": MASS,
    "inertia": MASS * LENGTH * LENGTH,
    "radius": LENGTH,
    "rolling_radius": LENGTH,
    "eccentricity": LENGTH,
    "gravity": ACCELERATION,
    "level_angle": NUMBER,
    "transition_velocity": VELOCITY,
}
FRICTION_GAIN = {
    Reading.NONE: NUMBER,
    Reading.PRINTED: NUMBER / TIME,
    Reading.PRINTED_DISSIPATIVE: NUMBER / TIME,
    Reading.COULOMB: ACCELERATION,
    Reading.VISCOUS: NUMBER / TIME,
}


def in_new_units(unit_of_f_b: str) -> Rig:
    """The same rig in the new units, taking f_b to be given in `unit_of_f_b`."""
    dimensions: dict[str, Dimension] = RIG_DIMENSIONS | {"friction_coefficient": dimension_of(unit_of_f_b)}
    return Rig(**{name: getattr(RIG, name) * dimension.scale(*NEW) for name, dimension in dimensions.items()})


def accelerations(model: Model, unit_of_f_b: str) -> tuple[float, float]:
    """s̈ in new units: converted, and computed from converted quantities."""
    _, metre, second = NEW
    old = acceleration(0.4, -0.006, 0.05, 0.3, 2.0, coefficients(model, RIG))
    p = coefficients(model, in_new_units(unit_of_f_b))
    new = acceleration(0.4 * metre, -0.006 * metre / second, 0.05, 0.3 / second, 2.0 / second**2, p)
    return old * ACCELERATION.scale(*NEW), new


@pytest.mark.parametrize("model", MODELS.values(), ids=lambda model: model.name)
def test_motion_does_not_depend_on_the_units(model: Model) -> None:
    """Give the same acceleration in any units, with f_b in the unit its reading states."""
    converted, computed = accelerations(model, model.reading.unit)
    assert computed == pytest.approx(converted, rel=1e-14)  # some ten operations of 1.1e-16 each


@pytest.mark.parametrize("model", models.FRICTION.values(), ids=lambda model: model.name)
def test_printed_unit_keeps_only_the_viscous_motion(model: Model) -> None:
    """Give different motions in different units with f_b in N s/m, unless the friction is viscous."""
    converted, computed = accelerations(model, "N s/m")
    assert math.isclose(converted, computed, rel_tol=1e-14) == model.reading.consistent_with_print


@pytest.mark.parametrize("model", MODELS.values(), ids=lambda model: model.name)
def test_each_slot_has_its_documented_unit(model: Model) -> None:
    """Convert each parameter of the kernel by the unit that `coefficients` documents."""
    dimension = {
        slots.GRAVITY: ACCELERATION,
        slots.CENTRIFUGAL: NUMBER,
        slots.ECCENTRIC: LENGTH,
        slots.LEVEL: NUMBER,
        slots.LINEAR: NUMBER,
        slots.READING: NUMBER,
        slots.FRICTION_GAIN: FRICTION_GAIN[model.reading],
        slots.TRANSITION: VELOCITY,
        slots.RESPONSE: NUMBER,
        slots.HEIGHT: LENGTH,
        slots.WEIGHT: ACCELERATION,
        slots.ROLL: NUMBER / LENGTH,
        # effects: none acts, so that every unit would do; their own tests look at them when they do
        **dict.fromkeys((*range(slots.VISCOUS, slots.ROLL), *range(slots.TURN + 1, slots.SLOTS)), NUMBER),
        slots.TRACTION: NUMBER,
        slots.TURN: LENGTH,
    }
    assert sorted(dimension) == list(range(slots.SLOTS))
    old, new = coefficients(model, RIG), coefficients(model, in_new_units(model.reading.unit))
    for slot, each in dimension.items():
        assert new[slot] == pytest.approx(old[slot] * each.scale(*NEW), rel=1e-14)


def test_variant_with_an_unknown_choice_is_refused() -> None:
    """Refuse a choice that the family does not have."""
    with pytest.raises(TypeError, match="radius_of_inertia"):
        models.CAM.variant("cam_ball", radius_of_inertia="R")
