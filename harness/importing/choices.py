"""What the user chose: columns with units or calibrations, the linkage, signs; each in one short text."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from analytic.motion import FloatArray
from harness.errors import InputError
from harness.importing.words import UNITS, Role, factor_of, unit_key
from harness.recording.columns import DEGREE

NONE = "none"
"""For `position`: the recording has none."""
_N = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
_CALIBRATION = re.compile(
    rf"\s*(?:(?P<gain>{_N})\s*)?(?P<unit>[^\W\d_]+|°)(?:\s*/\s*(?P<per>[^\W\d_]+))?\s*"
    rf"(?:(?P<sign>[+-])\s*(?P<offset>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(?P<again>[^\W\d_]+|°)?)?\s*"
)


def is_reading(unit: str) -> bool:
    """Whether a unit may stand behind the stroke of a calibration."""
    return bool(re.fullmatch(r"[^\W\d_]+", unit))


@dataclass(frozen=True)
class Chosen:
    """A column, and how its readings become the quantity: factor · (gain · reading + offset).

    Attributes:
        column: name or number of a column.
        unit: of the quantity, as written; empty where the file is to say it.
        factor: conversion of that unit to SI.
        gain: in that unit per reading.
        offset: in that unit.
        per: unit of the reading as written, such as V; empty if not given.
        text: as the user wrote it.
    """

    column: str
    unit: str = ""
    factor: float = 1.0
    gain: float = 1.0
    offset: float = 0.0
    per: str = ""
    text: str = ""


@dataclass(frozen=True)
class Linkage:
    """A crank that turns the beam: α = asin(r sin(θ + θ₀) / L).

    Attributes:
        radius: r, of the crank [m].
        length: L, distance of the beam's joint from its pivot [m].
        offset: θ₀, added to the recorded angle of the crank [rad].
    """

    radius: float
    length: float
    offset: float = 0.0

    def beam(self, crank: FloatArray) -> FloatArray:
        """The beam's angle α for angles θ of the crank, shape (n,) [rad]."""
        return np.arcsin(self.radius / self.length * np.sin(crank + self.offset))

    def __str__(self) -> str:
        """The formula with its numbers."""
        shifted = f"(θ {'+' if self.offset > 0 else '−'} {abs(self.offset):g} rad)" if self.offset else "θ"
        return f"α = asin({self.radius:g} sin {shifted} / {self.length:g})"


@dataclass(frozen=True)
class Options:
    """What the user has chosen.

    Attributes:
        time, angle, position: columns, as `COLUMN`, `COLUMN:UNIT` or `COLUMN:GAIN UNIT/READING+OFFSET`.
        rate: sampling rate [Hz], where no column holds the time.
        flip_angle, flip_position: whether to negate it.
        keep_signs: whether signs stay although the data contradict them.
        linkage: as `r=0.025,L=0.4,offset=5deg`.
        rig: quantities of `rig.toml` by table and key, such as `{"ball": {"mass_kg": 0.064}}`.
        where: rows to take, as `COLUMN=VALUE`: those that have one of the values of each column named.
        gravity: g [m/s²] for the checks.
    """

    time: str | None = None
    angle: str | None = None
    position: str | None = None
    rate: float | None = None
    flip_angle: bool = False
    flip_position: bool = False
    keep_signs: bool = False
    linkage: str | None = None
    rig: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    where: tuple[str, ...] = ()

    @property
    def gravity(self) -> float | None:
        """g, where it is given [m/s²]."""
        return self.rig.get("environment", {}).get("gravity_m_s2")


@dataclass(frozen=True)
class Choice:
    """An answer to an ambiguity.

    Attributes:
        options: what to change in `Options`.
        typed: the same on the command line.
        text: what it means.
    """

    options: Mapping[str, Any]
    typed: str
    text: str


class Ambiguity(InputError):
    """What cannot be told from the file, with the answers that are possible.

    Attributes:
        question: what is to be decided.
        choices: possible answers; none where the user has to write one.
        advice: what else can be given.
        role: quantity whose option is to be written where there are no choices; empty if it is not that simple.
        also: further questions, which the message goes on with.
    """

    def __init__(
        self, question: str, choices: tuple[Choice, ...], advice: str = "", role: str = "", also: str = ""
    ) -> None:
        self.role = role
        self.also = also
        self.question = question
        self.choices = choices
        self.advice = advice
        listed = ", or ".join(f"{one.typed} ({one.text})" for one in choices)
        super().__init__(" ".join(filter(None, (question, f"Give {listed}." if choices else "", advice, also))))

    def __reduce__(self) -> tuple[type, tuple[object, ...]]:
        """Its own arguments."""
        return type(self), (self.question, self.choices, self.advice, self.role, self.also)


def parse_chosen(role: Role, text: str, names: tuple[str, ...]) -> Chosen:
    """Reads `COLUMN`, `COLUMN:UNIT` or `COLUMN:GAIN UNIT/READING+OFFSET`; a column's name may hold colons itself.

    Raises:
        InputError: it is none of these; the message names the known units.
    """
    option = f"--{role} '{text}'"
    if text in names or ":" not in text:
        return Chosen(text.strip(), text=text)
    column, _, tail = text.rpartition(":")
    found = _CALIBRATION.fullmatch(tail)
    if not found or not column.strip():
        raise InputError(
            f"{option}: '{tail.strip()}' is neither a unit nor a calibration. Write COLUMN:UNIT, such as "
            f"'{column or 'CH1'}:{_example(role)}', or COLUMN:GAIN UNIT/READING+OFFSET, such as "
            f"'{column or 'CH1'}:0.125 {_example(role)}/V+0.01'."
        )
    unit = found["unit"]
    factor = factor_of(role, unit)
    if factor is None:
        known = ", ".join(dict.fromkeys(UNITS[role]))
        raise InputError(f"{option}: '{unit}' is no unit of the {role}. Known units: {known}.")
    if found["again"] and unit_key(found["again"]) != unit_key(unit):
        raise InputError(f"{option}: the offset is in {found['again']} and the gain in {unit}. Write both in one unit.")
    gain = float(found["gain"] or 1.0)
    if gain == 0.0 or not math.isfinite(gain):
        raise InputError(f"{option}: the gain is {gain:g}. Write one that is not zero.")
    offset = float(found["offset"] or 0.0) * (-1.0 if found["sign"] == "-" else 1.0)
    return Chosen(column.strip(), unit, factor, gain, offset, found["per"] or "", text)


def _example(role: Role) -> str:
    return {"time": "ms", "angle": "deg", "position": "cm"}[role]


def parse_linkage(text: str) -> Linkage:
    """Reads `r=0.025,L=0.4` with lengths in metres, and optionally `offset=0.1` (rad) or `offset=5deg`.

    Raises:
        InputError: something is missing, unknown, or impossible.
    """
    values: dict[str, float] = {}
    for part in text.split(","):
        key, _, value = part.partition("=")
        found = re.fullmatch(rf"\s*({_N})\s*(m|mm|cm|rad|deg|°)?\s*", value)
        name = key.strip()
        allowed = {"r": ("m", "mm", "cm"), "L": ("m", "mm", "cm"), "offset": ("rad", "deg", "°")}
        if name not in allowed or not found or (found[2] and found[2] not in allowed[name]) or name in values:
            raise InputError(
                f"--linkage '{text}': '{part.strip()}' cannot be read. Write r=0.025,L=0.4 (crank radius and lever of "
                "the beam, in m), and if need be offset=5deg, which is added to the crank's angle."
            )
        factor = {"mm": 1e-3, "cm": 1e-2, "deg": DEGREE, "°": DEGREE}.get(found[2] or "", 1.0)
        values[name] = float(found[1]) * factor
    if not {"r", "L"} <= set(values) or not 0.0 < values["r"] < values["L"]:
        raise InputError(
            f"--linkage '{text}': needs r and L with 0 < r < L, as in r=0.025,L=0.4; a longer crank would turn the "
            "beam over."
        )
    return Linkage(values["r"], values["L"], values.get("offset", 0.0))
