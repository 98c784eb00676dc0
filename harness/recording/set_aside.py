"""Readings that are left out of every fit, because a sensor was wrong there, and what is said of them.

A stretch in which the position's sensor was stuck, gave zeros, was clipped, or was offset for a while is left out.
Where an offset stays, rows are lost, the angle's sensor was stuck, or the ball touches an end stop, no model can be run
across the place: only the longest part of the recording without such a place is used. Behind an offset that stays the
position has another origin, which acts on the ball as a level would, so that a part before it may be shorter.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from analytic.motion import FloatArray
from harness.recording.end_stops import Contact, end_stops
from harness.recording.findings import MAX_PLACES, rows_text
from harness.recording.frozen import Fault, Run, frozen
from harness.recording.jumps import Jump, jumps
from harness.recording.sampling import too_short
from harness.recording.stuck_angle import stuck_angles

SHIFTED = 0.25  # weight of readings behind an offset that stays
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
        kept: the part of the recording that is used.
        faults: what is said of both.
    """

    mask: NDArray[np.bool_]
    kept: slice
    faults: tuple[Faulty, ...]


@dataclass(frozen=True)
class _Break:
    """Readings `first` to `last` − 1, across which no model can be run; none where rows are lost."""

    first: int
    last: int
    code: str
    channel: Literal["position", "angle"]
    text: str


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
    found = jumps(time, position, angle, usable & ~mask, acceleration=acceleration)
    breaks: list[_Break] = []
    pending = list(found)
    while pending:
        one = pending.pop(0)
        if pending and _and_back(one, pending[0], len(time)):
            back = pending.pop(0)
            mask[one.at : back.at] = True
            faults.append(Faulty("jump", "position", _there_and_back(one, back, time, rows)))
        else:
            breaks.append(_break(one, time, rows))
    for first, last in stuck_angles(time, angle, position, usable & ~mask):
        text = (
            f"stays at {1e3 * angle[first]:.4g} mrad for {time[last] - time[first]:.2g} s "
            f"({rows_text(rows[first : last + 1])}, t = {time[first]:.4g} s), but the ball's acceleration shows that "
            "the beam turned: the sensor was stuck."
        )
        breaks.append(_Break(first, last + 1, "stuck-angle", "angle", text))
    told = [Faulty(one.code, one.channel, one.text) for one in breaks]
    spans = [(one.first, one.last) for one in breaks]
    contacts = end_stops(time, angle, position, usable & ~mask, resolution=resolution, gravity=gravity)
    if contacts:
        told.append(Faulty("end-stop", "position", _contacts_text(contacts, time, rows)))
        spans += [(one.first, one.last + 1) for one in contacts]
    shifted = min((one.first for one in breaks if one.code == "jump"), default=len(time))
    kept = _longest(spans, shifted, usable & ~mask)
    used = f"Only {rows_text(rows[kept])} are used; save the parts as recordings of their own to use all of them."
    if too_short(time[kept]):
        kept = slice(0, len(time))
        used = "The parts are too short to be used alone, so that all is used; check the sensors."
    faults += [one._replace(text=f"{one.text} {used}") for one in told]
    return SetAside(mask, kept, tuple(faults))


def _longest(spans: Sequence[tuple[int, int]], shifted: int, usable: NDArray[np.bool_]) -> slice:
    """The part between spans that has the most usable positions; from `shifted` on, with another origin, less so."""
    edges = [0, *(edge for span in sorted(spans) for edge in span), len(usable)]
    parts = [slice(first, last) for first, last in list(pairwise(edges))[::2]]
    return max(parts, key=lambda part: usable[part].sum() * (1.0 if part.stop <= shifted else SHIFTED))


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


def _contacts_text(contacts: Sequence[Contact], time: FloatArray, rows: NDArray[np.intp]) -> str:
    told = [
        f"{'lies against' if one.rests else 'bounces from'} the one at {one.stop:.3g} m "
        f"at t = {time[one.first]:.4g} to {time[one.last]:.4g} s ({rows_text(rows[one.first : one.last + 1])})"
        for one in contacts[:MAX_PLACES]
    ]
    more = f"; and at {len(contacts) - MAX_PLACES} more places" if len(contacts) > MAX_PLACES else ""
    return f"the ball touches end stops, which no model has: it {'; '.join(told)}{more}."


def _break(one: Jump, time: FloatArray, rows: NDArray[np.intp]) -> _Break:
    where = f"{1e3 * one.size:.2g} mm before row {rows[one.at]} (t = {time[one.at]:.4g} s)"
    if one.angle_too:
        text = f"jumps by {where}, and the angle with it: rows seem to be lost and the time renumbered."
        return _Break(one.at, one.at, "lost-rows", "position", text)
    return _Break(one.at, one.at, "jump", "position", f"jumps by {where}, which no ball can do.")
