"""Which column holds which quantity, and in which unit: names, aliases, conversion to SI."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from analytic.naming import did_you_mean
from harness.errors import InputError
from harness.recording.findings import Finding, place, quoted

QuantityName = Literal["time", "angle", "position", "velocity"]

DEGREE = math.pi / 180
NEEDED: tuple[QuantityName, ...] = ("time", "angle")


@dataclass(frozen=True)
class Quantity:
    """A recorded quantity.

    Attributes:
        column: the name its column should have.
        name: that name without the unit.
        others: further names that are understood, without separators.
        units: factor to the SI unit, by unit; the SI unit comes first.
    """

    column: str
    name: str
    others: tuple[str, ...]
    units: Mapping[str, float]

    @property
    def si(self) -> str:
        """The SI unit as written in a column name."""
        return next(iter(self.units))


QUANTITIES: Mapping[QuantityName, Quantity] = {
    "time": Quantity(
        "time_s",
        "time",
        ("t", "timestamp", "elapsed", "elapsedtime"),
        {"s": 1.0, "sec": 1.0, "seconds": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "min": 60.0},
    ),
    # θ is left out on purpose: on many rigs it is the servo's angle, not the beam's.
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
    """Where a quantity stands: column index, name as written, factor to the SI unit."""

    index: int
    header: str
    factor: float


@dataclass(frozen=True)
class _Reading:
    """A column name understood as a quantity; `rank` 0 is the name of the contract, 1 another unit, 2 another name."""

    rank: int
    unit: str | None
    column: Column


def find_columns(
    path: Path, header: Sequence[str], header_row: int
) -> tuple[dict[QuantityName, Column], list[Finding]]:
    """Finds time and angle, and position and velocity if there are any, in a header.

    Letter case, blanks and brackets do not matter: `Beam Angle [deg]` is `beam_angle_deg`.

    Returns:
        The columns by quantity, and notes on what was assumed or not used.

    Raises:
        InputError: a needed column is missing or ambiguous, has an unknown unit, or seems misspelt.
    """
    where = place(path, header_row)
    repeated = sorted({name for name in header if name and header.count(name) > 1})
    if repeated:
        raise InputError(f"{where}: column {quoted(repeated)} occurs more than once. Rename or delete one of them.")
    found: dict[QuantityName, Column] = {}
    findings: list[Finding] = []
    note = place(path.name, header_row)
    for name, quantity in QUANTITIES.items():
        readings = [reading for index in range(len(header)) if (reading := _read(quantity, header[index], index))]
        if not readings:
            continue
        best = min(reading.rank for reading in readings)
        chosen = [reading for reading in readings if reading.rank == best]
        if len(chosen) > 1:
            names = quoted([reading.column.header for reading in chosen])
            raise InputError(
                f"{where}: {names} could each be the {name}. Name the one that is meant {quantity.column} "
                "and rename or delete the rest."
            )
        found[name] = chosen[0].column
        if chosen[0].unit is None:
            findings.append(
                Finding(
                    "note",
                    place(path.name, header_row, chosen[0].column.header),
                    f"has no unit and is taken for {quantity.column}; write the unit into the name.",
                )
            )
    unused = [name for index, name in enumerate(header) if index not in {column.index for column in found.values()}]
    _refuse_missing(where, header, unused, found)
    if unused:
        findings.append(Finding("note", note, f"columns not used: {quoted(unused)}."))
    return found, findings


def _read(quantity: Quantity, header: str, index: int) -> _Reading | None:
    words = _words(header)
    names = (quantity.name.replace("_", ""), *quantity.others)
    for taken in (2, 1, 0):
        name, unit = "".join(words[: len(words) - taken]), "_".join(words[len(words) - taken :])
        if name not in names or (taken and unit not in quantity.units):
            continue
        column = Column(index, header, quantity.units[unit] if taken else 1.0)
        if name != names[0]:
            return _Reading(2, unit or None, column)
        return _Reading(0 if unit == quantity.si else 1, unit or None, column)
    return None


def _words(header: str) -> list[str]:
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
            f"{where}: no column {quoted(missing)}; found {quoted(header)}. Expected are time_s, beam_angle_rad and "
            "ball_position_m (ball_velocity_m_s is optional), or the same names with another unit such as "
            "time_ms, beam_angle_deg, ball_position_mm. Rename the columns."
        )


def _refuse_near_miss(where: str, candidate: str, name: QuantityName) -> None:
    """A column that was meant to be `name` must not be left out in silence, as position and velocity are optional."""
    quantity = QUANTITIES[name]
    names = (quantity.name.replace("_", ""), *(quantity.others if name != "velocity" else ()))
    words = _words(candidate)
    for cut in range(1, len(words)):
        if "".join(words[:cut]) in names:
            raise InputError(
                f"{where}: column '{candidate}': the unit '{'_'.join(words[cut:])}' is not known for the {name}. "
                f"Known are {', '.join(quantity.units)}."
            )
    known = [f"{quantity.name}_{unit}" for unit in quantity.units]
    hint = did_you_mean("_".join(words), known, likeness=0.8)
    if hint:
        raise InputError(f"{where}: column '{candidate}' is not known.{hint}")
