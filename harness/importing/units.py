"""Units of the signals: as given, as written in the file, or the only ones that size and physics of the data allow."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from analytic.motion import FloatArray
from harness.errors import InputError
from harness.importing.choices import Ambiguity, Choice
from harness.importing.columns import Found
from harness.importing.physics import Evidence
from harness.importing.words import UNITS, VOLTS, Role, factor_of, is_input, read_name, unit_key
from harness.recording.columns import QUANTITIES

CANDIDATES: Mapping[Role, tuple[str, ...]] = {
    "time": ("s", "ms", "us"),
    "angle": ("rad", "deg"),
    "position": ("m", "cm", "mm"),
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
    unit, source = (signal.unit, signal.unit_from) if signal.unit else (read_name(signal.name).unit, "its name")
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
    example = f"--{role} '{found.name}:0.125 {si}/{per}+0.01'"
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
    evidence: Evidence,
    *,
    shaft: bool,
) -> dict[Role, Scale]:
    """Scales of all signals; those without a unit get the only one that fits.

    Args:
        names: of the signals.
        values: readings in SI units where the scale is known, else as read; each of shape (n,).
        known: scales, `None` where no unit is known.
        evidence: of these values.
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
    combinations = [
        dict(zip(unknown, units, strict=True)) for units in itertools.product(*(by_size[role] for role in unknown))
    ]
    with_physics = evidence.conclusive and not shaft
    fitting = [one for one in combinations if not with_physics or evidence.plausible(_slope_factor(one))]
    if len(fitting) == 1:
        fit = fitting[0]
        fits = "size"
        if with_physics:
            fits += f" and acceleration, {evidence.slope * _slope_factor(fit):+.2g} g α"
        return made | {
            role: Scale(
                unit, UNITS[role][unit], f"not written; of {', '.join(CANDIDATES[role])} it alone fits in {fits}"
            )
            for role, unit in fit.items()
        }
    role = next((one for one in unknown if len({fit[one] for fit in fitting}) != 1), unknown[0])
    left = list(dict.fromkeys(fit[role] for fit in fitting)) or list(CANDIDATES[role])
    name = names[role]
    choices = tuple(
        Choice({role: f"{name}:{unit}"}, f"--{role} '{name}:{unit}'", _range(values[role] * UNITS[role][unit], role))
        for unit in left
    )
    what = "and the data allow several" if fitting else "and the readings fit none of the usual units"
    raise Ambiguity(f"{path}: '{name}' ({role}) has no unit, {what}.", choices)


def _slope_factor(units: Mapping[Role, str]) -> float:
    """By which the slope of acceleration against g α changes if values as read are in these units."""
    factor = {role: UNITS[role][unit] for role, unit in units.items()}
    return factor.get("position", 1.0) / (factor.get("angle", 1.0) * factor.get("time", 1.0) ** 2)


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
