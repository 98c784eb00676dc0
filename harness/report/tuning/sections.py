"""Sections of the report of `harness tune`."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from markupsafe import Markup
from matplotlib.figure import Figure

from harness.formatting import length, number
from harness.identify.problem.windows import AHEAD, KNOWN
from harness.numerics import rms
from harness.report.page import Section
from harness.report.plots import Picture
from harness.report.tables import Row, Table, texts
from harness.report.tuning import trajectories
from harness.report.tuning.subject import Subject
from harness.report.tuning.trajectories import free_runs, held_out
from harness.report.tuning.words import left_as, sentences
from harness.tuning.estimate.free import LEVEL
from harness.tuning.estimate.selection import KEEP, SEEN
from harness.tuning.tune import Tuned

TEMPLATE = "tuning/section.html"


@dataclass(frozen=True)
class Content:
    """What a section shows, in this order: sentences, texts, a list, pictures, tables, preformatted texts, notes."""

    answer: tuple[str, ...] = ()
    texts: tuple[str | Markup, ...] = ()
    pictures: tuple[Picture, ...] = ()
    tables: tuple[Table, ...] = ()
    items: tuple[str, ...] = ()
    code: tuple[str, ...] = ()
    notes: tuple[str, ...] = field(default=())


def answer(subject: Subject) -> Section:
    """The answer, the tuned values, and free runs before and after."""
    told = sentences(subject.tuned, subject.cam, str(subject.case.path))
    content = Content(answer=told, pictures=(_free_runs(subject),), tables=(values_table(subject.tuned),))
    return Section("answer", "Answer", "Answer", TEMPLATE, {"content": content})


def values_table(tuned: Tuned) -> Table:
    """Every fitted parameter with its default, value and interval; what does not pay is told so."""
    found = tuned.selection.found
    rows = []
    for name in found.names:
        one = tuned.model.free[name]
        low, high = found.interval(name)
        default = left_as(tuned, "engine's own") if one.default is None else number(one.default, 4)
        remark = "pays" if name in tuned.selection.pays else f"fitted along, {_why_not(tuned, name)}"
        if found.at_bound(name):
            remark = "at its bound: its interval says little"
        interval = f"{number(low, 4)} … {number(high, 4)}"
        rows.append((f"`{name}`", default, number(found.values[name], 4), interval, one.unit, remark))
    columns = [*texts("parameter"), "before", "value", "95 % interval", *texts("unit", "outcome")]
    return Table("Fitted parameters", columns, rows)


def _why_not(tuned: Tuned, name: str) -> str:
    rejected = tuned.rejected is not None and name in tuned.rejected.names
    return "predicts held-out blocks no better" if rejected else "does not pay"


def drawn(subject: Subject) -> Figure:
    """Free runs over the windows of the first recording before and after, against the readings."""
    return trajectories.drawn(subject, free_runs(subject))


def _free_runs(subject: Subject) -> Picture:
    shown = free_runs(subject)
    caption = (
        f"{shown.recording.name}: what {subject.engine} was fitted to. {_panels(subject)} The engine runs freely over "
        f"each window, from a start that is fitted as well: before tuning, with the level angle as given, and with the "
        "fitted parameters."
    )
    if subject.tuned.held_out is not None:
        caption += " What it predicts of readings that it was not fitted to is under “Errors on held-out readings”."
    return trajectories.picture(subject, shown, f"Free runs of {subject.engine} before and after tuning", caption)


def _panels(subject: Subject) -> str:
    """What both panels of a picture over time show, and in which units."""
    return (
        f"Above, position of the ball along the beam in m, {subject.measured} and as {subject.engine} has it; below, "
        f"the engine's minus the {subject.measured} position in mm."
    )


def _predictions(subject: Subject) -> tuple[Picture, ...]:
    """Predictions of held-out blocks, one picture a recording."""
    how = (
        f"The engine gets the positions of {KNOWN:g} s and predicts the next {AHEAD:g} s from the angle alone, with "
        "parameters fitted without the readings of the block. Of overlapping windows in a block the first is drawn."
    )
    return tuple(
        trajectories.picture(
            subject,
            one,
            f"Held-out blocks of {one.recording.name}, predicted before and after tuning",
            f"{one.recording.name}: predictions of held-out blocks. {_panels(subject)} {how}",
        )
        for one in held_out(subject)
    )


def errors(subject: Subject) -> Section | None:
    """Errors on held-out blocks beside CAM; `None` without any."""
    held, cam = subject.tuned.held_out, subject.cam
    if held is None:
        return None
    sources = {f"{subject.engine}, before": held.before, f"{subject.engine}, tuned": held.after}
    if cam is not None:
        blocks = list(held.blocks)
        names = ", ".join((*cam.effects, *(("an unlisted law",) if cam.unlisted else ()))) or "none found"
        sources |= {"CAM": cam.before[blocks], f"CAM with effects: {names}": cam.after[blocks]}
    best = min(sources, key=lambda name: rms(sources[name]))
    table = Table(
        "RMS errors on held-out blocks",
        [*texts("source"), "RMS error", "median of blocks"],
        [
            Row((name, length(rms(each)), length(float(np.median(each)))), "best" if name == best else "")
            for name, each in sources.items()
        ],
    )
    margin = held.margin
    sure = (
        ()
        if margin is None or not subject.tuned.selection.pays
        else (
            f"The RMS error falls by {length(margin.value)} (95 % interval {length(margin.low)} … "
            f"{length(margin.high)}, paired bootstrap over blocks; a negative fall would be a rise).",
        )
    )
    note = (
        f"{len(held.blocks)} held-out blocks of up to three windows, in each of which the first 2 s are known and "
        "the next 3 s are predicted from the angle. Parameters are fitted anew without the readings to be predicted. "
        "The engine's starts are fitted to the known part; CAM's come from its filter."
    )
    if held.left_out:
        note += f" {held.left_out} more blocks are left out, which {subject.engine} as it was does not run through."
    content = Content(texts=sure, pictures=_predictions(subject), tables=(table,), notes=(note,))
    return Section("errors", "Errors on held-out readings", "Errors", TEMPLATE, {"content": content})


def screening(subject: Subject) -> Section:
    """Which parameters the recordings tell at all, and what was tried in which order."""
    selection = subject.tuned.selection
    rows = []
    for name, one in selection.screened.items():
        verdict = (
            "tuned"
            if name in selection.pays
            else _why_not(subject.tuned, name)
            if one.seen
            else f"not seen: left {left_as(subject.tuned, 'at its default')}"
        )
        if one.failed:
            verdict += f"; {subject.engine} fails with {', '.join(f'{value:g}' for value in one.failed)}"
        tried = ", ".join(number(value, 3) for value in one.tried)
        rows.append((f"`{name}`", tried, number(one.sensitivity), verdict))
    columns = [*texts("parameter", "values tried"), "change of the runs [σ]", *texts("outcome")]
    tried_rows = [
        Row(
            (f"`{one.name}`", ", ".join(name for name in one.beside if name != LEVEL) or "none", number(one.deviance),
             number(one.bic), "kept" if one.kept else "not kept", one.why),
            "best" if one.kept else "",
        )
        for one in selection.attempts
    ]  # fmt: skip
    attempts = Table(
        "Fits that were compared",
        [
            *texts("parameter", "beside"),
            "decrease of the deviance",
            "decrease of the BIC",
            *texts("decision", "reason"),
        ],
        tried_rows,
    )
    note = (
        f"σ is the standard deviation that reading noise and angle error give the runs. A parameter is seen if one of "
        f"the values tried changes the free runs by more than {math.sqrt(SEEN):g} σ in all, after the windows' starts "
        "and the fitted parameters have made up for what they can. Those with the largest expected gain are fitted, "
        f"and the best one is kept – it “pays” – if it lowers the Bayesian information criterion (BIC) by more than "
        f"{KEEP:g}. The deviance is the sum of squares of the residuals in σ, in which large ones count less."
    )
    tables = (Table("Sensitivity of the free parameters", columns, rows), attempts)
    content = Content(tables=tables, notes=(note,))
    return Section("screening", "What was tried", "Screening", TEMPLATE, {"content": content})


def identifiability(subject: Subject) -> Section:
    """Correlations of the fitted parameters, and combinations that the recordings do not tell apart."""
    found = subject.tuned.selection.found
    rows = [
        (f"`{name}`", *(f"{value:+.2f}" for value in row))
        for name, row in zip(found.names, found.correlation, strict=True)
    ]
    table = Table("Correlation of the fitted parameters", [*texts("parameter"), *found.names], rows)
    combinations = subject.tuned.combinations
    text = (
        "These combinations are not identifiable from these recordings (collinearity index 10 or more):"
        if combinations
        else "No combination of the parameters that the recordings tell is undetermined (collinearity index below 10)."
    )
    content = Content(texts=(text,), items=tuple(one.text for one in combinations), tables=(table,))
    return Section("identifiability", "What cannot be told apart", "Identifiability", TEMPLATE, {"content": content})


def inputs(subject: Subject) -> Section:
    """Settings file, recordings, command."""
    tuned, problem = subject.tuned, subject.tuned.model.problem
    rows = [
        (one.name, number(float(one.time[-1] - one.time[0])), str(int(np.isfinite(one.reading).sum())))
        for one in problem.recordings
    ]
    table = Table("Recordings fitted to", [*texts("recording"), "length [s]", "positions"], rows)
    found = tuned.selection.found
    before, after = (number(math.sqrt(one.misfit)) for one in (tuned.selection.before, found))
    windows = "One window" if len(tuned.windows) == 1 else f"{len(tuned.windows)} windows"
    lasting = float(np.median([one.time[-1] - one.time[0] for one in tuned.windows]))
    scene = f"Scene of {subject.engine}: `{subject.scene_file}`, given in rig.toml. " if subject.scene_file else ""
    text = (
        f"{scene}{windows} of about {number(lasting, 2)} s. Noise of a position reading: "
        f"{length(math.sqrt(problem.reading_variance), 2)}. Root mean square of the residuals over what noise and "
        f"angle error explain: {before} before, {after} after."
    )
    code = tuple(one for one in (subject.settings, subject.command) if one)
    content = Content(texts=(text,), tables=(table,), code=code)
    return Section("inputs", "Inputs and settings file", "Inputs", TEMPLATE, {"content": content})
