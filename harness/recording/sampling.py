"""The time axis: in order, free of duplicates, and known to be even or not; short dropouts of the angle bridged."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from analytic.motion import FloatArray
from harness.errors import InputError
from harness.recording.columns import QuantityName
from harness.recording.findings import SHOWN, Finding, place, rows_text

FEWEST_SAMPLES = 20
SHORTEST = 0.5  # [s]
# A beam that swings by 3° once a second leaves the chord by α̈ T²/8 = 0.6 mrad in this time, less than one count of
# the paper's encoder.
LONGEST_BRIDGE = 0.05  # [s]
LONG_STEP = 5.0  # median steps
UNEVEN = 0.05  # share of the median step

IntArray = NDArray[np.intp]


def check_order(path: Path, column: str, time: FloatArray, rows: IntArray) -> None:
    """Refuses blank stamps and stamps that go back.

    Raises:
        InputError: names the first such row.
    """
    blank = np.flatnonzero(np.isnan(time))
    if len(blank):
        raise InputError(
            f"{place(path, rows[blank[0]], column)}: blank. Every row needs its time; delete rows without."
        )
    back = np.flatnonzero(np.diff(time) < 0)
    if len(back):
        at = int(back[0]) + 1
        raise InputError(
            f"{place(path, rows[at], column)}: time goes back from {time[at - 1]:.9g} to {time[at]:.9g} s"
            f"{f' (and at {len(back) - 1} more places)' if len(back) > 1 else ''}. Save each recording in a "
            "file of its own, in the order of time."
        )


def merge_duplicates(
    path: Path, time: FloatArray, rows: IntArray, channels: dict[QuantityName, FloatArray]
) -> tuple[FloatArray, IntArray, dict[QuantityName, FloatArray], list[Finding]]:
    """Replaces rows with the same stamp by one row with the means of what is known in them."""
    stamps, first, group, counts = np.unique(time, return_index=True, return_inverse=True, return_counts=True)
    if len(stamps) == len(time):
        return time, rows, channels, []
    merged: dict[QuantityName, FloatArray] = {}
    for name, values in channels.items():
        known = np.isfinite(values)
        sums = np.bincount(group[known], values[known], minlength=len(stamps))
        with np.errstate(invalid="ignore"):
            merged[name] = sums / np.bincount(group[known], minlength=len(stamps))
    repeated = rows[np.setdiff1d(np.arange(len(time)), first)]
    advice = " The stamps are printed too coarsely; record them with more digits." if counts.mean() > 1.2 else ""
    text = f"{len(repeated)} rows repeat the time of the row before ({rows_text(repeated)}); their values are averaged."
    return stamps, rows[first], merged, [Finding("warning", path.name, text + advice)]


def check_length(path: Path, column: str, time: FloatArray) -> None:
    """Refuses recordings too short to say anything.

    Raises:
        InputError: fewer than 20 samples, or less than 0.5 s.
    """
    if len(time) < FEWEST_SAMPLES:
        raise InputError(f"{path}: only {len(time)} samples; at least {FEWEST_SAMPLES} are needed. Record for longer.")
    duration = time[-1] - time[0]
    if duration < SHORTEST:
        raise InputError(
            f"{place(path, column=column)}: only {duration:.3g} s long; at least {SHORTEST} s are needed. "
            "Record for longer, or correct the unit in the column's name."
        )


def bridge_angle(
    path: Path, column: str, time: FloatArray, angle: FloatArray, rows: IntArray
) -> tuple[FloatArray, list[Finding]]:
    """Fills short dropouts of the angle by straight lines.

    Raises:
        InputError: a dropout is long, or at an end of the recording; the text names its rows.
    """
    blank = np.isnan(angle)
    if not blank.any():
        return angle, []
    known = np.flatnonzero(~blank)
    if len(known) < 2:
        raise InputError(f"{place(path, column=column)}: holds no numbers. The angle of the beam must be recorded.")
    longest = max(LONGEST_BRIDGE, 2.5 * float(np.median(np.diff(time))))
    for run in np.split(np.flatnonzero(blank), np.flatnonzero(np.diff(np.flatnonzero(blank)) > 1) + 1):
        where = place(path, column=column)
        if run[0] < known[0] or run[-1] > known[-1]:
            end = "first" if run[0] < known[0] else "last"
            raise InputError(f"{where}: {rows_text(rows[run])} blank at the {end} end. Delete these rows.")
        span = time[run[-1] + 1] - time[run[0] - 1]
        if span > longest:
            raise InputError(
                f"{where}: {rows_text(rows[run])} blank, the angle is unknown for {span:.3g} s; at most "
                f"{longest:.3g} s can be bridged. Split the recording there."
            )
    text = f"{int(blank.sum())} blank angles filled by straight lines ({rows_text(rows[blank])})."
    return np.interp(time, time[known], angle[known]), [Finding("warning", place(path.name, column=column), text)]


def sampling_findings(path: Path, time: FloatArray, rows: IntArray) -> Iterator[Finding]:
    """Dropouts (a warning with their places) and uneven steps (a note with figures)."""
    steps = np.diff(time)
    median = float(np.median(steps))
    gaps = np.flatnonzero(steps > LONG_STEP * median)
    if len(gaps):
        places = ", ".join(f"{steps[i]:.3g} s after row {rows[i]} (t = {time[i]:.4g} s)" for i in gaps[:SHOWN])
        more = f" and {len(gaps) - SHOWN} more" if len(gaps) > SHOWN else ""
        yield Finding(
            "warning",
            path.name,
            f"samples are missing: {places}{more}, where the median step is {median:.3g} s. What the beam did there is "
            "unknown; split the recording at long gaps.",
        )
    even = steps[steps <= LONG_STEP * median]
    if np.max(np.abs(even - median)) > UNEVEN * median:
        yield Finding(
            "note",
            path.name,
            f"steps are uneven: median {median:.4g} s, {np.min(even):.4g} to {np.max(even):.4g} s, standard deviation "
            f"{100 * np.std(even) / median:.2g} % of the median. The stamps are used as they are.",
        )
