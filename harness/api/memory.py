"""The most memory that a command takes, told before it begins: its largest arrays, and what is always there.

Upper estimates, compared with measured peaks in docs/reliability.md (`python -m benchmarks.growth.memory`).
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from harness.comparison import Choices
    from harness.engines.parameters import EngineParameters
    from harness.engines.protocol import Engine
    from harness.recording import Recording
    from harness.sweeps.plan import Plan

_FLOAT = 8  # bytes
_MOTION = 3 * _FLOAT  # α, α̇, α̈
_BALL = 2 * _FLOAT  # s, ṡ
# Python, its packages, the compiled kernels and their compiler, which works where none are kept; a process that is
# forked or started beside it.
_COMMAND, _PROCESS = 6e8, 1e8
_STARTED = 3e8  # a process that is started fresh, as those of sweeps are
_ENGINE_STEP = 1000  # of an engine's run: its grid, path and samples (measured: MuJoCo 240, PyBullet 750)
# Of a diagnosis: parameters of a fit beside those of each recording (effects and nodes of a spline), and copies of a
# Jacobian in a least-squares step (differences, stacked columns, weighted, augmented, decomposed).
_PARAMETERS, _JACOBIANS = 30, 6
_DRAWN = 24  # beam motions drawn from the drive of every recording
_SMOOTHED = 60 * _FLOAT  # a reading: states, covariances and transitions of drive and ball
_TABLES = 4  # of beam motions, kept for rivals with lags of their own
_TABLE_STEP = 2.5e-3  # of the compiled kernel [s]
_COMBINATIONS = 40  # of model terms in the ablation of a comparison
_TUNED_DRAWS = 256  # of the angle's error in each recording, as states and as errors


def _table(duration: float, stamps: int) -> float:
    """Size of the beam's motion at the start, middle and end of every step of the kernel."""
    return 2.0 * (duration / _TABLE_STEP + stamps) * _MOTION


def _duration(recording: Recording) -> float:
    return float(recording.time[-1] - recording.time[0])


def diagnosis_memory(recordings: Sequence[Recording]) -> float:
    """The most memory that a diagnosis of these recordings takes [bytes].

    Threads, one on each core, fit rivals at the same time: each holds Jacobians of shape (readings, parameters), with a
    parameter for each recording where the rival has one.
    """
    from harness.recording.fast_sensor import neighbours_in_mean

    cores = os.cpu_count() or 1
    parameters = _PARAMETERS + len(recordings)
    total = _COMMAND + cores * _PROCESS
    for one in recordings:
        stamps = len(one.time)
        used = stamps // neighbours_in_mean(one)
        total += used * cores * _JACOBIANS * parameters * _FLOAT + stamps * (_DRAWN * _MOTION + _SMOOTHED)
        total += _TABLES * _table(_duration(one), used)
    return total


def comparison_memory(
    recording: Recording, engines: Sequence[tuple[Engine, EngineParameters]], choices: Choices
) -> float:
    """The most memory that a comparison on a recording takes [bytes]; it grows with the recording's length.

    Args:
        recording: to compare.
        engines: that run, with their settings.
        choices: of which the windows and the number of draws are of interest.
    """
    from analytic.models import MODELS

    duration, stamps = _duration(recording), len(recording.time)
    horizons = 1 + len(set(choices.lengths))  # each with a stamp of nearly every run
    runs = horizons * stamps * ((len(MODELS) + len(engines)) * _BALL + _FLOAT)  # and u_val
    ablation = _COMBINATIONS * stamps * _FLOAT
    drawn = choices.draws * (stamps * _MOTION + _table(duration, stamps) + (horizons + 2) * stamps * _FLOAT)
    steps = max((2.0 * duration / one.time_step for _, one in engines), default=0.0)  # half the step tells its error
    return _COMMAND + runs + ablation + drawn + steps * _ENGINE_STEP


def tuning_memory(recordings: Sequence[Recording], time_step: float, jobs: int) -> float:
    """The most memory that tuning takes [bytes].

    Args:
        recordings: to fit to; effects are searched for in them, too.
        time_step: of the engine [s].
        jobs: processes that run it.
    """
    from harness.tuning.estimate.windows import LENGTH

    # A recording of half as much again is one window.
    runs = max(jobs, 1) * 1.5 * LENGTH / time_step * _ENGINE_STEP
    drawn = _TUNED_DRAWS * max(len(one.time) for one in recordings) * (_MOTION + 3 * _FLOAT)
    return diagnosis_memory(recordings) + runs + drawn


def sweep_memory(plan: Plan, processes: int) -> float:
    """The most memory that the processes of a sweep on one machine take [bytes].

    Args:
        plan: of the sweep.
        processes: that run at the same time, each of them one run.
    """
    from harness.sweeps.carry_out import most_steps

    return _COMMAND + processes * (_STARTED + most_steps(plan) * _ENGINE_STEP)
