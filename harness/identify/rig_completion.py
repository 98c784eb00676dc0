"""Completes a partly known rig: unknown quantities are estimated from recordings or assumed, and reported as such.

Trajectories depend on the ball only through the rolling ratio K = 1/(1 + J/(m r²)) and the lever ℓ = h + r + J/(m r).
These are estimated; quantities that no trajectory identifies are assumed, because the engines need a complete rig.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from analytic.effects import CHANNEL_DELAY, ROLLING_RESISTANCE, VISCOUS_DAMPING, Effect
from analytic.rig import HOLLOW_SPHERE, SOLID_SPHERE, Rig, RigError
from harness.errors import InputError
from harness.identify.estimate.rig import FittedRig, fit_rig
from harness.identify.problem.problem import Problem
from harness.preparation.declared_effects import declared_effects
from harness.preparation.recordings import MIN_POSITIONS, observe
from harness.recording import Case, KnownRig, Recording
from harness.recording.findings import DataFinding
from harness.threads import in_threads

_USUAL = (0.3, 0.72)  # K of solid balls from a groove with r = 0.41 R to a flat rail
_OTHER = 4.0  # standard errors by which a K is another: normal ones are exceeded once in 16,000
_MIN_ROLLING_RATIO = 0.05  # K of a solid ball at r = 0.15 R; lower values indicate wrong units or signs
_RADIUS_RATIO_RANGE = (0.3, 1.0)  # of r/R: below, the ball sinks into the groove; 1 is a flat rail
# Standard errors. Three rather than two: the other reading, a ball whose mass is concentrated at its centre, is rare.
_FLAT_WITHIN = 3.0
_ANGLE_TO_CHECK = (
    "If the recorded angle is that of a crank or motor, or its unit is another one, give its gain or the linkage when "
    "importing (docs/import.md)"
)
_BESIDE = {
    ROLLING_RESISTANCE: "a rolling friction f =",
    VISCOUS_DAMPING: "a viscous damping of",
    CHANNEL_DELAY: "a delay of",
}
"""What is fitted together with K, in words."""
_SAME = 1e-9  # relative difference of a value that was left as it is
_LABELS = {"mass": ("mass m", "kg"), "radius": ("ball radius R", "m"), "gravity": ("gravity g", "m/s²")}


def missing(known: KnownRig) -> frozenset[str]:
    """Which of "ratio" (K) and "lever" (ℓ) do not follow from the known quantities."""
    unknown = set(known.unknown)
    open_ = {"ratio"} if unknown & {"mass", "inertia", "rolling_radius"} else set()
    return frozenset(open_ | ({"lever"} if "eccentricity" in unknown else set()))


def rough_rig(known: KnownRig) -> Rig:
    """First guess: the known quantities, completed by a solid ball with the paper's r/R and h = 0."""
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


@dataclass(frozen=True)
class RigEstimate:
    """One estimated quantity: value and standard error in `unit` (infinite if assumed), and the method."""

    name: str
    value: float
    std: float
    unit: str
    how: str


@dataclass(frozen=True)
class CompletedRig:
    """A complete rig.

    Attributes:
        rig: with estimates and assumptions where the rig file has nothing.
        fitted: K, ℓ, α₀ and their covariance; `None` if nothing had to be estimated.
        estimates: all estimated or assumed quantities.
    """

    rig: Rig
    fitted: FittedRig | None
    estimates: tuple[RigEstimate, ...]

    @property
    def tells_lever(self) -> bool:
        """Whether the lever ℓ was unknown and the recordings tell it."""
        return self.fitted is not None and self.fitted.std[2] > 0.0


class NotRolling(InputError):
    """Recordings of a ball that does not roll down the recorded angle: signs or units are wrong."""


def complete_rig(case: Case, first: Recording, level_angle: float | Literal["estimate"] | None = None) -> CompletedRig:
    """Completes a case's rig by estimates from its recordings, and by assumptions.

    Args:
        case: the rig file and the recordings for identification.
        first: recording that is used in any case.
        level_angle: α₀ [rad]; "estimate"; `None` for that of rig.toml, or 0 if it has none and the rig is known.

    Raises:
        NotRolling: the estimated K is implausibly small.
        InputError: the level angle is impossible, `first` has no positions, or a declared effect is not in the
            catalogue.
    """
    known, rough, wanted = case.rig, rough_rig(case.rig), missing(case.rig)
    level = level_angle == "estimate" or (level_angle is None and known.level_angle is None and bool(wanted))
    if level_angle not in (None, "estimate"):
        try:
            rough = rough.with_(level_angle=float(level_angle))
        except RigError as error:
            raise InputError(f"--level-angle: {error}") from error
    assumed = tuple(
        _assumed(label, getattr(rough, name), unit, "trajectories depend on it only through K, ℓ and g")
        for name, (label, unit) in _LABELS.items()
        if name in known.unknown
    )
    if not (wanted or level):
        return CompletedRig(rough, None, assumed)
    others = (case.recordings[name] for name in case.identify if name != first.name)
    used = (first, *(one for one in others if int(one.usable.sum()) >= MIN_POSITIONS))
    problem = Problem.of([observe(one, case.sensors, rough) for one in used], rough, declared_effects(case))
    ratio, lever = "ratio" in wanted, "lever" in wanted
    fitted = _fitted(problem, ratio=ratio, level=level, lever=lever)
    if not all(map(math.isfinite, (fitted.ratio, fitted.level, fitted.lever))):
        raise InputError(
            f"{case.path}: the recordings do not determine rolling ratio K, level angle and lever of this rig. "
            "Add what is known of it to rig.toml ([ball], [beam]), or record longer, with more positions."
        )
    if fitted.ratio < _MIN_ROLLING_RATIO:
        turned = (
            "the sign of angle or position is reversed"
            if fitted.ratio < -_MIN_ROLLING_RATIO
            else "check signs and units"
        )
        raise NotRolling(
            f"{case.path}: the recordings show a ball that does not roll down the recorded angle (K = "
            f"{fitted.ratio:.2f} ± {fitted.std[0]:.2f}, where {_USUAL[0]:g} to {_USUAL[1]:g} is usual): {turned}; "
            f"α > 0 must lower the +s end. {_ANGLE_TO_CHECK}"
        )
    count = "one recording" if len(used) == 1 else f"{len(used)} recordings"
    together = " and ".join(f"{_BESIDE[effect]} {_written(effect, *each)}" for effect, each in fitted.beside.items())
    how = f"least squares on the innovations of {count}, together with {together}"
    estimates: list[RigEstimate] = []
    rig = rough.with_(level_angle=fitted.level)
    if ratio:
        estimates.append(RigEstimate("rolling ratio K", fitted.ratio, fitted.std[0], "1", how))
        rig, chosen = rig_of_ratio(known, rig, fitted.ratio, fitted.std[0])
        estimates.append(chosen)
    if fitted.std[2]:
        eccentricity = fitted.lever - rig.rolling_radius - rig.inertia / (rig.mass * rig.rolling_radius)
        rig = rig.with_(eccentricity=eccentricity)
        estimates.append(RigEstimate("eccentricity h", eccentricity, fitted.std[2], "m", how))
    elif lever:
        estimates.append(_assumed("eccentricity h", 0.0, "m", "the α̈ term is too weak to estimate it"))
    if level:
        estimates.append(RigEstimate("level angle α₀", fitted.level, fitted.std[1], "rad", how))
    return CompletedRig(rig, fitted, (*estimates, *assumed))


def _written(effect: Effect, value: float, std: float) -> str:
    """Value and standard error of an effect's only parameter, with its unit if it has one."""
    unit = effect.parameters[0].unit
    return f"{round(value, 6):.2g} ± {std:.1g}" + (f" {unit}" if unit != "1" else "")


def _fitted(problem: Problem, *, ratio: bool, level: bool, lever: bool) -> FittedRig:
    """The estimate beside a rolling friction, or beside viscous damping and a delay.

    These are taken where they lower the BIC as much as an effect has to, and K is another by more than its error (the
    friction then stands for what it is not), or a ball's only with them. Where both agree, the simpler model is kept.
    """
    known = {term.effect for term in problem.declared} & {VISCOUS_DAMPING, CHANNEL_DELAY}

    def fitted(damped: bool) -> FittedRig:
        return fit_rig(problem, ratio=ratio, level=level, lever=lever, damped=damped)

    if not ratio or known:
        return fitted(False)
    plain, damped = in_threads(fitted, (False, True))
    better = damped.deviance < plain.deviance - problem.least_gain
    another = damped.ratio - plain.ratio > _OTHER * plain.std[0]
    rolls = plain.ratio < _MIN_ROLLING_RATIO <= damped.ratio
    return damped if better and (another or rolls) else plain


def rig_of_ratio(known: KnownRig, rig: Rig, ratio: float, std: float = 0.0) -> tuple[Rig, RigEstimate]:
    """A rig with rolling ratio K = `ratio` and its known quantities unchanged; and the quantity adapted for this.

    K determines only J/(m r²) = 1/K − 1. For a ball of known or solid inertia, r is adapted; if r is known or would be
    outside `_RADIUS_RATIO_RANGE`, J or else m. A K that exceeds that of this ball on a flat rail, r = R, by at most
    three standard errors `std` is taken for that of the flat rail. K ≥ 1 is impossible for a rolling body; then g is
    scaled, which is equivalent to a gain of the angle.
    """
    if ratio >= 1.0:
        gravity = rig.gravity * ratio / rig.rolling_ratio
        why = "scaled: K ≥ 1 cannot be rolling; check the angle's gain"
        return rig.with_(gravity=gravity), _assumed("gravity g", gravity, "m/s²", why)
    share = 1.0 / ratio - 1.0
    low, high = (share_of * rig.radius for share_of in _RADIUS_RATIO_RANGE)
    r = math.sqrt(rig.inertia / (rig.mass * share))
    if known.rolling_radius is None and low <= r <= high:
        return rig.with_(rolling_radius=r), _assumed("rolling radius r", r, "m", "from K, for this ball's inertia")
    flat = rig.with_(rolling_radius=rig.radius)
    if known.rolling_radius is None and 0.0 <= ratio - flat.rolling_ratio <= _FLAT_WITHIN * std:
        why = f"a flat rail, whose K = {flat.rolling_ratio:.4f} is within three standard errors of the estimate"
        return flat, _assumed("rolling radius r", rig.radius, "m", why)
    if known.inertia is not None and known.mass is None:
        mass = rig.inertia / (rig.rolling_radius**2 * share)
        return rig.with_(mass=mass), _assumed("mass m", mass, "kg", "from K")
    inertia = rig.mass * rig.rolling_radius**2 * share
    why = (
        "from K"
        if known.inertia is None
        else "from K, contrary to the rig file: no r is possible with the declared value"
    )
    return rig.with_(inertia=inertia), _assumed("inertia J", inertia, "kg m²", why)


def contradicted(known: KnownRig, rig: Rig) -> DataFinding | None:
    """A warning where a completed rig has another inertia [kg m²] or gravity [m/s²] than given, or no ball's inertia.

    Args:
        known: what the rig file says.
        rig: the same, completed by `rig_of_ratio`.
    """
    ratio = rig.rolling_ratio
    if known.gravity is not None and not math.isclose(known.gravity, rig.gravity, rel_tol=_SAME):
        text = (
            f"the ball accelerates {ratio * rig.gravity / known.gravity:.2g} times as much as a mass that slides "
            f"without friction would, and no ball that rolls does: {rig.gravity:.3g} m/s² stands for gravity. "
            f"{_ANGLE_TO_CHECK}."
        )
    else:
        usual = [share * rig.mass * rig.radius**2 for share in (SOLID_SPHERE, HOLLOW_SPHERE)]
        inertias = usual if known.inertia is None else [known.inertia]
        balls = [rig.with_(inertia=one, rolling_radius=r * rig.radius) for one in inertias for r in _RADIUS_RATIO_RANGE]
        ratios = [one.rolling_ratio for one in balls]
        least, most = min(ratios), max(ratios)
        if known.inertia is None:
            possible = least <= ratio <= most or math.isclose(ratio, most, rel_tol=_SAME)
        else:
            possible = math.isclose(known.inertia, rig.inertia, rel_tol=_SAME)
        if possible:
            return None
        ball = "a ball, solid or hollow," if known.inertia is None else "a ball of the given inertia"
        text = (
            f"the recordings show a rolling ratio K of {ratio:.2g}, but {ball} has {least:.2g} to "
            f"{most:.2g} on any track: {rig.inertia:.2g} kg m² stands for the inertia. {_ANGLE_TO_CHECK}; a ball in "
            "water has a smaller K, too."
        )
    return DataFinding("warning", "rig.toml", text, "rig-contradicted")


def _assumed(name: str, value: float, unit: str, why: str) -> RigEstimate:
    return RigEstimate(name, value, math.inf, unit, f"assumed: {why}")
