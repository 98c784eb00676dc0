"""The verdict in one sentence, as one engineer would tell another."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from analytic.rig import Rig
from harness.formatting import measured, number
from harness.identify.diagnosis import Diagnosis
from harness.identify.problem.spline_term import Depends
from harness.identify.selection.criterion import Criterion
from harness.identify.validation.held_out import BeforeAfter
from harness.identify.verdict import Estimate, IdentifiedEffect, Verdict

_LISTED = 5  # of many names, before the rest is counted

# What each effect is called with its values in it; {declared} is what the rig said.
_PHRASES: Mapping[str, str] = {
    "viscous_damping": "a viscous damping of {coefficient}",
    "quadratic_drag": "a quadratic drag of {coefficient}",
    "rolling_resistance": "a rolling resistance of {coefficient}",
    "directional_resistance": "a rolling resistance of {coefficient_plus} towards +s, {coefficient_minus} towards −s",
    "stribeck_friction": "a Stribeck friction that falls from {static_coefficient} at rest to {kinetic_coefficient}, "
    "within {stribeck_velocity},",
    "presliding_hysteresis": "a rolling resistance of {coefficient} with an elastic presliding of {stiffness}",
    "level_error": "a level error of {angle}",
    "track_curvature": "a track curvature of {curvature} about s = {centre}",
    "track_bump": "a bump of the track of {height} at s = {centre}, {width} wide,",
    "beam_compliance": "a beam compliance of {compliance}",
    "ball_imbalance": "a ball out of balance by {offset}",
    "rolling_radius": "a rolling radius of {radius} instead of {declared}",
    "contact_slip": "a slip of the ball at a friction coefficient of {friction_coefficient}",
    "eccentric_pivot": "a pivot eccentricity of {eccentricity}",
    "angle_gain": "a gain of {gain} between measured and real beam angle",
    "linkage_backlash": "a linkage backlash of {width}",
    "channel_delay": "a delay of {delay} of the position against the angle",
    "position_gain": "a gain of {gain} between real and recorded position",
    "position_lag": "a lag of {time_constant} of the position sensor",
}
# Units in which these quantities are spoken of, where SI's own are not: (unit, factor to it).
_MILLIMETRES, _DEGREES = ("mm", 1e3), ("°", float(np.degrees(1.0)))
_SPOKEN: Mapping[tuple[str, str], tuple[str, float]] = {
    ("track_bump", "height"): _MILLIMETRES,
    ("track_bump", "width"): _MILLIMETRES,
    ("ball_imbalance", "offset"): ("µm", 1e6),
    ("rolling_radius", "radius"): _MILLIMETRES,
    ("eccentric_pivot", "eccentricity"): _MILLIMETRES,
    ("level_error", "angle"): _DEGREES,
    ("linkage_backlash", "width"): _DEGREES,
    ("channel_delay", "delay"): ("ms", 1e3),
    ("position_lag", "time_constant"): ("ms", 1e3),
    ("stribeck_friction", "stribeck_velocity"): ("mm/s", 1e3),
}
DEPENDENCES: Mapping[Depends, str] = {
    Depends.POSITION: "the ball's position",
    Depends.VELOCITY: "the ball's velocity",
    Depends.ANGLE: "the beam angle",
    Depends.ROLL_ANGLE: "the angle that the ball has rolled",
    Depends.TIME: "time",
}


def words(name: str) -> str:
    """An effect's public name as words: `level error`."""
    return name.replace("_", " ")


def sentence(diagnosis: Diagnosis) -> str:
    """The verdict in words; ± are halves of 95 % intervals."""
    match diagnosis.verdict:
        case Verdict.NONE:
            return (
                "Nothing is missing beyond the noise: no effect of the catalogue predicts these recordings better"
                f"{_stays(diagnosis.heldout)}."
            )
        case Verdict.NOT_IDENTIFIABLE if not _explained(diagnosis):
            left = diagnosis.found.root_density / diagnosis.problem.angle_floor
            return (
                f"These recordings cannot tell: the ball is pushed {number(left, 2)} times as hard as the error of the "
                f"angle can, but no law that was tried predicts it better beyond chance{_stays(diagnosis.heldout)}."
            )
        case Verdict.NOT_IDENTIFIABLE:
            return (
                "These recordings cannot tell: nothing was found, but a typical size of "
                f"{_some(diagnosis.unseen)} would not have been seen either."
            )
        case Verdict.UNLISTED:
            beside = f" beside {_found(diagnosis)}" if diagnosis.effects else ""
            what = f"{_curve(diagnosis)}{beside}{_fall(diagnosis)}"
            return f"Something is missing that the catalogue does not list, {what}."
        case Verdict.EFFECT:
            verb = "was" if len(diagnosis.effects) == 1 else "were"
            text = f"{_found(diagnosis)} {verb} missing{_fall(diagnosis)}."
            return text[0].upper() + text[1:]


def phrase(finding: IdentifiedEffect, rig: Rig) -> str:
    """An effect with its values: `a rolling resistance of 0.0041 ± 0.0002`."""
    said = {key: _value(finding.name, key, each) for key, each in finding.parameters.items()}
    known = _PHRASES.get(finding.name)
    if known is not None:
        return known.format(**said, declared=f"{number(1e3 * rig.rolling_radius, 4)} mm")
    name = words(finding.name)
    return f"{'an' if name[0] in 'aeiou' else 'a'} {name} ({', '.join(f'{words(k)} {v}' for k, v in said.items())})"


def _value(effect: str, key: str, one: Estimate) -> str:
    unit, factor = _SPOKEN.get((effect, key), ("" if one.unit == "1" else one.unit, 1.0))
    text = measured(factor * one.value, 0.5 * factor * (one.high - one.low))
    return text + (unit if unit == "°" else f" {unit}" if unit else "")


def _explained(diagnosis: Diagnosis) -> bool:
    return Criterion(diagnosis.problem.settings).explained(diagnosis.problem, diagnosis.found)


def _found(diagnosis: Diagnosis) -> str:
    return _and([phrase(one, diagnosis.problem.rig) + _or(one) for one in diagnosis.effects])


def _or(finding: IdentifiedEffect) -> str:
    rivals = [words(name) for name in finding.indistinguishable_from]
    return f" (or {' or '.join(rivals)}, which these recordings do not tell from it)" if rivals else ""


def _and(parts: Sequence[str]) -> str:
    """`a`, `a and b`, `a, b and c`."""
    return " and ".join(part for part in (", ".join(parts[:-1]), parts[-1]) if part)


def _some(names: Sequence[str]) -> str:
    listed = [words(name) for name in names[:_LISTED]]
    return _and(listed if len(names) <= _LISTED else [*listed, f"{len(names) - _LISTED} more"])


def _curve(diagnosis: Diagnosis) -> str:
    shape = diagnosis.found.best.shape
    assert shape is not None
    most = float(np.max(np.abs(shape.nodes)))
    depends = DEPENDENCES[shape.depends]
    if shape.friction:
        return f"a dry friction that depends on {depends} (by up to {number(most, 2)} of the normal force)"
    return f"a force that depends on {depends} (up to {number(1e3 * diagnosis.problem.rig.mass * most, 2)} mN)"


def _ends(heldout: BeforeAfter) -> tuple[str, float, float] | None:
    """Over what the held-out error is told, before and after [m]: the rest of a recording, else the longest windows."""
    both = [name for name in heldout.before.rms if name in heldout.after.rms]
    if not both:
        return None
    span = "" if both[-1] == "whole" else f" over {both[-1]}"
    return span, heldout.before.rms[both[-1]], heldout.after.rms[both[-1]]


def _fall(diagnosis: Diagnosis) -> str:
    ends = _ends(diagnosis.heldout)
    if ends is None:
        return "; the recordings are too short to hold any of them out"
    span, before, after = ends
    verb = "falls" if after < before else "does not fall but goes"
    return f"; the held-out error{span} {verb} from {error_size(before)} to {error_size(after)}"


def _stays(heldout: BeforeAfter) -> str:
    ends = _ends(heldout)
    return "" if ends is None else f"; the held-out error{ends[0]} is {error_size(ends[1])}"


def error_size(metres: float) -> str:
    """An error in millimetres, from a metre on in metres."""
    if metres >= 0.9995:
        return f"{number(metres)} m"
    return f"{number(1e3 * metres, 3 if metres >= 0.00995 else 2)} mm"
