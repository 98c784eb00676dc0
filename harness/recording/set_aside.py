"""Readings that are left out of every fit, and what is said of them.

A stretch in which the position's sensor was stuck, gave zeros, was clipped, or was offset for a while is left out.
Where an offset stays, rows are lost, the angle's sensor was stuck, the ball touches an end stop, is held or pushed, no
model can be run across the place: the parts between are used as recordings of their own. Behind an offset that stays
the position has another origin, which acts on the ball as a level would, so that the part before it may be shorter.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from analytic.motion import FloatArray
from harness.recording.end_stops import NO_STOPS, Contact, Stops, end_stops
from harness.recording.findings import MAX_PLACES, rows_text
from harness.recording.frozen import Fault, Run, frozen
from harness.recording.jumps import Jump, jumps
from harness.recording.parts import Break, parts_between, suffixes
from harness.recording.pushes import LATEST, Push, pushes
from harness.recording.stuck_angle import stuck_angles

AND_BACK = 0.3  # of a jump, by which the one back may differ from it

_FROZEN = {
    Fault.STUCK: "but the ball moved meanwhile: the sensor was stuck",
    Fault.ZEROS: "but the ball was elsewhere: the sensor gave no reading",
    Fault.CLIPPED: "at the end of its range, but the ball moved meanwhile: the sensor was clipped",
}


class Faulty(NamedTuple):
    """A fault of a sensor: the code of its finding, the channel it is in, and what is said of it."""

    code: str
    channel: Literal["position", "angle"]
    text: str


@dataclass(frozen=True)
class SetAside:
    """What is left out, and why.

    Attributes:
        mask: positions that are left out, shape (n,).
        parts: what of the recording is used, the part that says most first, the others in order.
        faults: what is said of both.
        stops: the end stops that this recording tells.
    """

    mask: NDArray[np.bool_]
    parts: tuple[slice, ...]
    faults: tuple[Faulty, ...]
    stops: Stops


@dataclass(frozen=True)
class _Record:
    """The channels of a recording, shape (n,) each, and what else the detectors ask for, as `set_aside` takes it."""

    time: FloatArray
    angle: FloatArray
    position: FloatArray
    rows: NDArray[np.intp]
    resolution: float
    acceleration: float
    gravity: float
    stops: Stops


@dataclass(frozen=True)
class _Found:
    """What one detector finds.

    Attributes:
        left_out: readings.
        breaks: where the recording is parted.
        faults: what is said of the readings left out.
        parting: what is said of the breaks, to which the parts that are used are added.
        stops: end stops.
    """

    left_out: list[slice] = field(default_factory=list)
    breaks: list[Break] = field(default_factory=list)
    faults: list[Faulty] = field(default_factory=list)
    parting: list[Faulty] = field(default_factory=list)
    stops: Stops = NO_STOPS


def set_aside(
    time: FloatArray,
    angle: FloatArray,
    position: FloatArray,
    spike: NDArray[np.bool_],
    rows: NDArray[np.intp],
    *,
    resolution: float,
    acceleration: float,
    gravity: float,
    stops: Stops = NO_STOPS,
) -> SetAside:
    """Find what is to be left out.

    Args:
        time: strictly increasing, shape (n,) [s].
        angle: shape (n,) [rad].
        position: NaN where unknown, shape (n,) [m].
        spike: positions that are spikes, shape (n,).
        rows: of the file, shape (n,).
        resolution: of the positions [m], 0 if unknown.
        acceleration: largest possible acceleration of the ball [m/s²].
        gravity: g [m/s²].
        stops: end stops that other recordings of the rig tell.
    """
    record = _Record(time, angle, position, rows, resolution, acceleration, gravity, stops)
    usable = np.isfinite(position) & ~spike
    mask = np.zeros(len(time), dtype=np.bool_)
    found: list[_Found] = []
    for detect in (_frozen, _jumps, _stuck_angles, _contacts):
        found.append(detect(record, usable & ~mask))
        for readings in found[-1].left_out:
            mask[readings] = True
    told = found[-1].stops
    breaks = [each for one in found for each in one.breaks]
    found.append(_pushes(record, usable & ~mask & ~_acting_late(breaks, time)))
    breaks += found[-1].breaks
    parts = parts_between(breaks, time, usable & ~mask)
    used = _used_text(parts, time, rows)
    parting = (each._replace(text=f"{each.text} {used}") for one in found for each in one.parting)
    return SetAside(mask, parts, (*(each for one in found for each in one.faults), *parting), told)


def _frozen(record: _Record, usable: NDArray[np.bool_]) -> _Found:
    runs = tuple(
        frozen(record.time, record.position, usable, resolution=record.resolution, acceleration=record.acceleration)
    )
    return _Found(
        left_out=[slice(run.first, run.last + 1) for run in runs],
        faults=[Faulty(run.fault.value, "position", _frozen_text(run, record)) for run in runs],
    )


def _jumps(record: _Record, usable: NDArray[np.bool_]) -> _Found:
    """Readings between a jump and one back are left out; any other jump parts the recording."""
    found = _Found()
    pending = list(jumps(record.time, record.position, record.angle, usable, acceleration=record.acceleration))
    while pending:
        one = pending.pop(0)
        if pending and _and_back(one, pending[0], len(record.time)):
            back = pending.pop(0)
            found.left_out.append(slice(one.at, back.at))
            found.faults.append(Faulty("jump", "position", _there_and_back(one, back, record)))
        else:
            found.breaks.append(Break(one.at, one.at, shifts=not one.angle_too))
            found.parting.append(_jump(one, record))
    return found


def _stuck_angles(record: _Record, usable: NDArray[np.bool_]) -> _Found:
    spans = tuple(stuck_angles(record.time, record.angle, record.position, usable))
    return _Found(
        breaks=[Break(first, last + 1) for first, last in spans],
        parting=[Faulty("stuck-angle", "angle", _stuck_text(first, last, record)) for first, last in spans],
    )


def _contacts(record: _Record, usable: NDArray[np.bool_]) -> _Found:
    contacts, stops = end_stops(
        *(record.time, record.angle, record.position, usable),
        resolution=record.resolution,
        gravity=record.gravity,
        known=record.stops,
    )
    parting = [Faulty("end-stop", "position", _contacts_text(contacts, record))] if contacts else []
    return _Found(breaks=[Break(one.first, one.last + 1) for one in contacts], parting=parting, stops=stops)


def _pushes(record: _Record, usable: NDArray[np.bool_]) -> _Found:
    pushed = pushes(record.time, record.angle, record.position, usable, gravity=record.gravity)
    parting = [Faulty("push", "position", _pushes_text(pushed, record))] if pushed else []
    return _Found(breaks=[Break(one.first, one.last + 1) for one in pushed], parting=parting)


def _acting_late(breaks: Sequence[Break], time: FloatArray) -> NDArray[np.bool_]:
    """Readings of the breaks, and after them for as long as an angle of before may act; shape (n,)."""
    late = np.zeros(len(time), dtype=np.bool_)
    for each in breaks:
        late[each.first : int(np.searchsorted(time, time[min(each.last, len(time) - 1)] + LATEST))] = True
    return late


def _used_text(parts: Sequence[slice], time: FloatArray, rows: NDArray[np.intp]) -> str:
    if parts == (slice(0, len(time)),):
        return "The parts are too short to be used alone, so that all is used; check the sensors."
    if len(parts) == 1:
        return f"Only {rows_text(rows[parts[0]])} are used."
    told = [rows_text(rows[part]) + suffix for part, suffix in suffixes(parts)]
    return f"Only {', '.join(told[:-1])} and {told[-1]} are used, each as a recording of its own."


def _and_back(one: Jump, other: Jump, count: int) -> bool:
    """Whether the second jump undoes the first, after less than half of the recording."""
    if one.angle_too or other.angle_too or 2 * (other.at - one.at) > count:
        return False
    return abs(one.size + other.size) < AND_BACK * max(abs(one.size), abs(other.size))


def _frozen_text(run: Run, record: _Record) -> str:
    return (
        f"stays at {run.value:.4g} m for {record.time[run.last] - record.time[run.first]:.2g} s "
        f"({rows_text(record.rows[run.first : run.last + 1])}, t = {record.time[run.first]:.4g} s), "
        f"{_FROZEN[run.fault]}. "
        "These readings are left out of all fits."
    )


def _there_and_back(one: Jump, back: Jump, record: _Record) -> str:
    return (
        f"jumps by {1e3 * one.size:.2g} mm at t = {record.time[one.at]:.4g} s and back at "
        f"t = {record.time[back.at]:.4g} s ({rows_text(record.rows[one.at : back.at])}), "
        "which no ball can do. These readings are left out of all fits."
    )


def _stuck_text(first: int, last: int, record: _Record) -> str:
    return (
        f"stays at {1e3 * record.angle[first]:.4g} mrad for {record.time[last] - record.time[first]:.2g} s "
        f"({rows_text(record.rows[first : last + 1])}, t = {record.time[first]:.4g} s), "
        "but the ball's acceleration shows that the beam turned: the sensor was stuck."
    )


def _contacts_text(contacts: Sequence[Contact], record: _Record) -> str:
    told = [f"{one.touch} at {one.place:.3g} m, {_when(one, record)}" for one in contacts[:MAX_PLACES]]
    return f"the ball {_listed(told, len(contacts))}: no model has the force that does so."


def _pushes_text(pushed: Sequence[Push], record: _Record) -> str:
    told = [f"by {one.size:.2f} m/s at {_when(one, record)}" for one in pushed[:MAX_PLACES]]
    return (
        f"the ball's velocity changes {_listed(told, len(pushed))}, where the beam does not turn as suddenly: it was "
        "pushed, or hit something, which no model has."
    )


def _when(one: Contact | Push, record: _Record) -> str:
    where = rows_text(record.rows[one.first : one.last + 1])
    return f"t = {record.time[one.first]:.4g} to {record.time[one.last]:.4g} s ({where})"


def _listed(told: Sequence[str], count: int) -> str:
    return "; ".join(told) + (f"; and at {count - len(told)} more places" if count > len(told) else "")


def _jump(one: Jump, record: _Record) -> Faulty:
    where = f"{1e3 * one.size:.2g} mm before row {record.rows[one.at]} (t = {record.time[one.at]:.4g} s)"
    if one.angle_too:
        text = f"jumps by {where}, and the angle with it: rows seem to be lost and the time renumbered."
        return Faulty("lost-rows", "position", text)
    return Faulty("jump", "position", f"jumps by {where}, which no ball can do.")
