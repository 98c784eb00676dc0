"""`python -m benchmarks.sensitivity`: what changes on blind trials when one setting of the search is halved or doubled.

Writes `docs/settings.md`: every setting with its meaning, its reason, and how many of the trials get another result.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import click

from benchmarks.calibration.bar import run_with_bar
from benchmarks.calibration.rows import Row
from benchmarks.calibration.store import Store, sources_digest
from benchmarks.calibration.trials import Trial, plan
from harness.identify.problem.settings import DEFAULT, Settings

_DOC, _ROWS = Path("docs/settings.md"), Path("build/calibration/sensitivity.jsonl")
_NEAR = "6 standard errors"
# Where settings can matter: nothing hidden, sizes near the detection limit, pairs, a cause that no catalogue lists.
_CHOSEN = (
    ("null", "none", "0", 2),
    ("power", "rolling_resistance", _NEAR, 1),
    ("power", "channel_delay", _NEAR, 1),
    ("confusion", "track_curvature + viscous_damping", "middle", 1),
    ("confusion", "cubic_drag", "middle", 1),
)
FACTORS = (0.5, 2.0)


def chosen() -> tuple[Trial, ...]:
    """Trials of the plan of the blind trials, the first ones of each kind."""
    picked: list[Trial] = []
    for study, name, size, count in _CHOSEN:
        found = plan((study,), count=count, seeds=count, only=[name])
        picked += [one for one in found if one.size == size][:count]
    return tuple(picked)


def changed(trial: Trial) -> list[Trial]:
    """The same trial with each setting halved and doubled; one that stays as it is, being whole, is left out."""
    trials = [replace(trial, setting=name, scale=factor) for name, *_ in Settings.described() for factor in FACTORS]
    return [one for one in trials if one.settings != DEFAULT]


def answer(row: Row) -> str:
    """Verdict, names and the regressor of a spline term."""
    return " + ".join([row.verdict, *(one.name for one in row.named), *filter(None, [row.depends_on])])


def page(trials: Sequence[Trial], rows: Mapping[str, Row]) -> str:
    """`docs/settings.md`.

    Args:
        trials: at the default settings.
        rows: by `Trial.spec`, of these and of those that `changed` gives.
    """
    lines = [
        "# Settings of the identification",
        "",
        "`harness.identify.problem.settings.Settings` holds every number that decides how effects are found. Each row",
        "gives its meaning, its reason, and in how many of the simulated rigs below the verdict, a name or the",
        "regressor of a spline term changes when it is halved or doubled (`make sensitivity`). These few trials show",
        "what is delicate; they prove of no setting that it is not.",
        "",
        "| setting | default | meaning | reason | × 0.5 | × 2 |",
        "|---|---|---|---|---|---|",
    ]
    for name, default, meaning, reason in Settings.described():
        cells = " | ".join(_others(trials, rows, name, factor) for factor in FACTORS)
        lines.append(f"| `{name}` | {default:g} | {meaning} | {reason} | {cells} |")
    lines += ["", "The trials, with the result at the default settings:", ""]
    for one in trials:
        what = f"{one.name}, {one.size}" if one.factor else "no effect"
        lines.append(f"- {what}, on {one.plant}, {one.counts} counts per turn: {answer(rows[one.spec])}")
    return "\n".join(lines) + "\n"


def _others(trials: Sequence[Trial], rows: Mapping[str, Row], name: str, factor: float) -> str:
    """How many trials end otherwise with this setting scaled by `factor`."""
    scaled = [replace(one, setting=name, scale=factor) for one in trials]
    if scaled[0].settings == DEFAULT:
        return "the same"
    pairs = zip(scaled, trials, strict=True)
    return f"{sum(answer(rows[one.spec]) != answer(rows[default.spec]) for one, default in pairs)} of {len(trials)}"


@click.command(context_settings={"max_content_width": 100})
@click.option("--jobs", default=os.cpu_count() or 1, show_default=True, help="Trials side by side.")
@click.option("--rows", default=_ROWS, show_default=True, type=click.Path(path_type=Path), help="Kept rows.")
@click.option("--out", default=_DOC, show_default=True, type=click.Path(path_type=Path), help="Page to write.")
def main(jobs: int, rows: Path, out: Path) -> None:
    """Halve and double every setting of the search on a few blind trials, and tabulate what changes.

    Rows are kept; a run that was stopped goes on where it was, and a changed search begins anew.
    """
    trials, store = chosen(), Store(rows, sources_digest())
    run_with_bar([*trials, *(each for one in trials for each in changed(one))], store, jobs=jobs)
    made = store.rows()
    failed = [row for row in made.values() if row.error is not None]
    if failed:  # counted as another result, a failure would pass for sensitivity
        first = failed[0]
        raise click.ClickException(
            f"{len(failed)} of {len(made)} trials failed, first {first.trial.name} with {first.trial.setting or 'no'} "
            f"setting changed: {first.error}; run it again when that is mended"
        )
    out.write_text(page(trials, made), encoding="utf-8")
    click.echo(out)


if __name__ == "__main__":
    main()
