"""Section with the replay of one recording and its predictions without and with the effects found."""

import numpy as np

from harness.identify.problem.windows import AHEAD, KNOWN, blocks_of
from harness.report.chart import Mark
from harness.report.diagnosis.account import Account
from harness.report.diagnosis.verdict import CHART, clock_of, marks
from harness.report.page import Section
from harness.report.replay import Replay, Run, track


def section(account: Account) -> Section:
    """The replay of the recording that the first figure shows."""
    shown = account.shown
    low, high = track(shown.reading[np.isfinite(shown.reading)])
    every = [*marks(account), *_held_out(account), *_left_out(account)]
    run = Run(shown.name, CHART, clock_of(shown), shown.time, shown.drive.evaluate(shown.time), every)
    replay = Replay("replay-prediction", account.diagnosis.problem.rig, low, high, "recorded", [run])
    context = {
        "replay": replay,
        "measured": "recorded (simulated)" if account.case.simulated else "recorded",
        "name": shown.name,
        "changed": account.changed,
    }
    return Section("replay", "Replay", "Replay", "diagnosis/replay.html", context, on_screen=True)


def _held_out(account: Account) -> list[Mark]:
    """Predicted parts of the blocks of the shown recording that are held out in turn for the baselines."""
    if account.diagnosis.baselines is None:
        return []
    held = [one.held_out for one in blocks_of(account.diagnosis.problem.recordings)]
    here = [windows for windows in held if windows[0].recording is account.shown]
    text = "block predicted while it is held out, for the comparison with baselines"
    return [Mark("heldout", text, each[0].begin + KNOWN, each[-1].begin + KNOWN + AHEAD) for each in here]


def _left_out(account: Account) -> list[Mark]:
    times = account.left_out(account.shown)[:, 0]
    return [Mark("left_out", "reading left out of all fits", float(at), float(at)) for at in times]
