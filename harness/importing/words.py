"""What a column's name says: which quantity, in which unit. English, German, French, Spanish and Italian words.

Names and units of a recording (`harness.recording.columns`) are known here, too; what an instrument or a student writes
goes beyond them.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from harness.recording.columns import DEGREE, QUANTITIES, words_of

Role = Literal["time", "angle", "position"]
Kind = Literal["time", "angle", "position", "shaft", "velocity", "setpoint"]
ROLES: tuple[Role, ...] = ("time", "angle", "position")

UNITS: Mapping[Role, Mapping[str, float]] = {
    "time": {
        **QUANTITIES["time"].units,
        **dict.fromkeys(("second", "sek", "sekunde", "sekunden", "seconde", "secondes", "segundos"), 1.0),
        **dict.fromkeys(("msec", "millis", "millisecond", "milliseconds", "millisekunden"), 1e-3),
        **dict.fromkeys(("micros", "microsecond", "microseconds", "mikrosekunden"), 1e-6),
        **dict.fromkeys(("nanosecond", "nanoseconds"), 1e-9),
        "minutes": 60.0,
        "hours": 3600.0,
        "days": 86400.0,
        "weeks": 604800.0,
    },
    "angle": {
        **QUANTITIES["angle"].units,
        **dict.fromkeys(("grad", "degre", "degres", "degré", "degrés", "grados", "gradi", "degs"), DEGREE),
        "mdeg": 1e-3 * DEGREE,
        "gon": math.pi / 200.0,
        **dict.fromkeys(("rev", "turn", "turns"), 2.0 * math.pi),
    },
    "position": {
        **QUANTITIES["position"].units,
        **dict.fromkeys(("meter", "meters", "metre", "metres", "mètre", "mètres"), 1.0),
        **dict.fromkeys(("millimeter", "millimeters", "millimetre", "millimetres"), 1e-3),
        **dict.fromkeys(("centimeter", "centimeters", "centimetre", "centimetres"), 1e-2),
        **dict.fromkeys(("in", "inch", "inches", "zoll", "pouce", "pouces"), 0.0254),
        "dm": 0.1,
    },
}
"""Conversion factor to SI by unit, as `unit_key` writes it."""
VOLTS = {"v": 1.0, "volt": 1.0, "volts": 1.0, "mv": 1e-3, "millivolt": 1e-3, "millivolts": 1e-3}
"""Units of an instrument's input, which say nothing about what was measured."""


def _set(words: str) -> frozenset[str]:
    return frozenset(words.split())


_SAID_BY: Mapping[Kind, frozenset[str]] = {
    "time": _set(
        "time zeit temps tiempo tempo timestamp timestamps stamp elapsed clock uhrzeit zeitstempel horodatage tout "
        "second seconds sekunde sekunden seconde secondes"
    ),
    "angle": _set(
        "angle alpha tilt winkel neigung neigungswinkel balkenwinkel wippe wippenwinkel inclinaison inclination "
        "angolo angulo ángulo beamangle beamtilt tiltangle pitch"
    ),
    "position": _set(
        "position pos distance dist abstand weg entfernung displacement kugelposition kugelpos ballposition ballpos "
        "posicion posición distancia distanza posizione balldistance"
    ),
    # Many rigs turn the beam by a crank: these may be the shaft's angle, and not the beam's.
    "shaft": _set(
        "theta servo servoangle motor motorangle shaft crank encoder enc kurbel motorwinkel servowinkel moteur"
    ),
    "velocity": _set(
        "velocity vel speed geschwindigkeit vitesse rate omega acceleration acc accel beschleunigung sdot xdot "
        "thetadot alphadot"
    ),
    "setpoint": _set(
        "setpoint ref reference target desired soll sollwert sollwinkel sollposition consigne command commanded cmd "
        "error err fehler erreur input voltage current spannung strom"
    ),
}
_BODIES: Mapping[str, Kind] = {
    "ball": "position",
    "kugel": "position",
    "bille": "position",
    "beam": "angle",
    "balken": "angle",
}
"""What is meant by the ball or the beam if a name says nothing else of it."""
_LETTERS: Mapping[str, Kind] = {
    "t": "time",
    "x": "position",
    "s": "position",
    "v": "velocity",
    "th": "shaft",
    "θ": "shaft",
    "ϑ": "shaft",
}
"""Symbols, which mean these quantities alone or beside the ball or the beam: `x`, `ball x`, but not `mag_x`."""
_WHICH = _set("run series trial data set latest measurement messung lauf versuch")
"""Words that say which recording it is, as Capstone and Logger Pro write them: `x Run #1`."""
_ORDER: tuple[Kind, ...] = ("setpoint", "velocity", "shaft", "angle", "position", "time")


@dataclass(frozen=True)
class Reading:
    """What a name says.

    Attributes:
        kind: the quantity; `None` if it says none.
        unit: as written; empty if it has none.
    """

    kind: Kind | None
    unit: str


def unit_key(text: str) -> str:
    """A unit as `UNITS` has it: lower case, without brackets, `°` as `deg`, `µs` as `us`."""
    return "_".join(words_of(text)) or text.strip().casefold()


def factor_of(role: Role, unit: str) -> float | None:
    """Conversion factor to SI, `None` if it is no unit of the quantity."""
    return UNITS[role].get(unit_key(unit))


def is_unit(text: str) -> bool:
    """Whether a text is a unit of anything that is recorded here, or of a voltage."""
    key = unit_key(text)
    if not key:
        return False
    return any(key in units for units in UNITS.values()) or key in VOLTS or key in _OTHER_UNITS


_OTHER_UNITS = _set("a ma hz m_s mm_s cm_s rad_s deg_s m_s2 n nm w pct percent counts count bit lsb")


def is_input(name: str) -> bool:
    """Whether a name is that of an oscilloscope's input, such as `CH1` or `Channel A`."""
    return bool(re.fullmatch(r"(CH|C|Channel )\s?[1-8A-D]", name, re.IGNORECASE))


def read_name(name: str) -> Reading:
    """Quantity and unit of a column's name, such as `Angle (deg)`, `Weg in cm`, `theta_deg`, `ball.x [mm]`."""
    bare, unit = _split_unit(name)
    words = [word for word in words_of(re.sub(r"(?<=[a-z])(?=[A-Z])", " ", bare)) if not word.isdigit()]
    return Reading(_kind_of(words), unit)


def _kind_of(words: list[str]) -> Kind | None:
    whole = "".join(words)
    for role in ROLES:  # names that a recording may have are known before anything else is made of their words
        quantity = QUANTITIES[role]
        if whole in (quantity.name.replace("_", ""), *quantity.others):
            return role
    for kind in _ORDER:
        if _SAID_BY[kind] & {*words, whole}:
            return kind
    said = [word for word in words if word not in _WHICH]
    bodies = [word for word in said if word in _BODIES]
    if len(said) == 1 or bodies:
        known = {**_BODIES, **_LETTERS}
        return next((known[word] for word in reversed(said) if word in known), None)
    return None


_BRACKETED = re.compile(r"\s*[\[(<{]\s*([^\])>}]*?)\s*[\])>}]")


def _split_unit(name: str) -> tuple[str, str]:
    """The name without its unit, and the unit."""
    inside = [one for one in _BRACKETED.finditer(name) if one.start() > 0 and is_unit(one[1])]
    if inside:  # wherever it stands: `Position (in) Run #1`, `Angle (deg) (filtered)`
        return f"{name[: inside[-1].start()]} {name[inside[-1].end() :]}".strip(), inside[-1][1]
    bracketed = re.fullmatch(r"(.*\S)\s*[\[(<{]\s*([^\])>}]*?)\s*[\])>}]\s*", name)
    if bracketed and bracketed[2].isdigit():  # an index, as in `position[0]`, or one name of several: `theta_deg (2)`
        return _split_unit(bracketed[1])
    if bracketed:
        return bracketed[1], bracketed[2]
    worded = re.fullmatch(r"(.*\S)\s*(?:\s/|/\s|\sin\s|,\s)\s*(\S+)\s*", name)
    if worded and is_unit(worded[2]):
        return worded[1], worded[2]
    suffixed = re.fullmatch(r"(.*[^\W_])[_\s.]+([^\W_]+|°)", name)
    if suffixed and is_unit(suffixed[2]) and _kind_of(words_of(suffixed[1])) is not None:
        return suffixed[1], suffixed[2]
    return name, ""
