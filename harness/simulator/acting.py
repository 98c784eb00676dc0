"""Effects by name become numbers of the plant's laws; what is no law of the ball is left to rig, linkage, sensors."""

from __future__ import annotations

from collections.abc import Callable

from analytic.rig import Rig
from harness.simulator.effects import Effects
from harness.simulator.laws import Laws

Fields = Callable[[dict[str, float], Rig], dict[str, float]]

_FIELDS: dict[str, Fields] = {
    "viscous_damping": lambda v, rig: {"viscous": v["coefficient"]},
    "quadratic_drag": lambda v, rig: {"quadratic": v["coefficient"]},
    "directional_resistance": lambda v, rig: {"plus": v["coefficient_plus"], "minus": v["coefficient_minus"]},
    "stribeck_friction": lambda v, rig: {
        "plus": v["kinetic_coefficient"],
        "minus": v["kinetic_coefficient"],
        "static_excess": v["static_coefficient"] - v["kinetic_coefficient"],
        "stribeck_velocity": v["stribeck_velocity"],
    },
    "track_curvature": lambda v, rig: {"curvature": v["curvature"], "curvature_centre": v["centre"]},
    "track_bump": lambda v, rig: {"bump": v["height"], "bump_centre": v["centre"], "bump_width": v["width"]},
    "ball_imbalance": lambda v, rig: {"imbalance": rig.mass * rig.gravity * v["offset"]},
    "beam_compliance": lambda v, rig: {"compliance": v["compliance"] * rig.mass * rig.gravity},
    "presliding_hysteresis": lambda v, rig: {
        "presliding": v["coefficient"],
        "presliding_stiffness": v["stiffness"],
    },
    "gust": lambda v, rig: {"gust": v["force"], "gust_start": v["start"], "gust_end": v["end"]},
    "drifting_force": lambda v, rig: {"drift": v["rate"]},
    "fading_resistance": lambda v, rig: {"fading": v["coefficient"], "fading_time": v["time_constant"]},
    "rough_patch": lambda v, rig: {"patch": v["coefficient"], "patch_start": v["start"], "patch_end": v["end"]},
    "force_hill": lambda v, rig: {"hill": v["force"], "hill_start": v["start"], "hill_end": v["end"]},
    "magnet": lambda v, rig: {
        "magnet": v["force"],
        "magnet_centre": v["centre"],
        "magnet_distance": v["distance"],
    },
    "cubic_spring": lambda v, rig: {"spring": v["stiffness"], "spring_centre": v["centre"]},
    "cubic_drag": lambda v, rig: {"cubed": v["coefficient"]},
    "cable_pull": lambda v, rig: {"cable": v["force"], "cable_frequency": v["frequency"]},
    "sticky_spot": lambda v, rig: {"spot": v["coefficient"], "spot_width": v["width"]},
    "out_of_round": lambda v, rig: {"oval": v["torque"]},
}
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
