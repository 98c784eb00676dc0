"""What may act on the ball, as compiled laws: forces, resistances, tilts of the track, torques.

A law says what acts; how the ball answers is the business of `contact`. Everything that is not set is zero.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from analytic.compiled import njit

PATCH_EDGE = 2e-3  # way along which a rough patch begins and ends: the ball's contact is no point [m]


class Laws(NamedTuple):
    """Strengths and places of everything that can act, SI units; names as in `effects.CATALOGUE` where they differ.

    Force along the beam [N]: `viscous`, `quadratic`, `cubed` (times velocity to the 1st, 2nd, 3rd power); `gust`
    between two instants; `drift` per second; `hill` between two places; `magnet` at its strongest; `spring` per m³;
    `cable` with the sine of `cable_frequency` times the angle.

    Coefficients of resistance [1]: `plus`, `minus` by direction; `static_excess` over the kinetic one; `fading`;
    `patch` between two places (their edges in the middle of 2 mm); `spot` once a revolution.

    Tilt of the track [rad]: `curvature`, `bump`, `compliance` per metre. Torque [N m]: `imbalance` with the sine of the
    angle at which the ball lies, `oval` with that of twice the angle.

    `turned_before` is how the ball lies at the start, for what depends on its marks [rad].
    """

    viscous: float = 0.0
    quadratic: float = 0.0
    cubed: float = 0.0
    gust: float = 0.0
    gust_start: float = 0.0
    gust_end: float = 0.0
    drift: float = 0.0
    hill: float = 0.0
    hill_start: float = 0.0
    hill_end: float = 1.0
    magnet: float = 0.0
    magnet_centre: float = 0.0
    magnet_distance: float = 1.0
    spring: float = 0.0
    spring_centre: float = 0.0
    cable: float = 0.0
    cable_frequency: float = 0.0
    plus: float = 0.0
    minus: float = 0.0
    static_excess: float = 0.0
    stribeck_velocity: float = 1.0
    fading: float = 0.0
    fading_time: float = 1.0
    patch: float = 0.0
    patch_start: float = 0.0
    patch_end: float = 0.0
    spot: float = 0.0
    spot_width: float = 1.0
    curvature: float = 0.0
    curvature_centre: float = 0.0
    bump: float = 0.0
    bump_centre: float = 0.0
    bump_width: float = 1.0
    compliance: float = 0.0
    imbalance: float = 0.0
    oval: float = 0.0
    presliding: float = 0.0
    presliding_stiffness: float = 1.0
    turned_before: float = 0.0


@njit(cache=True)
def force_along(s: float, v: float, angle: float, time: float, law: Laws) -> float:
    """Force on the ball's centre along the beam [N] at s [m], ṡ [m/s], α [rad] and t [s]."""
    push = -(law.viscous + (law.quadratic + law.cubed * abs(v)) * abs(v)) * v
    if law.gust != 0.0 and law.gust_start <= time < law.gust_end:
        push += law.gust
    push += law.drift * time
    if law.hill != 0.0 and law.hill_start < s < law.hill_end:
        push += law.hill * math.sin(math.pi * (s - law.hill_start) / (law.hill_end - law.hill_start)) ** 2
    if law.magnet != 0.0:
        # a small magnet beside the track pulls with x/(x² + d²)^(5/2); 25 √5/16 makes 1 of it at its strongest, x = d/2
        x = (law.magnet_centre - s) / law.magnet_distance
        push += law.magnet * 25.0 * math.sqrt(5.0) / 16.0 * x / (x * x + 1.0) ** 2.5
    push -= law.spring * (s - law.spring_centre) ** 3
    if law.cable != 0.0:
        push += law.cable * math.sin(law.cable_frequency * angle)
    return push


@njit(cache=True)
def resistance_coefficients(s: float, v: float, rolled: float, time: float, law: Laws) -> tuple[float, float]:
    """c₊ and c₋ [1] against rolling towards + and −, beyond the plant's own, at s [m], ṡ [m/s], φ − α [rad], t [s]."""
    either = 0.0
    if law.static_excess != 0.0:
        either += law.static_excess * math.exp(-((v / law.stribeck_velocity) ** 2))
    if law.fading != 0.0:
        either += law.fading * math.exp(-time / law.fading_time)
    if law.patch != 0.0:
        inside = min((s - law.patch_start) / PATCH_EDGE, (law.patch_end - s) / PATCH_EDGE) + 0.5
        either += law.patch * min(max(inside, 0.0), 1.0)
    if law.spot != 0.0:
        either += law.spot * math.exp((math.cos(rolled + law.turned_before) - 1.0) / law.spot_width**2)
    return law.plus + either, law.minus + either


@njit(cache=True)
def track_tilt(s: float, law: Laws) -> float:
    """What the track's own slope at s [m] adds to the tilt, positive where it falls towards +s [rad]."""
    tilt = law.curvature * (law.curvature_centre - s) + law.compliance * s
    if law.bump != 0.0:
        u = (s - law.bump_centre) / law.bump_width
        tilt += law.bump / law.bump_width * u * math.exp(-0.5 * u * u)
    return tilt


@njit(cache=True)
def ball_torque(rolled: float, law: Laws) -> float:
    """Torque on the ball about +y [N m], towards +s where positive, at φ − α [rad]."""
    if law.imbalance == 0.0 and law.oval == 0.0:
        return 0.0
    lies = rolled + law.turned_before
    return law.imbalance * math.sin(lies) + law.oval * math.sin(2.0 * lies)


@njit(cache=True)
def dahl(stretch: float, way: float, normal_force: float, law: Laws) -> tuple[float, float]:
    """Stretch z [m] after rolling by `way` [m] from `stretch`, and its mean on the way; the force is −σ z.

    dz/dt = ṡ − |ṡ| z σ/F_c, F_c = c N, solved for a constant N. Dahl, "A solid friction model", Aerospace Corporation
    TOR-0158(3107-18)-1, 1968.
    """
    limit = law.presliding * normal_force / law.presliding_stiffness
    if limit <= 0.0:
        return stretch, 0.0
    end = limit if way > 0.0 else -limit
    passed = abs(way) / limit
    if passed < 1e-9:
        return stretch + way - abs(way) * stretch / limit, stretch
    approach = -math.expm1(-passed)
    return stretch + (end - stretch) * approach, end + (stretch - end) * approach / passed
