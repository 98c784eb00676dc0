"""What may act on the ball, as compiled laws: forces, resistances, tilts of the track, torques.

A law says what acts; how the ball answers is the business of `contact`. Everything that is not set does nothing.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

from analytic.compiled import njit
from analytic.rig import Rig

PATCH_EDGE = 2e-3  # way along which a rough patch begins and ends: the ball's contact is no point [m]


class Laws(NamedTuple):
    """Parameters of everything that can act on the ball by a law of the plant's own, SI units.

    A field is called after effect and parameter; what they mean is said in the catalogue and in `effects.UNLISTED`.
    Besides, `weight` is m g [N], and `turned_before` how the ball lies at the start, which matters to its marks [rad].
    """

    viscous_damping_coefficient: float = 0.0
    quadratic_drag_coefficient: float = 0.0
    cubic_drag_coefficient: float = 0.0
    gust_force: float = 0.0
    gust_start: float = 0.0
    gust_end: float = 0.0
    settling_force_force: float = 0.0
    settling_force_time_constant: float = 1.0
    force_hill_force: float = 0.0
    force_hill_start: float = 0.0
    force_hill_end: float = 1.0
    ripple_force_force: float = 0.0
    ripple_force_wavelength: float = 1.0
    magnet_force: float = 0.0
    magnet_centre: float = 0.0
    magnet_distance: float = 1.0
    cubic_spring_stiffness: float = 0.0
    cubic_spring_centre: float = 0.0
    cable_pull_force: float = 0.0
    cable_pull_frequency: float = 0.0
    directional_resistance_coefficient_plus: float = 0.0
    directional_resistance_coefficient_minus: float = 0.0
    stribeck_friction_static_coefficient: float = 0.0
    stribeck_friction_kinetic_coefficient: float = 0.0
    stribeck_friction_stribeck_velocity: float = 1.0
    fading_resistance_coefficient: float = 0.0
    fading_resistance_time_constant: float = 1.0
    rough_patch_coefficient: float = 0.0
    rough_patch_start: float = 0.0
    rough_patch_end: float = 0.0
    sticky_spot_coefficient: float = 0.0
    sticky_spot_width: float = 1.0
    track_curvature_curvature: float = 0.0
    track_curvature_centre: float = 0.0
    track_bump_height: float = 0.0
    track_bump_centre: float = 0.0
    track_bump_width: float = 1.0
    beam_compliance_compliance: float = 0.0
    ball_imbalance_offset: float = 0.0
    out_of_round_torque: float = 0.0
    presliding_hysteresis_coefficient: float = 0.0
    presliding_hysteresis_stiffness: float = 1.0
    weight: float = 0.0
    turned_before: float = 0.0

    def with_effects(self, effects: Mapping[str, Mapping[str, float]], rig: Rig, turned_before: float) -> Laws:
        """The same with `effects` acting too on the ball of `rig`; what is no law of the ball is passed over."""
        given = {f"{name}_{key}": value for name, values in effects.items() for key, value in values.items()}
        changes = {field: value for field, value in given.items() if field in self._fields}
        return self._replace(**changes, weight=rig.mass * rig.gravity, turned_before=turned_before)


@njit(cache=True)
def force_along(s: float, v: float, angle: float, time: float, law: Laws) -> float:
    """Force on the ball's centre along the beam [N] at s [m], ṡ [m/s], α [rad] and t [s]."""
    damping = (law.quadratic_drag_coefficient + law.cubic_drag_coefficient * abs(v)) * abs(v)
    push = -(law.viscous_damping_coefficient + damping) * v
    if law.gust_force != 0.0 and law.gust_start <= time < law.gust_end:
        push += law.gust_force
    if law.settling_force_force != 0.0:
        push -= law.settling_force_force * math.expm1(-time / law.settling_force_time_constant)
    if law.force_hill_force != 0.0 and law.force_hill_start < s < law.force_hill_end:
        width = law.force_hill_end - law.force_hill_start
        push += law.force_hill_force * math.sin(math.pi * (s - law.force_hill_start) / width) ** 2
    if law.ripple_force_force != 0.0:
        push += law.ripple_force_force * math.sin(2.0 * math.pi * s / law.ripple_force_wavelength)
    if law.magnet_force != 0.0:
        # a small magnet beside the track pulls with x/(x² + d²)^(5/2); 25 √5/16 makes 1 of it at its strongest, x = d/2
        x = (law.magnet_centre - s) / law.magnet_distance
        push += law.magnet_force * 25.0 * math.sqrt(5.0) / 16.0 * x / (x * x + 1.0) ** 2.5
    push -= law.cubic_spring_stiffness * (s - law.cubic_spring_centre) ** 3
    if law.cable_pull_force != 0.0:
        push += law.cable_pull_force * math.sin(law.cable_pull_frequency * angle)
    return push


@njit(cache=True)
def resistance_coefficients(s: float, v: float, rolled: float, time: float, law: Laws) -> tuple[float, float]:
    """c₊ and c₋ [1] against rolling towards + and −, beyond the plant's own, at s [m], ṡ [m/s], φ − α [rad], t [s]."""
    either, kinetic = 0.0, law.stribeck_friction_kinetic_coefficient
    excess = law.stribeck_friction_static_coefficient - kinetic
    if excess != 0.0:
        either += excess * math.exp(-((v / law.stribeck_friction_stribeck_velocity) ** 2))
    if law.fading_resistance_coefficient != 0.0:
        either += law.fading_resistance_coefficient * math.exp(-time / law.fading_resistance_time_constant)
    if law.rough_patch_coefficient != 0.0:
        inside = min((s - law.rough_patch_start) / PATCH_EDGE, (law.rough_patch_end - s) / PATCH_EDGE) + 0.5
        either += law.rough_patch_coefficient * min(max(inside, 0.0), 1.0)
    if law.sticky_spot_coefficient != 0.0:
        turned = math.cos(rolled + law.turned_before) - 1.0
        either += law.sticky_spot_coefficient * math.exp(turned / law.sticky_spot_width**2)
    plus, minus = law.directional_resistance_coefficient_plus, law.directional_resistance_coefficient_minus
    return plus + kinetic + either, minus + kinetic + either


@njit(cache=True)
def track_tilt(s: float, law: Laws) -> float:
    """What the track's own slope at s [m] adds to the tilt, positive where it falls towards +s [rad]."""
    tilt = law.track_curvature_curvature * (law.track_curvature_centre - s)
    tilt += law.beam_compliance_compliance * law.weight * s
    if law.track_bump_height != 0.0:
        u = (s - law.track_bump_centre) / law.track_bump_width
        tilt += law.track_bump_height / law.track_bump_width * u * math.exp(-0.5 * u * u)
    return tilt


@njit(cache=True)
def ball_torque(rolled: float, law: Laws) -> float:
    """Torque on the ball about +y [N m], towards +s where positive, at φ − α [rad]."""
    if law.ball_imbalance_offset == 0.0 and law.out_of_round_torque == 0.0:
        return 0.0
    lies = rolled + law.turned_before
    return law.weight * law.ball_imbalance_offset * math.sin(lies) + law.out_of_round_torque * math.sin(2.0 * lies)


@njit(cache=True)
def dahl(stretch: float, way: float, normal_force: float, law: Laws) -> tuple[float, float]:
    """Stretch z [m] after rolling by `way` [m] from `stretch`, and its mean on the way; the force is −σ z.

    dz/dt = ṡ − |ṡ| z σ/F_c, F_c = c N, solved for a constant N. Dahl, "A solid friction model", Aerospace Corporation
    TOR-0158(3107-18)-1, 1968.
    """
    limit = law.presliding_hysteresis_coefficient * normal_force / law.presliding_hysteresis_stiffness
    if limit <= 0.0:
        return stretch, 0.0
    end = limit if way > 0.0 else -limit
    passed = abs(way) / limit
    if passed < 1e-9:
        return stretch + way - abs(way) * stretch / limit, stretch
    approach = -math.expm1(-passed)
    return stretch + (end - stretch) * approach, end + (stretch - end) * approach / passed
