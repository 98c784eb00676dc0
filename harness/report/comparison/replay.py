"""Section with the replay of the recording and all sources on the tilting beam."""

from harness.comparison.horizons import Horizon
from harness.report.chart import Mark
from harness.report.comparison.overlay import CLOCK, MEASURED, anchor, marks
from harness.report.comparison.subject import Subject
from harness.report.page import Section
from harness.report.replay import Replay, Run, track


def section(subject: Subject) -> Section:
    """The replay, of the headline horizon and of the whole free run."""
    setting = subject.study.setting
    headline, whole = subject.study.headline, subject.whole
    runs = [_run(subject, one) for one in ([headline] if headline is whole else [headline, whole])]
    low, high = track(setting.recording.position[setting.ball.trusted])
    replay = Replay("replay-recording", setting.rig, low, high, MEASURED, runs)
    context = {"replay": replay, "measured": subject.measured, "windows": subject.study.headline.seconds is not None}
    return Section("replay", "Replay", "Replay", "comparison/replay.html", context, on_screen=True)


def _run(subject: Subject, horizon: Horizon) -> Run:
    drive = subject.study.setting.drive
    title = "whole recording" if horizon.seconds is None else f"windows of {horizon.seconds:g} s"
    return Run(title, anchor(horizon), CLOCK, drive.time, drive.states[:, 0], _marks(subject, horizon))


def _marks(subject: Subject, horizon: Horizon) -> list[Mark]:
    """Failures, readings that are left out of all fits, and where windows begin."""
    time, left_out = subject.study.setting.time, subject.study.setting.recording.left_out
    begins = [float(time[at]) for at in horizon.first] if horizon.seconds is not None else []
    windows = [Mark("window", "all sources restart from the estimated state", at, at) for at in begins]
    readings = [Mark("left_out", "reading left out of all fits", float(at), float(at)) for at in left_out[:, 0]]
    return sorted([*marks(subject, horizon), *windows, *readings], key=lambda one: one.begin)
