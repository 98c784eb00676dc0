"""Maps CSV columns to quantities: column names, aliases, units and conversion to SI."""

import math
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from analytic.naming import did_you_mean
from harness.errors import InputError
from harness.recording.findings import DataFinding, place, quoted

QuantityName = Literal["time", "angle", "position", "velocity"]

DEGREE = math.pi / 180
MAX_NAMES = 20  # of columns in one message
NEEDED: tuple[QuantityName, ...] = ("time", "angle")


@dataclass(frozen=True)
class Quantity:
    """A recorded quantity.

    Attributes:
        column: standard column name.
        name: the standard name without its unit.
        others: accepted aliases, without separators.
        units: conversion factor to SI by unit; the SI unit comes first.
    """

    column: str
    name: str
    others: tuple[str, ...]
    units: Mapping[str, float]

    @property
    def si(self) -> str:
        """The SI unit as spelled in a column name."""
        return next(iter(self.units))

    def named(self, factor: float) -> str:
        """The column name with the unit of this conversion factor."""
        return f"{self.name}_{next(unit for unit, each in self.units.items() if each == factor)}"


QUANTITIES: Mapping[QuantityName, Quantity] = {
    "time": Quantity(
        "time_s",
        "time",
        ("t", "timestamp", "elapsed", "elapsedtime"),
        {"s": 1.0, "sec": 1.0, "seconds": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "min": 60.0},
    ),
    # θ is not an alias: on many rigs it is the servo angle, not the beam angle.
    "angle": Quantity(
        "beam_angle_rad",
        "beam_angle",
        ("angle", "alpha", "beamtilt", "tilt"),
        {"rad": 1.0, "radian": 1.0, "radians": 1.0, "mrad": 1e-3, "deg": DEGREE, "degree": DEGREE, "degrees": DEGREE},
    ),
    "position": Quantity(
        "ball_position_m",
        "ball_position",
        ("position", "pos", "ballpos", "s", "x", "displacement"),
        {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "um": 1e-6},
    ),
    "velocity": Quantity(
        "ball_velocity_m_s",
        "ball_velocity",
        ("velocity", "vel", "v", "sdot", "xdot"),
        {"m_s": 1.0, "mm_s": 1e-3, "cm_s": 1e-2, "mps": 1.0},
    ),
}


@dataclass(frozen=True)
class Column:
    """A column assigned to a quantity.

    Attributes:
        index: of the column.
        header: as written.
        factor: conversion to SI.
        unit: as written; empty if there is none.
        rank: 0 for the standard name, 1 for another unit, 2 for an alias.
    """

    index: int
    header: str
    factor: float
    unit: str
    rank: int


def find_columns(
    path: Path, header: Sequence[str], header_row: int
) -> tuple[dict[QuantityName, Column], list[DataFinding]]:
    """Finds the columns of time and angle, and of position and velocity if present.

    Letter case, blanks and brackets are ignored: `Beam Angle [deg]` is `beam_angle_deg`.

    Returns:
        The columns by quantity, and notes on assumed units and unused columns.

    Raises:
        InputError: a required column is missing or ambiguous, has an unknown unit, or is probably misspelt.
    """
    where = place(path, header_row)
    repeated = sorted(name for name, count in Counter(header).items() if name and count > 1)
    if repeated:
        raise InputError(f"{where}: column {quoted(repeated)} occurs more than once. Rename or delete one of them.")
    found: dict[QuantityName, Column] = {}
    findings: list[DataFinding] = []
    for name, quantity in QUANTITIES.items():
        matches = [one for index in range(len(header)) if (one := _match(quantity, header[index], index))]
        if not matches:
            continue
        chosen, *others = [one for one in matches if one.rank == min(match.rank for match in matches)]
        if others:
            raise InputError(
                f"{where}: {quoted([one.header for one in (chosen, *others)])} all match the {name}. Name the right "
                f"one {quantity.column} and rename or delete the others."
            )
        found[name] = chosen
        if not chosen.unit:
            text = f"has no unit and is read as {quantity.column}; add the unit to the name."
            # The time's unit shows in the length of a recording; that of an angle does not.
            severity: Literal["warning", "note"] = "warning" if name == "angle" else "note"
            findings.append(DataFinding(severity, place(path.name, header_row, chosen.header), text, "no-unit"))
    unused = [name for index, name in enumerate(header) if index not in {column.index for column in found.values()}]
    _refuse_missing(where, header, unused, found)
    if unused:
        text = f"columns not used: {quoted(unused[:MAX_NAMES])}{' and others' if len(unused) > MAX_NAMES else ''}."
        if "position" not in found:
            column = QUANTITIES["position"].column
            text += f" If one of them holds the ball's position, name it {column}, with the unit at the end."
        findings.append(DataFinding("note", place(path.name, header_row), text, "unused-columns"))
    return found, findings


def _match(quantity: Quantity, header: str, index: int) -> Column | None:
    words = words_of(header)
    names = (quantity.name.replace("_", ""), *quantity.others)
    for taken in (2, 1, 0):
        name, unit = "".join(words[: len(words) - taken]), "_".join(words[len(words) - taken :])
        if name not in names or (taken and unit not in quantity.units):
            continue
        rank = 2 if name != names[0] else 0 if unit == quantity.si else 1
        return Column(index, header, quantity.units[unit] if taken else 1.0, unit, rank)
    return None


def words_of(header: str) -> list[str]:
    """Words of a column's name in lower case, without brackets; `°` is `deg`, `µ` is `u`."""
    text = header.casefold()
    for sign, word in (("°", " deg "), ("µ", "u"), ("μ", "u"), ("α", "alpha")):
        text = text.replace(sign, word)
    return re.findall(r"[^\W_]+", text)


def _refuse_missing(
    where: str, header: Sequence[str], unused: Sequence[str], found: Mapping[QuantityName, Column]
) -> None:
    for name in QUANTITIES:
        if name not in found:
            for candidate in unused:
                _refuse_near_miss(where, candidate, name)
    missing = [QUANTITIES[name].column for name in NEEDED if name not in found]
    if missing:
        raise InputError(
            f"{where}: no column {quoted(missing)}; found {quoted(header)}. Expected columns are time_s, "
            "beam_angle_rad and ball_position_m (ball_velocity_m_s is optional), or the same names with another unit, "
            "such as time_ms, beam_angle_deg, ball_position_mm. Rename the columns."
        )


def _refuse_near_miss(where: str, candidate: str, name: QuantityName) -> None:
    """Refuses a header that resembles `name`: an optional column must not be dropped because of a typing error."""
    quantity = QUANTITIES[name]
    names = (quantity.name.replace("_", ""), *(quantity.others if name != "velocity" else ()))
    words = words_of(candidate)
    for cut in range(1, len(words)):
        if "".join(words[:cut]) in names:
            raise InputError(
                f"{where}: column '{candidate}': unknown unit '{'_'.join(words[cut:])}' for the {name}. "
                f"Known units: {', '.join(quantity.units)}."
            )
    known = [f"{quantity.name}_{unit}" for unit in quantity.units]
    hint = did_you_mean("_".join(words), known, likeness=0.8)
    if hint:
        raise InputError(f"{where}: unknown column '{candidate}'.{hint}")
