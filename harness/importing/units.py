"""Units of the signals: as given, as written in the file, or the only ones that size and physics of the data allow."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from analytic.motion import FloatArray
from harness.errors import InputError
from harness.importing.choices import Ambiguity, Choice, is_reading
from harness.importing.columns import Found
from harness.importing.physics import Evidence, is_usual
from harness.importing.signals import counts_rows, unit_of
from harness.importing.words import ROLES, UNITS, VOLTS, Role, factor_of, is_input, unit_key
from harness.recording.columns import QUANTITIES

CANDIDATES: Mapping[Role, tuple[str, ...]] = {
    "time": ("s", "ms", "us", "ns"),
    "angle": ("rad", "deg"),
    "position": ("m", "cm", "mm", "in"),
}
"""Units that a signal without one may have."""
# Sizes in SI units that a recording of a ball on a beam may have. A crank turns further than a beam.
STEP = (1e-6, 0.5)  # median time between samples [s]
DURATION = (0.5, 4.0 * 3600.0)  # [s]
SWING = (np.radians(0.3), np.radians(90.0))  # range of the beam's angle [rad]
LARGEST_ANGLE = np.radians(45.0)  # of a beam [rad]
TRAVEL = (0.01, 5.0)  # range of the position [m]
LARGEST_POSITION = 5.0  # [m]


@dataclass(frozen=True)
class Scale:
    """How readings become a quantity: factor · (gain · reading + offset).

    Attributes:
        unit: of the quantity, as written.
        factor: to SI.
        gain, offset: in that unit.
        source: where unit and calibration come from, in words.
        per: unit of the reading, if given.
    """

    unit: str
    factor: float
    source: str
    gain: float = 1.0
    offset: float = 0.0
    per: str = ""

    def applied(self, values: FloatArray) -> FloatArray:
        """The quantity in SI units."""
        return self.factor * (self.gain * values + self.offset)

    def __str__(self) -> str:
        if self.gain == 1.0 and self.offset == 0.0:
            return self.unit
        shift = f" {'+' if self.offset > 0 else '-'} {abs(self.offset):g} {self.unit}" if self.offset else ""
        per = f"/{self.per}" if self.per else " per unit read"
        return f"{self.gain:g} {self.unit}{per}{shift}"


def scale_of(path: Path, role: Role, found: Found) -> Scale | None:
    """The scale of a signal as given or as written; `None` if neither says a unit.

    Raises:
        Ambiguity: it is a voltage, or in a unit of something else, so that a calibration is needed.
        InputError: the calibration is for another unit than the file has.
    """
    signal, chosen = found.signal, found.chosen
    unit, source = unit_of(signal)
    if chosen is not None and chosen.unit:
        if chosen.per and unit and unit_key(chosen.per) in VOLTS and unit_key(unit) in VOLTS:
            wanted, had = VOLTS[unit_key(chosen.per)], VOLTS[unit_key(unit)]
            if wanted != had:
                raise InputError(
                    f"{path}: --{role} '{chosen.text}': the calibration is per {chosen.per}, and '{found.name}' is in "
                    f"{unit}. Write it per {unit}."
                )
        return Scale(chosen.unit, chosen.factor, f"--{role}", chosen.gain, chosen.offset, chosen.per)
    factor = factor_of(role, unit) if unit else None
    if factor is not None:
        return Scale(unit, factor, source)
    if not unit and not is_input(signal.name):
        return None
    what = f"is in {unit}" if unit else "is an input of an oscilloscope, in V"
    si = CANDIDATES[role][0]
    per = unit or "V"
    reading = f"/{per}" if is_reading(per) else ""  # `%` or `deg/s` would not be understood there
    example = f"--{role} '{found.name}:0.125 {si}{reading}+0.01'"
    raise Ambiguity(
        f"{path}: '{found.name}' {what}, which is no unit of the {role}.",
        (),
        f"Give its unit ({', '.join(QUANTITIES[role].units)} …), or its calibration with gain and offset: {example} "
        f"stands for 0.125 {si} per {per}, and 0.01 {si} added.",
        role,
    )


def resolve(
    path: Path,
    names: Mapping[Role, str],
    values: Mapping[Role, FloatArray],
    known: Mapping[Role, Scale | None],
    evidence: Callable[[FloatArray], Evidence],
    *,
    shaft: bool,
) -> dict[Role, Scale]:
    """Scales of all signals; those without a unit get the only one that fits.

    Size alone tells the unit of the time. That of an angle or a position has to fit the ball's acceleration, too.

    Args:
        names: of the signals.
        values: readings in SI units where the scale is known, else as read; each of shape (n,).
        known: scales, `None` where no unit is known.
        evidence: of these values with an angle in rad instead.
        shaft: whether the angle is that of a crank.

    Raises:
        Ambiguity: no unit fits, or several do.
    """
    unknown: list[Role] = [role for role, scale in known.items() if scale is None]
    made: dict[Role, Scale] = {role: scale for role, scale in known.items() if scale is not None}
    if not unknown:
        return made
    by_size: dict[Role, list[str]] = {
        role: [unit for unit in CANDIDATES[role] if _fits(role, values[role] * UNITS[role][unit], shaft=shaft)]
        for role in unknown
    }
    odd = next((role for role in ROLES if role in unknown and not by_size[role]), None)
    if odd is not None:
        usual = ", ".join(CANDIDATES[odd])
        raise _open(path, odd, names[odd], values[odd], (), f"and its readings do not have the size of any of {usual}")
    by_angle = {
        unit: evidence(values["angle"] * (UNITS["angle"][unit] if unit else 1.0)) for unit in by_size.get("angle", [""])
    }
    slopes: dict[tuple[str, ...], float] = {}
    for units in itertools.product(*(by_size[role] for role in unknown)):
        in_these = dict(zip(unknown, units, strict=True))
        slopes[units] = by_angle[in_these.get("angle", "")].slope * _slope_factor(in_these)
    with_physics = all(one.conclusive for one in by_angle.values())
    fitting = [units for units, slope in slopes.items() if not with_physics or is_usual(slope)]
    role = next((one for at, one in enumerate(unknown) if len({units[at] for units in fitting}) > 1), None)
    told = [one for one in unknown if one != "time"]
    why = ""
    if not fitting and not told and len(slopes) == 1:  # whatever is wrong with the slope, it is not the time
        fitting, with_physics = list(slopes), False
    elif not fitting:
        role = (told or unknown)[0]
        seen = " or ".join(f"{slope:.2g}" for slope in sorted(set(map(abs, slopes.values())))[:6])
        why = f"and with the usual ones the ball accelerates by {seen} g α, where a ball does by 0.4 to 0.8"
    elif role is not None:
        why = "and the data allow several"
    elif told and not with_physics:
        role, why = told[0], "and the ball does not follow the angle clearly enough to tell it"
    elif "time" in unknown and not with_physics and counts_rows(values["time"]):
        role, why = "time", "and counts the rows, whatever time passed between them"
    elif "angle" in told and _are_whole(values["angle"]):
        role, why = "angle", "and holds whole numbers, which may be the counts of an encoder"
    if role is not None:
        left = list(dict.fromkeys(units[unknown.index(role)] for units in fitting)) or by_size[role]
        raise _open(path, role, names[role], values[role], left, why)
    (fit,) = fitting
    fits = f"size and acceleration, {slopes[fit]:+.2g} g α" if with_physics else "size"
    return made | {
        role: Scale(unit, UNITS[role][unit], f"not written; of {', '.join(CANDIDATES[role])} it alone fits in {fits}")
        for role, unit in zip(unknown, fit, strict=True)
    }


def _open(path: Path, role: Role, name: str, values: FloatArray, units: Sequence[str], why: str) -> Ambiguity:
    """The question for a unit; a calibration is offered where none fits, or counts are possible."""
    choices = tuple(
        Choice({role: f"{name}:{unit}"}, f"--{role} '{name}:{unit}'", _range(values * UNITS[role][unit], role))
        for unit in units or CANDIDATES[role]
    )
    advice = "If it only counts the rows, give the sampling rate: --rate 100 (Hz)." if counts_rows(values) else ""
    if role != "time":
        unit = CANDIDATES[role][-1] if role == "angle" else "cm"
        advice = f"For counts or volts give gain and offset: --{role} '{name}:0.088 {unit}/count+0.5'."
    return Ambiguity(f"{path}: '{name}' ({role}) has no unit, {why}.", choices, advice)


def _are_whole(values: FloatArray) -> bool:
    known = values[np.isfinite(values)]
    return bool(len(known)) and bool(np.all(known == np.round(known)))


def _slope_factor(units: Mapping[Role, str]) -> float:
    """By which the slope of acceleration against g α changes if times and positions as read are in these units."""
    factor = {role: UNITS[role][unit] for role, unit in units.items()}
    return factor.get("position", 1.0) / factor.get("time", 1.0) ** 2


def _fits(role: Role, values: FloatArray, *, shaft: bool) -> bool:
    """Whether readings have a size that a recording may have."""
    known = values[np.isfinite(values)]
    if len(known) < 2:
        return False
    extent, largest = float(np.ptp(known)), float(np.max(np.abs(known)))
    if role == "time":
        step = float(np.median(np.diff(known)))
        return STEP[0] <= step <= STEP[1] and DURATION[0] <= extent <= DURATION[1]
    if role == "angle":
        if shaft:
            return np.radians(1.0) <= extent <= 2.0 * np.pi
        return SWING[0] <= extent <= SWING[1] and largest <= LARGEST_ANGLE
    return TRAVEL[0] <= extent <= TRAVEL[1] and largest <= LARGEST_POSITION


def _range(values: FloatArray, role: Role) -> str:
    known = values[np.isfinite(values)]
    if not len(known):
        return "blank"
    if role == "angle":
        return f"then {np.degrees(known.min()):.3g} to {np.degrees(known.max()):.3g} degrees"
    if role == "time":
        return f"then {np.ptp(known):.3g} s long"
    return f"then {known.min():.3g} to {known.max():.3g} m"
