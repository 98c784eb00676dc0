"""What is written of an imported recording: its CSV, a `rig.toml` that says what is known and from where."""

from __future__ import annotations

import io
import json
from collections.abc import Mapping, Sequence
from typing import Literal

import numpy as np
import tomlkit

from harness.errors import InputError
from harness.importing.understand import Understood
from harness.recording.rig_file import KEYS

Role = Literal["identify", "predict"]
"""What a recording of a case is for: its list in `[recordings]` of `rig.toml`."""

HEADER = "time_s,beam_angle_rad,ball_position_m\n"
MEANINGS: Mapping[str, Mapping[str, str]] = {
    "ball": {
        "mass_kg": "m, mass of the ball [kg]",
        "inertia_kg_m2": "J, moment of inertia [kg m²]: 2/5 m R² if solid, 2/3 m R² if a thin shell",
        "radius_m": "R, radius of the ball [m]",
    },
    "beam": {
        "rolling_radius_m": "r, height of the ball's centre above the line on which it rolls [m]: R on a flat beam",
        "eccentricity_m": "h, height of that line above the pivot [m]",
        "length_m": "length of the beam [m]",
        "level_angle_rad": "α₀, true angle where the sensor reads zero [rad]",
    },
    "environment": {"gravity_m_s2": "g [m/s²]"},
    "sensors": {
        "angle_resolution_rad": "step of the angle [rad]",
        "angle_noise_rad": "standard deviation of the angle's noise [rad]",
        "position_noise_m": "standard deviation of the position's noise [m]",
        "position_resolution_m": "step of the position [m]",
    },
}
"""What each key of `rig.toml` means, by table."""
GRAVITY = 9.81  # where the user gives none [m/s²]


def recording_text(understood: Understood) -> str:
    """The CSV: microseconds, nine significant digits, blank where a position is not known."""
    out = io.StringIO()
    out.write(HEADER)
    for time, angle, position in zip(understood.time, understood.angle, understood.position, strict=True):
        cells = ["" if not np.isfinite(one) else f"{one:.9g}" for one in (angle, position)]
        out.write(f"{time:.6f},{cells[0]},{cells[1]}\n")
    return out.getvalue()


def rig_text(
    recordings: Mapping[str, Understood],
    rig: Mapping[str, Mapping[str, float]],
    *,
    origin: str | None,
    command: str,
) -> str:
    """A `rig.toml` with what is known, what was estimated from the data, and a comment for each unknown quantity.

    Args:
        recordings: by the name of their file.
        rig: what the user gave, by table and key.
        origin: what the user says of the data; a text that begins with `simulated` marks them as simulated.
        command: by which they were imported.
    """
    files = [one for each in recordings.values() for one in each.sources]
    names = list(dict.fromkeys(one.path.name for one in files))
    imported = f"imported from {', '.join(names)}"
    lines = [
        f"origin = {_quoted(f'{origin}; {imported}' if origin else imported)}",
        "",
        "# Written by `harness import`; change it as you like. A line with `#` before a key is a quantity that is not",
        "# known yet: take the # away and write its value. What stays unknown is estimated, or results are per unit.",
        f"# Command: {_one_line(command)}",
    ]
    for name, each in recordings.items():
        lines += ["#", *[f"# {line}" for line in described(name, each)]]
    for table in MEANINGS:
        lines += ["", f"[{table}]"]
        for key in KEYS[table]:
            lines.append(_entry(table, key, rig.get(table, {}).get(key), recordings))
    lines += ["", "[recordings]", f"identify = {json.dumps(list(recordings))}", ""]
    return "\n".join(lines)


def described(name: str, understood: Understood) -> list[str]:
    """How a recording was understood, in lines of text."""
    lines = [f"{name}:"]
    lines += [f"  {_one_line(one.path.name)}, {one.kind}, sha256 {one.sha256}" for one in understood.sources]
    for line in understood.lines:
        column = f"'{_one_line(line.column)}'" if line.column else "no column"
        lines.append(f"  {line.role}: {column} ({line.evidence}); unit {line.unit} ({line.unit_from})")
    if understood.linkage is not None:
        lines.append(f"  linkage: {understood.linkage}, lengths in m")
    if understood.flipped:
        lines.append(f"  negated: {' and '.join(understood.flipped)}")
    lines += [f"  rate: {understood.rate}", f"  sign: {understood.sign}"]
    return [*map(_one_line, lines), *(_one_line(f"  note: {note}") for note in understood.notes)]


def with_recordings(
    path: str, text: str, names: Sequence[str], added: Sequence[str], *, role: Role, before: Sequence[str]
) -> str:
    """A `rig.toml` with recordings added to its list, all else as it was, comments included.

    Args:
        path: of the file, for messages.
        text: its content.
        names: files to be listed.
        added: lines of comment about them.
        role: the list of theirs.
        before: files that are identified from so far, which a list names where there was none.

    Raises:
        InputError: it is not TOML, or its list is none.
    """
    try:
        document = tomlkit.parse(text)
        recordings = document.get("recordings")
        if recordings is None:
            if role == "identify":
                return text  # then all recordings of the folder count
            recordings = document.setdefault("recordings", tomlkit.table())
            recordings["identify"] = list(before)
        listed = recordings.setdefault(role, tomlkit.array())
        for name in names:
            listed.append(name)
        for line in added:
            recordings.add(tomlkit.comment(line))
        return tomlkit.dumps(document)
    except (tomlkit.exceptions.TOMLKitError, AttributeError, TypeError) as error:
        raise InputError(f"{path}: no recording can be added ({error}). Correct the file first.") from None


def _entry(table: str, key: str, given: float | None, recordings: Mapping[str, Understood]) -> str:
    meaning = MEANINGS[table][key]
    if given is not None:
        return f"{key} = {given!r}  # {meaning}; given"
    if key == "gravity_m_s2":
        return f"{key} = {GRAVITY}  # {meaning}; assumed, correct it for your place (9.76 to 9.84)"
    found = _coarsest(key, recordings)
    if found is not None:
        return f"{key} = {found:.6g}  # {meaning}; estimated from the data: all readings are multiples of it"
    if key == "length_m" and any(one.linkage for one in recordings.values()):
        lever = next(one.linkage.length for one in recordings.values() if one.linkage)
        return f"# {key} = {lever:g}  # {meaning}; this is the lever of the linkage, if the beam ends there"
    return f"# {key} =  # {meaning}"


def _coarsest(key: str, recordings: Mapping[str, Understood]) -> float | None:
    """Largest step over the recordings, which share one sensor."""
    field = {"angle_resolution_rad": "angle_resolution", "position_resolution_m": "position_resolution"}.get(key)
    steps = [getattr(one, field) for one in recordings.values()] if field else []
    return max((step for step in steps if step is not None), default=None)


def _quoted(text: str) -> str:
    return json.dumps(_one_line(text), ensure_ascii=False)


def _one_line(text: str) -> str:
    return "".join(one if one.isprintable() else " " for one in text)
