"""Section with the replay of the recordings and of the engine's runs before and after tuning."""

from __future__ import annotations

import numpy as np

from harness.identify.problem.windows import KNOWN
from harness.report.page import Section
from harness.report.replay import Replay, Run, track
from harness.report.tuning.subject import Subject
from harness.report.tuning.trajectories import RECORDED, Shown, free_runs, held_out


def section(subject: Subject) -> Section:
    """The replay of every chart over time: held-out blocks first."""
    problem = subject.tuned.model.problem
    every = [*held_out(subject), free_runs(subject)]
    readings = np.concatenate([one.reading[np.isfinite(one.reading)] for one in problem.recordings])
    low, high = track(readings)
    replay = Replay("replay-tuning", problem.rig, low, high, RECORDED, [_run(one) for one in every])
    context = {"replay": replay, "measured": subject.measured, "engine": subject.engine, "known": f"{KNOWN:g}"}
    return Section("replay", "Replay", "Replay", "tuning/replay.html", context, on_screen=True)


def _run(shown: Shown) -> Run:
    drive = shown.recording.drive
    return Run(shown.title, shown.anchor, shown.clock, drive.time, drive.states[:, 0], shown.marks)
