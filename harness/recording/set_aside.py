"""Readings that are left out of every fit, and what is said of them.

A stretch in which the position's sensor was stuck, gave zeros, was clipped, or was offset for a while is left out.
Where an offset stays, rows are lost, the angle's sensor was stuck, the ball touches an end stop, is held or pushed, no
model can be run across the place: the parts between are used as recordings of their own. Behind an offset that stays
the position has another origin, which acts on the ball as a level would, so that the part before it may be shorter.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from analytic.motion import FloatArray
from harness.recording.end_stops import Contact, end_stops
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
    """

    mask: NDArray[np.bool_]
    parts: tuple[slice, ...]
    faults: tuple[Faulty, ...]


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
    """
    usable = np.isfinite(position) & ~spike
    mask = np.zeros(len(time), dtype=np.bool_)
    faults: list[Faulty] = []
    for run in frozen(time, position, usable, resolution=resolution, acceleration=acceleration):
        mask[run.first : run.last + 1] = True
        faults.append(Faulty(run.fault.value, "position", _frozen_text(run, time, rows)))
    breaks: list[Break] = []
    parting: list[Faulty] = []
    pending = list(jumps(time, position, angle, usable & ~mask, acceleration=acceleration))
    while pending:
        one = pending.pop(0)
        if pending and _and_back(one, pending[0], len(time)):
            back = pending.pop(0)
            mask[one.at : back.at] = True
            faults.append(Faulty("jump", "position", _there_and_back(one, back, time, rows)))
        else:
            breaks.append(Break(one.at, one.at, shifts=not one.angle_too))
            parting.append(_jump(one, time, rows))
    for first, last in stuck_angles(time, angle, position, usable & ~mask):
        breaks.append(Break(first, last + 1))
        parting.append(Faulty("stuck-angle", "angle", _stuck_text(first, last, time, angle, rows)))
    contacts = end_stops(time, angle, position, usable & ~mask, resolution=resolution, gravity=gravity)
    if contacts:
        breaks += [Break(one.first, one.last + 1) for one in contacts]
        parting.append(Faulty("end-stop", "position", _contacts_text(contacts, time, rows)))
    free = usable & ~mask
    for each in breaks:  # for as long as an angle of before may act late
        free[each.first : int(np.searchsorted(time, time[min(each.last, len(time) - 1)] + LATEST))] = False
    pushed = pushes(time, angle, position, free, gravity=gravity)
    if pushed:
        breaks += [Break(one.first, one.last + 1) for one in pushed]
        parting.append(Faulty("push", "position", _pushes_text(pushed, time, rows)))
    parts = parts_between(breaks, time, usable & ~mask)
    used = _used_text(parts, time, rows)
    faults += [one._replace(text=f"{one.text} {used}") for one in parting]
    return SetAside(mask, parts, tuple(faults))


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


def _frozen_text(run: Run, time: FloatArray, rows: NDArray[np.intp]) -> str:
    return (
        f"stays at {run.value:.4g} m for {time[run.last] - time[run.first]:.2g} s "
        f"({rows_text(rows[run.first : run.last + 1])}, t = {time[run.first]:.4g} s), {_FROZEN[run.fault]}. "
        "These readings are left out of all fits."
    )


def _there_and_back(one: Jump, back: Jump, time: FloatArray, rows: NDArray[np.intp]) -> str:
    return (
        f"jumps by {1e3 * one.size:.2g} mm at t = {time[one.at]:.4g} s and back at t = {time[back.at]:.4g} s "
        f"({rows_text(rows[one.at : back.at])}), which no ball can do. These readings are left out of all fits."
    )


def _stuck_text(first: int, last: int, time: FloatArray, angle: FloatArray, rows: NDArray[np.intp]) -> str:
    return (
        f"stays at {1e3 * angle[first]:.4g} mrad for {time[last] - time[first]:.2g} s "
        f"({rows_text(rows[first : last + 1])}, t = {time[first]:.4g} s), but the ball's acceleration shows that "
        "the beam turned: the sensor was stuck."
    )


def _contacts_text(contacts: Sequence[Contact], time: FloatArray, rows: NDArray[np.intp]) -> str:
    told = [f"{one.touch} at {one.place:.3g} m, {_when(one, time, rows)}" for one in contacts[:MAX_PLACES]]
    return f"the ball {_listed(told, len(contacts))}: no model has the force that does so."


def _pushes_text(pushed: Sequence[Push], time: FloatArray, rows: NDArray[np.intp]) -> str:
    told = [f"by {one.size:.2f} m/s at {_when(one, time, rows)}" for one in pushed[:MAX_PLACES]]
    return (
        f"the ball's velocity changes {_listed(told, len(pushed))}, where the beam does not turn as suddenly: it was "
        "pushed, or hit something, which no model has."
    )


def _when(one: Contact | Push, time: FloatArray, rows: NDArray[np.intp]) -> str:
    where = rows_text(rows[one.first : one.last + 1])
    return f"t = {time[one.first]:.4g} to {time[one.last]:.4g} s ({where})"


def _listed(told: Sequence[str], count: int) -> str:
    return "; ".join(told) + (f"; and at {count - len(told)} more places" if count > len(told) else "")


def _jump(one: Jump, time: FloatArray, rows: NDArray[np.intp]) -> Faulty:
    where = f"{1e3 * one.size:.2g} mm before row {rows[one.at]} (t = {time[one.at]:.4g} s)"
    if one.angle_too:
        text = f"jumps by {where}, and the angle with it: rows seem to be lost and the time renumbered."
        return Faulty("lost-rows", "position", text)
    return Faulty("jump", "position", f"jumps by {where}, which no ball can do.")
