"""Report of a sweep: best fit, which parameter matters, error against time, failures; one module per concept."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path

from harness.failures import Failures
from harness.formatting import length
from harness.report.page import Badge, Section, bodies_of, render_page
from harness.report.palette import label_of
from harness.report.sweep import best, failures, indices, inputs, runs, work_precision
from harness.report.sweep.subject import Subject
from harness.report.tables import Summary, Table
from harness.sweeps.drawn_runs import drawn_runs
from harness.sweeps.plan import Plan
from harness.sweeps.results import Results

SAME = 0.01
"""Relative difference of errors below which no value is said to be better than another."""

SECTIONS: Mapping[str, Callable[[Subject], Section | None]] = {
    "best_fit": best.section,
    "indices": indices.section,
    "work_precision": work_precision.section,
    "runs": runs.section,
    "failures": failures.section,
    "inputs": inputs.section,
}
"""In the order of the page; a section that does not apply returns `None`."""


def render_sweep(
    plan: Plan, results: Results, rows: Path, *, command: str = "", failures: Failures | None = None
) -> str:
    """The report as HTML text.

    Args:
        plan: of the sweep.
        results: of its rows.
        rows: their file, `runs.parquet`.
        command: that repeats it.
        failures: collects sections that raise, which then say so; `None` lets them raise.
    """
    subject = Subject(plan, results, command, *drawn_runs(plan, results, rows))
    bodies = bodies_of({name: partial(section, subject) for name, section in SECTIONS.items()}, failures)
    return render_page(
        f"Sweep: {plan.spec.path.stem}",
        bodies,
        subtitle=subject.subtitle,
        badges=_badges(subject),
        failures=() if failures is None else failures.all,
    )


def _badges(subject: Subject) -> list[Badge]:
    badges = []
    if any(subject.plan.simulated):
        every = all(subject.plan.simulated)
        badges.append(Badge("simulated data" if every else "some data are simulated", "warning"))
    if subject.results.failed:
        badges.append(Badge(f"{subject.results.failed} runs failed", "bad"))
    return badges


def summary_of(plan: Plan, results: Results) -> Summary:
    """A sweep in short."""
    subject = Subject(plan, results, "")
    lines = [subject.subtitle, *(_best_line(subject, one.source) for one in results.best)]
    lines += indices.without(subject)
    tables: list[Table | None] = [
        work_precision.table(results),
        *indices.tables(subject),
        failures.table(results) if results.failures else None,
    ]
    return Summary(f"Sweep {plan.spec.path}", lines, [one for one in tables if one is not None and one.rows])


def _best_line(subject: Subject, source: str) -> str:
    one = next(best for best in subject.results.best if best.source == source)
    values = ", ".join(f"{name} = {subject.value(value)}" for name, value in one.values.items())
    name, what = label_of(source), f"RMS error against the {subject.measured} positions"
    if not values:
        return f"{name}: {what} {length(one.error)}"
    if one.largest < (1.0 + SAME) * one.error:
        return f"{name}: {what} {length(one.error)} whatever the values: none of them matters"
    return f"{name}: {what} {length(one.error)} at best, with {values}; {length(one.largest)} at worst"
