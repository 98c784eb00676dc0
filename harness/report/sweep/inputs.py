"""Section: what was swept, and how to repeat it."""

from __future__ import annotations

from harness.engines.catalogue import ENGINES
from harness.formatting import listed
from harness.recording.findings import abbreviated
from harness.report.page import Section
from harness.report.palette import label_of
from harness.report.scenes import BUILT_IN, scenes_in_words
from harness.report.sweep.subject import Subject
from harness.report.tables import Table, texts
from harness.sweeps.factors import Factor
from harness.sweeps.spec import GRID, LATIN_HYPERCUBE, SOBOL, Spec

_MOST = 12
_DESIGNS = {
    GRID: "grid: every combination of the values",
    LATIN_HYPERCUBE: "Latin hypercube: values of the ranges drawn evenly, each range cut into as many parts as samples",
    SOBOL: "Sobol' sequence: values that fill the ranges evenly",
}


def section(subject: Subject) -> Section | None:
    """Factors, design, recordings, command."""
    spec, plan = subject.plan.spec, subject.plan
    names = [f"{spec.case_names[number]}: {name}" for number, name in plan.recordings]
    return Section(
        "inputs",
        "What was swept",
        "Inputs",
        "sweep/inputs.html",
        {
            "table": _factors(subject),
            "design": _design(spec),
            "scenes": _scenes(subject),
            "recordings": abbreviated(names, _MOST),
            "command": subject.command,
        },
    )


def _design(spec: Spec) -> str:
    """How values were combined, and from how many samples and which seed they were drawn."""
    drawn = "" if spec.design == GRID else f"; {spec.size} samples, seed {spec.seed}"
    return _DESIGNS[spec.design] + drawn


def _scenes(subject: Subject) -> list[str]:
    """Which scene each engine ran, a line a case; empty where all ran the built-in one."""
    spec, scenes = subject.plan.spec, subject.plan.scenes
    engines = [one for one in spec.sources if one in ENGINES]
    if not any(scenes_in_words(scene, engines) for scene in scenes):
        return []
    named = [(name, scenes_in_words(scene, engines)) for name, scene in zip(spec.case_names, scenes, strict=True)]
    every = f"{listed([label_of(one) for one in engines])}: {BUILT_IN}"
    return [f"{name}: {text or every}" for name, text in named]


def _factors(subject: Subject) -> Table:
    rows = []
    for source, factors in subject.plan.spec.factors.items():
        for one in factors:
            rows.append((label_of(source), f"`{one.name}`", _values(subject, one)))
    return Table("", texts("model or engine", "quantity", "values"), rows)


def _values(subject: Subject, factor: Factor) -> str:
    if factor.range is None:
        return ", ".join(subject.value(one) for one in factor.values)
    how = "logarithmic, " if factor.range.scale == "log" else ""
    levels = f", {factor.range.levels} levels" if factor.range.levels else ""
    return f"{subject.value(factor.range.low)} to {subject.value(factor.range.high)} ({how}sampled{levels})".replace(
        "sampled, ", ""
    )
