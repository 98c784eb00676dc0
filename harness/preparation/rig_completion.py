"""A full rig from what is known of it: given first, then estimated, then assumed, and every step of that on record.

Trajectories depend on the ball only through K = 1/(1 + J/(m r²)) and ℓ = h + r + J/(m r): that is what is estimated.
Quantities behind them that no trajectory shows are assumed, so that engines have a ball and a groove to work with.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

from analytic.rig import SOLID_SPHERE, Rig
from harness.errors import InputError
from harness.preparation.rig_estimate import Estimate, Fitted, Observed, fit_unknown
from harness.recording import KnownRig

_LEVER_TRUSTED = 0.02  # an estimated lever less sure than this says nothing about the pivot [m]
_LEAST_RATIO = 0.05  # a solid ball in a groove of r = 0.15 R: no rig rolls so slowly
_GROOVES = (0.3, 0.995)  # r/R: a deeper groove hides the ball, a flatter one cannot hold it
_LABELS = {"mass": ("mass m", "kg"), "radius": ("ball radius R", "m"), "gravity": ("gravity g", "m/s²")}


def missing(known: KnownRig) -> frozenset[str]:
    """Which of "ratio" (K) and "lever" (ℓ) the known quantities leave open."""
    unknown = set(known.unknown)
    open_ = {"ratio"} if unknown & {"mass", "inertia", "rolling_radius"} else set()
    return frozenset(open_ | ({"lever"} if "eccentricity" in unknown else set()))


def rough_rig(known: KnownRig) -> Rig:
    """What is known, completed by a solid ball in the paper's proportions: good enough to measure the ball against."""
    radius = known.radius or (
        known.rolling_radius * Rig.radius / Rig.rolling_radius if known.rolling_radius else Rig.radius
    )
    solid = SOLID_SPHERE * radius**2
    mass = known.mass or (known.inertia / solid if known.inertia else Rig.mass)
    return known.complete(
        mass=mass,
        radius=radius,
        inertia=solid * mass,
        rolling_radius=radius * Rig.rolling_radius / Rig.radius,
        eccentricity=0.0,
        gravity=Rig.gravity,
    )


def complete(
    known: KnownRig, rough: Rig, observed: Callable[[], Sequence[Observed]], *, level: bool
) -> tuple[Rig, Fitted | None, list[Estimate]]:
    """Complete `rough` by estimates from the recordings, which are asked for only if something is to be estimated.

    Args:
        known: what the rig file says.
        rough: the same, completed roughly.
        observed: gives the recordings to estimate from.
        level: whether α₀ is to be estimated too.

    Returns:
        The rig, what was fitted (`None` if nothing had to be), and what was estimated or assumed.
    """
    assumed = [
        _assumed(label, getattr(rough, name), unit, "no trajectory depends on it but through K, ℓ and g")
        for name, (label, unit) in _LABELS.items()
        if name in known.unknown
    ]
    wanted = missing(known)
    if not (wanted or level):
        return rough, None, assumed
    records = observed()
    ratio, lever = "ratio" in wanted, "lever" in wanted
    fitted = fit_unknown(records, rough, ratio=ratio, level=level, lever=lever)
    if fitted.ratio < _LEAST_RATIO:
        raise InputError(
            f"the recordings show a ball that does not roll down the recorded angle (K = {fitted.ratio:.2f} ± "
            f"{fitted.std[0]:.2f}, where 0.3 to 0.72 is usual); check units and signs: α > 0 must lower the +s end"
        )
    shown = lever and fitted.std[2] <= _LEVER_TRUSTED
    if lever and not shown:
        fitted = fit_unknown(records, rough, ratio=ratio, level=level, lever=False)
    count = "one recording" if len(records) == 1 else f"{len(records)} recordings"
    beside = f"rolling friction f = {fitted.friction:.2g} ± {fitted.friction_std:.1g} fitted beside"
    how = f"generalised least squares on {count}, {beside}"
    estimates: list[Estimate] = []
    rig = rough.with_(level_angle=fitted.level)
    if ratio:
        estimates.append(Estimate("rolling ratio K", fitted.ratio, fitted.std[0], "1", how))
        rig, how_it_rolls = rig_of_ratio(known, rig, fitted.ratio)
        estimates.append(how_it_rolls)
    if shown:
        eccentricity = fitted.lever - rig.rolling_radius - rig.inertia / (rig.mass * rig.rolling_radius)
        rig = rig.with_(eccentricity=eccentricity)
        estimates.append(Estimate("eccentricity h", eccentricity, fitted.std[2], "m", how))
    elif lever:
        estimates.append(_assumed("eccentricity h", 0.0, "m", "the α̈ term is too weak here to tell"))
    if level:
        estimates.append(Estimate("level angle α₀", fitted.level, fitted.std[1], "rad", how))
    return rig, fitted, [*estimates, *assumed]


def rig_of_ratio(known: KnownRig, rig: Rig, ratio: float) -> tuple[Rig, Estimate]:
    """A rig that accelerates with K = `ratio`, what is known of it left as it is; and the quantity that was chosen so.

    Trajectories fix only J/(m r²) = 1/K − 1. A ball of known or solid inertia gets the r that belongs to it; where no
    groove does, or r is known, J or else m is chosen. Where K ≥ 1 (no rolling body accelerates so) gravity carries the
    rest, as a wrong gain of the angle would.
    """
    if ratio >= 1.0:
        gravity = rig.gravity * ratio / rig.rolling_ratio
        why = "scaled: K ≥ 1 cannot be rolling; check the angle's gain"
        return rig.with_(gravity=gravity), _assumed("gravity g", gravity, "m/s²", why)
    share = 1.0 / ratio - 1.0
    low, high = (share_of * rig.radius for share_of in _GROOVES)
    r = math.sqrt(rig.inertia / (rig.mass * share))
    if known.rolling_radius is None and low <= r <= high:
        return rig.with_(rolling_radius=r), _assumed("rolling radius r", r, "m", "from K, for this ball's inertia")
    if known.inertia is not None and known.mass is None:
        mass = rig.inertia / (rig.rolling_radius**2 * share)
        return rig.with_(mass=mass), _assumed("mass m", mass, "kg", "from K")
    inertia = rig.mass * rig.rolling_radius**2 * share
    why = (
        "from K" if known.inertia is None else "from K, against the rig file: no groove gives it with the declared one"
    )
    return rig.with_(inertia=inertia), _assumed("inertia J", inertia, "kg m²", why)


def _assumed(name: str, value: float, unit: str, why: str) -> Estimate:
    return Estimate(name, value, math.inf, unit, f"assumed: {why}")
