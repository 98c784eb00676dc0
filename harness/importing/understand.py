"""From the signals of a file to time, beam angle and ball position in SI units, with the evidence for each step."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np

from analytic.motion import FloatArray
from harness.errors import InputError
from harness.importing.choices import Ambiguity, Choice, Linkage, Options, parse_linkage
from harness.importing.columns import Found, find
from harness.importing.merge import on_common_rows
from harness.importing.physics import Evidence, evidence_of
from harness.importing.questions import Questions
from harness.importing.rows import only_where
from harness.importing.scales import scales_of
from harness.importing.signals import Group, SourceFile
from harness.importing.times import Times, times_of
from harness.importing.units import Scale, scale_of
from harness.importing.words import Role
from harness.recording.resolution import inferred_resolution
from harness.recording.sampling import MIN_SAMPLES, check_order

LATEST = 1e5  # stamps beyond count from another origin than the recording, such as 1970 [s]


@dataclass(frozen=True)
class Line:
    """What was understood of one column.

    Attributes:
        role: time, angle or position.
        column: its name; empty where no column holds the time.
        unit: unit or calibration.
        evidence: why it is this quantity; unit_from: why it has this unit.
        range: of the values, in words.
    """

    role: Role
    column: str
    unit: str
    evidence: str
    unit_from: str
    range: str


@dataclass(frozen=True, eq=False)
class Understood:
    """A recording, and how it was understood.

    Attributes:
        sources: files that it comes from.
        time: [s], angle: α [rad], position: s [m], NaN where unknown; shape (n,) each.
        lines: one a column.
        sign: what the data say of the signs, in words; sign_checked: whether they say anything.
        rate: what the stamps say, in words.
        notes: what was assumed, left out or changed.
        angle_resolution: step of α [rad]; position_resolution [m]; `None` where the readings show none, or where the
            angle was interpolated.
        linkage: if the angle was computed by one.
        flipped: quantities that were negated.
    """

    sources: tuple[SourceFile, ...]
    time: FloatArray
    angle: FloatArray
    position: FloatArray
    lines: tuple[Line, ...]
    sign: str
    sign_checked: bool
    rate: str
    notes: tuple[str, ...]
    angle_resolution: float | None
    position_resolution: float | None
    linkage: Linkage | None
    flipped: tuple[Role, ...]


def understand(sources: Sequence[SourceFile], options: Options) -> Understood:
    """Finds the quantities in files that belong to one recording.

    Raises:
        Ambiguity: something cannot be told from the data and was not chosen.
        InputError: a choice or the data are impossible.
    """
    path = sources[0].path
    groups, chosen = only_where(path, _groups(sources), options.where)
    linkage = None if options.linkage is None else parse_linkage(options.linkage)
    read = [*(note for one in sources for note in one.notes), *chosen]
    questions = Questions(path, read)
    angle_at = questions.answer(lambda: find(path, "angle", groups, options))
    taken = None if angle_at is None else angle_at.signal
    position_at = questions.answer(lambda: find(path, "position", groups, options, taken=taken))
    timed = angle_at or position_at
    group = timed.group if timed is not None else groups[0]
    times = questions.answer(lambda: times_of(path, group, groups, options))
    found: dict[Role, Found | None] = {"angle": angle_at, "position": position_at}
    written = {
        role: questions.answer(partial(scale_of, path, role, one)) for role, one in found.items() if one is not None
    }
    questions.settle()
    assert angle_at is not None  # only a position may be missing
    assert times is not None
    if position_at is not None and position_at.signal is angle_at.signal:
        raise InputError(f"{path}: '{angle_at.name}' is given as angle and as position. Choose two columns.")
    if angle_at.signal.name == times.name:
        raise InputError(f"{path}: '{angle_at.name}' is given as time and as angle. Choose two columns.")
    notes = list(read)
    together = position_at is None or position_at.group is angle_at.group
    position_times = times if together or position_at is None else times_of(path, position_at.group, groups, options)
    if position_at is not None and position_at.signal.name == position_times.name:
        raise InputError(f"{path}: '{position_at.name}' is given as time and as position. Choose two columns.")
    scales = scales_of(path, times, position_times, angle_at, position_at, written, linkage, options)
    rows, time, angle = _column(path, times, scales["time"], angle_at, scales["angle"], notes)
    read_angle = angle
    interpolated = False
    if linkage is not None:
        angle = linkage.beam(angle)
        notes.append(f"beam angle computed from the crank's: {linkage}")
    if position_at is None:
        position = np.full(len(time), np.nan)
    elif together:
        position = scales["position"].applied(position_at.signal.values)[rows]
    else:
        of_position = Scale(position_times.unit, position_times.factor or scales["time"].factor, "")
        _, stamps, position = _column(path, position_times, of_position, position_at, scales["position"], notes)
        try:
            time, angle, position, done = on_common_rows(time, angle, stamps, position)
        except ValueError:
            raise InputError(
                f"{path}: '{angle_at.name}' holds fewer than two angles. Record the beam's angle."
            ) from None
        if done:
            notes.append(done)
            interpolated = True
    if len(time) < MIN_SAMPLES:
        raise InputError(f"{path}: only {len(time)} rows with a time; at least {MIN_SAMPLES} are needed.")
    flipped: list[Role] = []
    for role, flip in (("angle", options.flip_angle), ("position", options.flip_position)):
        if flip:
            flipped.append("angle" if role == "angle" else "position")
    angle = -angle if options.flip_angle else angle
    position = -position if options.flip_position else position
    evidence = evidence_of(time, angle, position, gravity=options.gravity)
    sign, checked = _sign(path, evidence, options, position_at, scales.get("position"))
    if abs(time[0]) > LATEST or (times.chosen is None and "date" in times.unit_from):
        notes.append(f"time counted from the first row, whose stamp is {time[0]:.6f} s")
        time = time - time[0]
    steps = inferred_resolution(read_angle), inferred_resolution(position)
    gear = 1.0 if linkage is None else linkage.radius / linkage.length
    return Understood(
        tuple(sources),
        time,
        angle,
        position,
        tuple(_lines(times, angle_at, position_at, scales, time, angle, position)),
        sign,
        checked,
        _rate(time, times),
        tuple(dict.fromkeys(notes)),
        None if steps[0] is None or interpolated else steps[0] * gear,
        steps[1],
        linkage,
        tuple(flipped),
    )


def _groups(sources: Sequence[SourceFile]) -> tuple[Group, ...]:
    """Groups of all files; those of several files carry the file's name."""
    if len(sources) == 1:
        return sources[0].groups
    return tuple(
        replace(group, name=f"{one.path.stem}/{group.name}" if group.name else one.path.stem)
        for one in sources
        for group in one.groups
    )


def _column(
    path: Path, times: Times, time_scale: Scale, found: Found, scale: Scale, notes: list[str]
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Which rows have a time, their times [s] and the values of a signal [SI]; times must not fall."""
    time = time_scale.factor * times.values
    stamped = np.isfinite(time)
    rows = found.group.rows
    if not stamped.all():
        notes.append(f"{int((~stamped).sum())} rows without a time left out")
    values = scale.applied(found.signal.values)
    check_order(path, times.name or "time", time[stamped], rows[stamped])
    return stamped, time[stamped], values[stamped]


def _sign(
    path: Path, evidence: Evidence, options: Options, position_at: Found | None, scale: Scale | None
) -> tuple[str, bool]:
    """What the data say of the signs.

    Raises:
        Ambiguity: the ball accelerates against the angle, and the user has not said to keep the signs.
    """
    if not evidence.conclusive:
        seen = (
            f"the ball does not follow the angle clearly (correlation {evidence.response.correlation:.2f})"
            if evidence.response
            else "the data are too few, or one signal is constant"
        )
        return f"not checked, as {seen}; a positive angle must accelerate the ball towards +s", False
    if evidence.slope > 0.0:
        return f"right: {evidence}; a positive angle accelerates the ball towards +s", True
    if options.keep_signs:
        return f"kept, against the data: {evidence}", True
    advice = ""
    if position_at is not None and scale is not None and (scale.gain, scale.offset) == (1.0, 0.0):
        length = f"{1.0 / scale.factor:g}"
        advice = (
            "Where the distance counts from the other end, subtract it from the length between both, such as "
            f"{length} {scale.unit}: --position '{position_at.name}:-1 {scale.unit}+{length}'."
        )
    raise Ambiguity(
        f"{path}: {evidence}: a positive angle must accelerate the ball towards +s, so that one sign is reversed.",
        (
            Choice({"flip_angle": not options.flip_angle}, _flip("angle", options.flip_angle), "the angle's"),
            Choice(
                {"flip_position": not options.flip_position}, _flip("position", options.flip_position), "the position's"
            ),
            Choice({"keep_signs": True}, "--keep-signs", "leave both as they are"),
        ),
        advice,
    )


def _flip(role: str, given: bool) -> str:
    return f"no --flip-{role}" if given else f"--flip-{role}"


def _rate(time: FloatArray, times: Times) -> str:
    steps = np.diff(time)
    median = float(np.median(steps))
    if median <= 0.0:
        return f"{len(time)} rows, of which most repeat a stamp"
    source = "from the stamps" if times.name else f"from {times.evidence}"
    uneven = float(np.std(steps)) / median
    even = "even" if uneven < 0.01 else f"uneven, standard deviation of the step {100.0 * uneven:.2g} %"
    return f"{1.0 / median:.6g} Hz {source}, {even}; {len(time)} rows, {float(time[-1] - time[0]):.4g} s"


def _lines(
    times: Times,
    angle_at: Found,
    position_at: Found | None,
    scales: dict[Role, Scale],
    time: FloatArray,
    angle: FloatArray,
    position: FloatArray,
) -> list[Line]:
    found: list[tuple[Role, str, str, str, FloatArray]] = [
        ("time", times.name, times.evidence, "s", time),
        ("angle", angle_at.name, angle_at.evidence, "rad", angle),
    ]
    if position_at is not None:
        found.append(("position", position_at.name, position_at.evidence, "m", position))
    made = []
    for role, column, evidence, si, values in found:
        known = values[np.isfinite(values)]
        extent = f"{known.min():.4g} to {known.max():.4g} {si}" if len(known) else "blank"
        made.append(Line(role, column, str(scales[role]), evidence, scales[role].source, extent))
    return made
