"""Effects by name become numbers of the plant's laws; what is no law of the ball is left to rig, linkage, sensors."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from analytic.effects import (
    BALL_IMBALANCE,
    BEAM_COMPLIANCE,
    CONTACT_SLIP,
    DIRECTIONAL_RESISTANCE,
    ECCENTRIC_PIVOT,
    LEVEL_ERROR,
    PRESLIDING_HYSTERESIS,
    QUADRATIC_DRAG,
    ROLLING_RESISTANCE,
    STRIBECK_FRICTION,
    TRACK_BUMP,
    TRACK_CURVATURE,
    VISCOUS_DAMPING,
)
from analytic.rig import Rig
from harness.simulator.laws import Laws

if TYPE_CHECKING:
    from harness.simulator.effects import Effects

Fields = Callable[[dict[str, float], Rig], dict[str, float]]

_FIELDS: dict[str, Fields] = {
    VISCOUS_DAMPING.name: lambda v, rig: {"viscous": v["coefficient"]},
    QUADRATIC_DRAG.name: lambda v, rig: {"quadratic": v["coefficient"]},
    DIRECTIONAL_RESISTANCE.name: lambda v, rig: {"plus": v["coefficient_plus"], "minus": v["coefficient_minus"]},
    STRIBECK_FRICTION.name: lambda v, rig: {
        "plus": v["kinetic_coefficient"],
        "minus": v["kinetic_coefficient"],
        "static_excess": v["static_coefficient"] - v["kinetic_coefficient"],
        "stribeck_velocity": v["stribeck_velocity"],
    },
    TRACK_CURVATURE.name: lambda v, rig: {"curvature": v["curvature"], "curvature_centre": v["centre"]},
    TRACK_BUMP.name: lambda v, rig: {"bump": v["height"], "bump_centre": v["centre"], "bump_width": v["width"]},
    BALL_IMBALANCE.name: lambda v, rig: {"imbalance": rig.mass * rig.gravity * v["offset"]},
    BEAM_COMPLIANCE.name: lambda v, rig: {"compliance": v["compliance"] * rig.mass * rig.gravity},
    PRESLIDING_HYSTERESIS.name: lambda v, rig: {"presliding": v["coefficient"], "presliding_stiffness": v["stiffness"]},
    "gust": lambda v, rig: {"gust": v["force"], "gust_start": v["start"], "gust_end": v["end"]},
    "drifting_force": lambda v, rig: {"drift": v["rate"]},
    "fading_resistance": lambda v, rig: {"fading": v["coefficient"], "fading_time": v["time_constant"]},
    "rough_patch": lambda v, rig: {"patch": v["coefficient"], "patch_start": v["start"], "patch_end": v["end"]},
    "force_hill": lambda v, rig: {"hill": v["force"], "hill_start": v["start"], "hill_end": v["end"]},
    "magnet": lambda v, rig: {"magnet": v["force"], "magnet_centre": v["centre"], "magnet_distance": v["distance"]},
    "cubic_spring": lambda v, rig: {"spring": v["stiffness"], "spring_centre": v["centre"]},
    "cubic_drag": lambda v, rig: {"cubed": v["coefficient"]},
    "cable_pull": lambda v, rig: {"cable": v["force"], "cable_frequency": v["frequency"]},
    "sticky_spot": lambda v, rig: {"spot": v["coefficient"], "spot_width": v["width"]},
    "out_of_round": lambda v, rig: {"oval": v["torque"]},
}
# The last four are no fields of the laws but the plant's own (`Plant.with_effects`).
OWN_LAWS = frozenset((*_FIELDS, LEVEL_ERROR.name, ECCENTRIC_PIVOT.name, ROLLING_RESISTANCE.name, CONTACT_SLIP.name))
"""Names of what acts on the plant's ball by a law of its own."""
_ADDED = ("plus", "minus")  # resistances of both kinds act together


def laws_with(laws: Laws, effects: Effects, rig: Rig, turned_before: float) -> Laws:
    """`laws` with `effects` (already checked) acting too on the ball of `rig`.

    Args:
        laws: what acts already.
        effects: those that are no law of the ball are passed over.
        rig: as it is; its mass and gravity turn a length into a torque.
        turned_before: how the ball lies at the start [rad].
    """
    changes: dict[str, float] = {"turned_before": turned_before}
    for name, values in effects.items():
        if name in _FIELDS:
            for field, value in _FIELDS[name](dict(values), rig).items():
                before = changes.get(field, getattr(laws, field)) if field in _ADDED else 0.0
                changes[field] = before + value
    return laws._replace(**changes)
