"""The page on one measured rig: what is known, what was found, held-out errors against all baselines, what remains."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from analytic.effects import CATALOGUE
from harness.api.case import Case
from harness.api.saved import LoadedDiagnosis
from harness.formatting import NONE, brief, listed, measured, number
from harness.identify.record import BaselinesRecord, EffectRecord
from harness.identify.validation.baseline_comparison import AFTER, BASELINES, BEFORE, FORECASTS
from harness.recording.case import RIG_FILE
from harness.recording.known_rig import UNITS
from harness.report.diagnosis.baselines import short_title
from harness.report.wording import words

LABELS = {name: short_title(name) for name in BASELINES} | {
    BEFORE: "model with what is known",
    AFTER: "model with the effects found",
    FORECASTS: "model with parameters fitted to forecasts",
}
_TOO_SHORT = "The recordings are too short to hold blocks out."


@dataclass(frozen=True)
class Rig:
    """A measured rig and its diagnosis."""

    case: Case
    diagnosis: LoadedDiagnosis

    @property
    def compared(self) -> BaselinesRecord | None:
        """Held-out errors; `None` if the recordings are too short."""
        return self.diagnosis.record.baselines

    @property
    def length(self) -> float:
        """Of all recordings to identify from [s]."""
        spans = (self.case.recordings[name].time for name in self.case.identify)
        return float(sum(time[-1] - time[0] for time in spans))

    def error(self, source: str) -> float:
        """RMS error over all held-out blocks [m]; NaN if there are none."""
        value = None if self.compared is None else self.compared.rms_m.get(source)
        return math.nan if value is None else value

    @property
    def predicting(self) -> str:
        """The source with which predictions are made."""
        return AFTER if self.compared is None else self.compared.predicting

    def best(self, among: Iterable[str]) -> str:
        """The source of least held-out error."""
        return min(among, key=self.error)

    def ratio(self, among: Iterable[str]) -> float:
        """Held-out error of the model that predicts over that of the best of other sources [1]."""
        return self.error(self.predicting) / self.error(self.best(among))


def table(heads: Sequence[str], rows: Iterable[Sequence[str]], left: int = 1) -> str:
    """A table in Markdown, of which the first columns are texts."""
    rule = ["---"] * left + ["---:"] * (len(heads) - left)
    return "\n".join(f"| {' | '.join(cells)} |" for cells in (heads, rule, *rows))


def millimetres(value: float | None) -> str:
    """A length in mm."""
    return NONE if value is None or not math.isfinite(value) else number(1e3 * value)


def page(rig: Rig, pictures: Sequence[tuple[Path, str]] = ()) -> str:
    """The page in Markdown.

    Args:
        pictures: files beside the page, and what they show.
    """
    shown = [f"![{caption[0].upper()}{caption[1:]}]({path.name})" for path, caption in pictures]
    parts = [
        f"# {rig.case.name}",
        "Measured. Written by `make measured` from the diagnosis of the recordings; [all rigs](../measured_rigs.md).",
        "## What is known",
        *_known(rig),
        "## What was found",
        rig.diagnosis.sentence,
        f"Verdict `{rig.diagnosis.verdict}`.",
        *_effects(rig),
        "## Held-out errors",
        *_errors(rig),
        *shown,
        "## What remains",
        *_remains(rig),
    ]
    return "\n\n".join(parts) + "\n"


def _known(rig: Rig) -> list[str]:
    """The comments of the rig file, the known quantities, and the unknown ones."""
    case = rig.case
    file = case.path if case.path.is_file() else case.path / RIG_FILE
    lines = file.read_text(encoding="utf-8").splitlines()
    head = [line.lstrip("# ") for line in lines[: next((i for i, line in enumerate(lines) if line[:1] != "#"), 0)]]
    quantities = {**vars(case.rig), **vars(case.sensors)}
    rows = [(words(key), f"{number(value, 4)} {UNITS[key]}") for key, value in quantities.items() if value is not None]
    unknown = [words(key) for key, value in quantities.items() if value is None]
    count = len(case.identify)
    said = [" ".join(f"> {line}\n" for line in head).replace("\n ", "\n").strip()] if head else []
    said.append(f"{count} recording{'s' if count > 1 else ''}, {number(rig.length)} s in all.")
    if rows:
        said.append(table(("quantity", "value"), rows, left=2))
    if unknown:
        said.append(f"Not known: {listed(unknown)}.")
    return said


def _effects(rig: Rig) -> list[str]:
    rows = [row for effect in rig.diagnosis.effects.values() for row in _rows(effect)]
    spline = rig.diagnosis.unlisted
    said = []
    if rows:
        heads = ("effect", "law", "parameter", "value, 95 % interval", "indistinguishable from")
        said.append(table(heads, rows, left=len(heads)))
    if spline is not None:
        shape = spline.shape
        what = "A friction" if shape.friction else "An error of the position sensor" if shape.sensor else "A force"
        said.append(f"{what} that no effect of the catalogue explains depends on {listed(spline.depends_on)}.")
    return said or ["No effect was found."]


def _rows(effect: EffectRecord) -> list[tuple[str, ...]]:
    rivals = ", ".join(f"`{name}`" for name in effect.indistinguishable_from) or NONE
    law = CATALOGUE[effect.name].law.replace("|", "\\|")
    rows: list[tuple[str, ...]] = []
    for i, (name, one) in enumerate(effect.parameters.items()):
        unit = "" if one.unit == "1" else f" {one.unit}"
        size = number(one.value)
        if one.low is not None and one.high is not None:
            size = measured(one.value, 0.5 * (one.high - one.low))
        note = " (implausible)" if name in effect.implausible else ""
        head = (f"`{effect.name}`", law) if i == 0 else ("", "")
        rows.append((*head, f"`{name}`", f"{size}{unit}{note}", rivals if i == 0 else ""))
    return rows


_OTHER = (
    "The error that the sentence above quotes is held out in another way: each recording or group of recordings, or "
    "each half of a single one, in turn, with parameters fitted by likelihood to the rest, and every span predicted "
    "from all readings before it."
)


def _errors(rig: Rig) -> list[str]:
    compared = rig.compared
    if compared is None:
        return [_TOO_SHORT]
    rows = []
    for source in (one for one in (BEFORE, AFTER, FORECASTS, *BASELINES) if one in compared.errors_m):
        median = float(np.median([math.nan if error is None else error for error in compared.errors_m[source]]))
        margin = compared.better_by_m.get(source)
        gain = NONE if margin is None else f"{millimetres(margin.low)} … {millimetres(margin.high)}"
        won = f"{compared.blocks_won[source]} of {compared.blocks}" if source in compared.blocks_won else NONE
        rows.append((LABELS[source], millimetres(compared.rms_m[source]), millimetres(median), gain, won))
    heads = (
        "source", "RMS [mm]", "median of blocks [mm]", "reduction by the model [mm], 95 %", "blocks predicted better"
    )  # fmt: skip
    said = (
        f"{compared.blocks} blocks, held out in groups; {brief(compared.ahead_s)} s are predicted from the angle and "
        f"the positions of the {brief(compared.known_s)} s before. Every source is fitted to the same windows, none "
        "of which has a predicted reading. The output-error models are black boxes fitted to the forecast: in closed "
        "loop they may read the controller backwards."
    )
    fitted = []
    if FORECASTS in compared.errors_m:
        used = "use them" if compared.predicting == FORECASTS else "do not use them, as they predict no better"
        fitted = [
            "Parameters fitted to forecasts are those with which the filter predicts the windows best: of the effects "
            "found, or, where none was, of such as are common on measured rigs. They are for predictions alone; the "
            f"predictions of this rig {used}."
        ]
    return [table(heads, rows), said, *fitted, _OTHER]


def _remains(rig: Rig) -> list[str]:
    record = rig.diagnosis.record
    noise = math.sqrt(record.problem.reading_variance_m2)
    points = []
    if rig.compared is not None:
        left = rig.error(rig.predicting)
        points.append(
            f"The error of {millimetres(left)} mm over {brief(rig.compared.ahead_s)} s is {number(left / noise, 2)} "
            f"times the deviation of a reading, {millimetres(noise)} mm: that much is not explained."
        )
        margins = rig.compared.better_by_m
        unsure = [LABELS[name] for name in BASELINES if (one := margins.get(name)) is None or not one.sure]
        if unsure:
            points.append(f"Not surely better than: {listed(unsure)}.")
    implausible = [words(one.name) for one in record.effects if one.implausible]
    if implausible:
        points.append(f"Implausibly sized, so that it may stand for something else: {listed(implausible)}.")
    rivals = [words(one.name) for one in record.effects if one.indistinguishable_from]
    if rivals:
        points.append(f"Not told from its rivals: {listed(rivals)}.")
    if record.hidden_by_unknown_rig:
        hidden = listed([words(name) for name in record.hidden_by_unknown_rig])
        points.append(f"Hidden by what the rig file leaves open: {hidden}.")
    engines = sorted({failure.name.split(" on ")[0] for failure in record.failures if failure.part == "engine"})
    if engines:
        points.append(f"Engines that fail in free runs, as where the ball leaves their rails: {listed(engines)}.")
    others = sorted({failure.part for failure in record.failures if failure.part != "engine"})
    if others:
        points.append(f"Parts that failed: {listed(others)}.")
    if record.next_experiment is not None:
        points.append(f"Next experiment: {words(record.next_experiment.sentence)}")
    return ["\n".join(f"- {point}" for point in points)]
