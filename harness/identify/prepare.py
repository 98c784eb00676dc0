"""From a case to a problem: drives read, rig completed, spikes set aside, noise measured."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from analytic.rig import Rig
from harness.compare import Choices, Setting
from harness.compare import prepare as settle
from harness.compare.setting import ball_of, drive_of
from harness.errors import InputError
from harness.identify.problem import Problem, Record
from harness.recording import Case, Recording

_FEWEST = 20  # readings that a recording must hold to say anything


def problem_of(case: Case, names: Sequence[str] | None = None) -> tuple[Problem, Setting]:
    """The problem that the recordings `names` pose (by default those to identify from), and the setting of the first.

    Raises:
        InputError: no recording has positions enough.
    """
    names = [name for name in (names or case.identify) if int(case.recordings[name].known.sum()) >= _FEWEST]
    if not names:
        raise InputError(f"{case.path}: no recording to identify from has {_FEWEST} known positions or more")
    setting = settle(case, Choices(recording=names[0]))
    records, variances = [], []
    for name in names:
        record, noise = record_of(case, case.recordings[name], setting.rig)
        records.append(record)
        variances.append(noise**2)
    return Problem(tuple(records), setting.rig, setting.acting, float(np.mean(variances))), setting


def record_of(case: Case, recording: Recording, rig: Rig) -> tuple[Record, float]:
    """One recording with its drive, spikes set aside, and the standard deviation of its readings [m]."""
    drive = drive_of(case, recording)
    ball = ball_of(case, recording, drive, rig)
    rounding = (case.sensors.position_resolution or 0.0) / np.sqrt(12.0)
    reading = np.where(ball.trusted, recording.position, np.nan)
    return Record(recording.name, np.array(recording.time), reading, drive), float(np.hypot(ball.noise, rounding))
