"""Checks of the time axis (order, duplicates, gaps, jitter) and interpolation over short dropouts of the angle."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from analytic.motion import FloatArray
from harness.errors import InputError
from harness.recording.columns import QuantityName
from harness.recording.findings import DataFinding, abbreviated, place, rows_text

MIN_SAMPLES = 20
MIN_DURATION = 0.5  # [s]
# Linear interpolation of a 3° swing at 1 Hz is then off by at most α̈ T²/8 = 0.6 mrad, less than one count of the
# paper's encoder.
MAX_DROPOUT = 0.05  # [s]
GAP = 5.0  # steps longer than this are gaps, in median steps
MAX_JITTER = 0.05  # deviation of a step beyond which sampling is uneven, share of the median step

IntArray = NDArray[np.intp]


def check_order(path: Path, column: str, time: FloatArray, rows: IntArray) -> None:
    """Refuses blank and decreasing time stamps.

    Raises:
        InputError: with the first such row.
    """
    blank = np.flatnonzero(np.isnan(time))
    if len(blank):
        raise InputError(
            f"{place(path, rows[blank[0]], column)}: blank. Every row needs a time stamp; delete rows without one."
        )
    back = np.flatnonzero(np.diff(time) < 0)
    if len(back):
        at = int(back[0]) + 1
        raise InputError(
            f"{place(path, rows[at], column)}: time decreases from {time[at - 1]:.9g} to {time[at]:.9g} s"
            f"{f' (and at {len(back) - 1} more places)' if len(back) > 1 else ''}. Save each recording in a "
            "separate file, sorted by time."
        )


def merge_duplicates(
    path: Path, time: FloatArray, rows: IntArray, channels: dict[QuantityName, FloatArray]
) -> tuple[FloatArray, IntArray, dict[QuantityName, FloatArray], list[DataFinding]]:
    """Replaces rows with equal time stamps by one row that holds the means of their known values."""
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
    advice = " The time stamps have too few digits; record them with more." if counts.mean() > 1.2 else ""
    text = f"{len(repeated)} rows repeat a time stamp ({rows_text(repeated)}); their values are averaged."
    return stamps, rows[first], merged, [DataFinding("warning", path.name, text + advice, "equal-stamps")]


def too_short(time: FloatArray) -> bool:
    """Whether stamps, shape (n,) [s], are fewer or span less than a recording needs."""
    return len(time) < MIN_SAMPLES or bool(time[-1] - time[0] < MIN_DURATION)


def check_length(path: Path, column: str, time: FloatArray, rows: int) -> None:
    """Refuses recordings that are too short to analyse; `rows` counts them before equal stamps were merged.

    Raises:
        InputError: fewer than 20 samples, or less than 0.5 s.
    """
    if len(time) < MIN_SAMPLES <= rows:
        stamps = "all" if len(time) == 1 else f"only {len(time)} different times"
        same = f"all {rows} rows have the time {time[0]:.9g} s" if len(time) == 1 else f"{stamps} in {rows} rows"
        raise InputError(f"{place(path, column=column)}: {same}. Record the time of each reading, with enough digits.")
    if len(time) < MIN_SAMPLES:
        raise InputError(f"{path}: only {len(time)} samples; at least {MIN_SAMPLES} are needed. Record for longer.")
    duration = time[-1] - time[0]
    if duration < MIN_DURATION:
        raise InputError(
            f"{place(path, column=column)}: only {duration:.3g} s long; at least {MIN_DURATION} s are needed. "
            "Record for longer, or correct the unit in the column name."
        )


def bridge_angle(
    path: Path, column: str, time: FloatArray, angle: FloatArray, rows: IntArray
) -> tuple[FloatArray, list[DataFinding]]:
    """Fills short dropouts of the angle by linear interpolation.

    Raises:
        InputError: a dropout is too long or at an end of the recording; the message names its rows.
    """
    blank = np.isnan(angle)
    if not blank.any():
        return angle, []
    known = np.flatnonzero(~blank)
    if len(known) < 2:
        raise InputError(f"{place(path, column=column)}: contains no numbers. The beam angle must be recorded.")
    longest = max(MAX_DROPOUT, 2.5 * float(np.median(np.diff(time))))
    for run in np.split(np.flatnonzero(blank), np.flatnonzero(np.diff(np.flatnonzero(blank)) > 1) + 1):
        where = place(path, column=column)
        if run[0] < known[0] or run[-1] > known[-1]:
            end = "beginning" if run[0] < known[0] else "end"
            raise InputError(f"{where}: {rows_text(rows[run])} blank at the {end} of the recording. Delete these rows.")
        span = time[run[-1] + 1] - time[run[0] - 1]
        if span > longest:
            raise InputError(
                f"{where}: {rows_text(rows[run])} blank, the angle is unknown for {span:.3g} s; at most "
                f"{longest:.3g} s can be interpolated. Split the recording there."
            )
    text = f"{int(blank.sum())} blank angles filled by linear interpolation ({rows_text(rows[blank])})."
    finding = DataFinding("warning", place(path.name, column=column), text, "blank-angles")
    return np.interp(time, time[known], angle[known]), [finding]


def sampling_findings(path: Path, time: FloatArray, rows: IntArray) -> Iterator[DataFinding]:
    """A warning on gaps with their places, and a note on uneven sampling with its size."""
    steps = np.diff(time)
    median = float(np.median(steps))
    gaps = np.flatnonzero(steps > GAP * median)
    if len(gaps):
        places = abbreviated([f"{steps[i]:.3g} s after row {rows[i]} (t = {time[i]:.4g} s)" for i in gaps])
        text = f"samples are missing: {places}; the median step is {median:.3g} s. The beam angle in these gaps is "
        yield DataFinding("warning", path.name, text + "unknown; split the recording at long gaps.", "gaps")
    even = steps[steps <= GAP * median]
    if np.max(np.abs(even - median)) > MAX_JITTER * median:
        yield DataFinding(
            "note",
            path.name,
            f"sampling is uneven: median step {median:.4g} s, {np.min(even):.4g} to {np.max(even):.4g} s, standard "
            f"deviation {100 * np.std(even) / median:.2g} % of the median. The models run at these times.",
            "uneven-sampling",
        )
