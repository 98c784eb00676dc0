"""One recording: validated arrays read from one CSV file."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from analytic.motion import FloatArray
from harness.recording.bunches import evened
from harness.recording.columns import QUANTITIES, QuantityName, find_columns
from harness.recording.end_stops import NO_STOPS, Stops
from harness.recording.findings import DataFinding, place, rows_text
from harness.recording.held import repeats
from harness.recording.known_rig import KnownRig, Sensors
from harness.recording.outliers import spikes
from harness.recording.parts import suffixes
from harness.recording.plausibility import STANDARD_GRAVITY, Signals, constant, implausible
from harness.recording.resolution import inferred_resolution
from harness.recording.sampling import (
    bridge_angle,
    check_length,
    check_order,
    merge_duplicates,
    sampling_findings,
)
from harness.recording.set_aside import set_aside
from harness.recording.source import read_source
from harness.recording.table import numbers_of, read_table

BEAM_ACCELERATION = 10.0  # g / 1 m: above it a ball one metre from the pivot lifts off [rad/s²]


@dataclass(frozen=True, eq=False)
class Recording:
    """A recording in SI units; arrays are read-only and of shape (n,).

    Attributes:
        name: file name.
        path: of the file.
        time: strictly increasing [s].
        angle: α, free of NaN [rad].
        position: s, NaN if unknown; outliers are kept [m].
        velocity: ṡ, NaN if unknown; `None` if it was not recorded [m/s].
        outlier: true where the position is a spike.
        set_aside: true where the position is left out of every fit, as its sensor was wrong there.
        cut_off: stamps [s] and positions [m] that are in no part of the file that is used; shape (k, 2).
        findings: warnings and notes on the data.
        sha256: of the file's bytes.
        angle_step: distance of two readings of the angle, inferred from the whole file; `None` if that has none [rad].
        position_step: likewise of the position [m].
        stops: the end stops that the file tells.
        further: other parts of the file, where a fault, an end stop or a push parts it, as recordings of their own.
    """

    name: str
    path: Path
    time: FloatArray
    angle: FloatArray
    position: FloatArray
    velocity: FloatArray | None
    outlier: NDArray[np.bool_]
    set_aside: NDArray[np.bool_]
    cut_off: FloatArray
    findings: tuple[DataFinding, ...]
    sha256: str
    angle_step: float | None = None
    position_step: float | None = None
    stops: Stops = NO_STOPS
    further: tuple[Recording, ...] = ()

    @property
    def known(self) -> NDArray[np.bool_]:
        """Where the position is known, shape (n,)."""
        return np.isfinite(self.position)

    @property
    def usable(self) -> NDArray[np.bool_]:
        """Where the position is known and not set aside, shape (n,)."""
        return self.known & ~self.set_aside

    @property
    def left_out(self) -> FloatArray:
        """Stamps [s] and positions [m] of all readings that are left out, shape (k, 2)."""
        return np.concatenate((self.cut_off, np.column_stack((self.time, self.position))[self.set_aside]))


def load_recording(
    path: str | Path, *, rig: KnownRig | None = None, sensors: Sensors | None = None, stops: Stops = NO_STOPS
) -> Recording:
    """Reads and checks a CSV recording.

    Args:
        path: the file; columns as in `harness.recording.columns`.
        rig: known quantities; gravity and beam length are used by the plausibility checks.
        sensors: declared resolutions, compared with those inferred from the data.
        stops: end stops that other recordings of the rig tell.

    Raises:
        InputError: the file is invalid; the message names file, row and column, and the remedy.
    """
    path = Path(path)
    source = read_source(path)
    table = read_table(path, source.text)
    columns, findings = find_columns(path, table.header, table.header_row)
    values = numbers_of(table, *(column.index for column in columns.values()))
    channels: dict[QuantityName, FloatArray] = {
        name: numbers * column.factor for (name, column), numbers in zip(columns.items(), values, strict=True)
    }
    time = channels.pop("time")
    check_order(path, columns["time"].header, time, table.rows)
    time, bunched = evened(path, time, [channels[name] for name in ("angle", "position") if name in channels])
    time, rows, channels, merged = merge_duplicates(path, time, table.rows, channels)
    check_length(path, columns["time"].header, time, len(table.rows))
    filled = ~np.isfinite(channels["angle"])
    angle, bridged = bridge_angle(path, columns["angle"].header, time, channels["angle"], rows)
    position = channels.get("position", np.full(len(time), np.nan))
    velocity = channels.get("velocity")
    findings += [*bunched, *merged, *bridged, *sampling_findings(path, time, rows)]

    rig, sensors = rig or KnownRig(), sensors or Sensors()
    angle_step, position_step = inferred_resolution(angle), inferred_resolution(position)
    resolution = sensors.position_resolution or position_step or 0.0
    gravity = rig.gravity or STANDARD_GRAVITY
    steepest = min(float(np.max(np.abs(angle))), 0.5) + 0.02  # level error and track slope may add a degree
    fastest = gravity * steepest
    outlier = spikes(time, position, resolution=resolution, acceleration=fastest)
    aside = set_aside(
        *(time, angle, position, outlier, rows),
        resolution=resolution,
        acceleration=fastest,
        gravity=gravity,
        stops=stops,
    )
    findings += _angle_findings(path, columns["angle"].header, time, angle, rows, angle_step or 0.0)
    if "position" in columns:
        header, usable = columns["position"].header, np.isfinite(position) & ~aside.mask
        findings += _position_findings(path, header, position, outlier, rows)
        findings += _held_findings(path, header, time, position[usable], resolution)
    for one in aside.faults:
        where = place(path.name, column=columns[one.channel].header)
        findings.append(DataFinding("warning", where, one.text, one.code))
    kept = aside.parts[0]
    names = [QUANTITIES[name].named(one.factor) for name, one in columns.items()]
    signals = Signals(
        time[kept], angle[kept], position[kept], (outlier | aside.mask)[kept], rig, names, sensors, filled[kept]
    )
    odd = [*implausible(signals), *constant(angle, position[np.isfinite(position) & ~outlier])]
    findings += [DataFinding("warning", path.name, one.text, one.code) for one in odd]
    nothing = np.empty((0, 2))
    read = (time, angle, position, velocity, outlier, aside.mask)
    whole = Recording(path.name, path, *read, nothing, (), source.sha256, angle_step, position_step, aside.stops)
    unused = np.ones(len(time), dtype=np.bool_)
    for part in aside.parts:
        unused[part] = False
    cut_off = np.column_stack((time, position))[unused]
    cut_off.setflags(write=False)
    further = tuple(_part(whole, part, path.name + suffix) for part, suffix in suffixes(aside.parts) if suffix)
    return replace(_part(whole, kept, path.name), cut_off=cut_off, findings=tuple(findings), further=further)


def _part(whole: Recording, part: slice, name: str) -> Recording:
    """Some of its rows, as a recording whose arrays are its own and read-only."""
    channels = ("time", "angle", "position", "velocity", "outlier", "set_aside")
    rows = {each: getattr(whole, each)[part].copy() for each in channels if getattr(whole, each) is not None}
    for array in rows.values():
        array.setflags(write=False)
    return replace(whole, name=name, **rows)


def _angle_findings(
    path: Path, column: str, time: FloatArray, angle: FloatArray, rows: NDArray[np.intp], resolution: float
) -> list[DataFinding]:
    spike = spikes(time, angle, resolution=resolution, acceleration=BEAM_ACCELERATION)
    if not spike.any():
        return []
    text = (
        f"{int(spike.sum())} of {len(angle)} angles are outliers ({rows_text(rows[spike])}). They "
        "are used unchanged to drive the models; leave these cells blank to have them interpolated."
    )
    return [DataFinding("warning", place(path.name, column=column), text, "angle-outliers")]


def _held_findings(
    path: Path, column: str, time: FloatArray, position: FloatArray, resolution: float
) -> Iterator[DataFinding]:
    held = repeats(position, resolution=resolution)
    if held:
        interval = float(time[-1] - time[0]) / (len(position) - held)
        text = (
            f"{held} of {len(position)} positions repeat the one before, until the next differs by more than the "
            f"sensor's step: it has a new one about every {interval:.2g} s. They are late by half of that on average, "
            "which is found as a delay; record each position once, when it is measured."
        )
        yield DataFinding("note", place(path.name, column=column), text, "held-position")


def _position_findings(
    path: Path, column: str, position: FloatArray, outlier: NDArray[np.bool_], rows: NDArray[np.intp]
) -> list[DataFinding]:
    where = place(path.name, column=column)
    findings: list[DataFinding] = []
    known = np.isfinite(position)
    if not known.all():
        text = f"unknown in {int((~known).sum())} of {len(known)} rows ({rows_text(rows[~known])})."
        findings.append(DataFinding("note", where, text, "blank-positions"))
    if outlier.any():
        text = (
            f"{int(outlier.sum())} of {int(known.sum())} positions are outliers ({rows_text(rows[outlier])}). They are "
            "kept and marked; check the sensor."
        )
        findings.append(DataFinding("warning", where, text, "position-outliers"))
    return findings
