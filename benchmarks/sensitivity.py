"""`python -m benchmarks.sensitivity`: what changes on blind trials when one setting of the search is halved or doubled.

Writes `docs/settings.md`: every setting with its meaning, its reason, and how many of the trials get another verdict.
"""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from pathlib import Path

import click

from benchmarks.calibration.pose import pose
from benchmarks.calibration.trials import Trial, plan
from harness.identify.problem.problem import Problem
from harness.identify.problem.settings import DEFAULT, Settings
from harness.identify.verdict import identify

DOC = Path("docs/settings.md")
# Where settings can matter: nothing hidden, sizes near the detection limit, pairs, a cause that no catalogue lists.
_TRIALS = (("null", "none", 2), ("power", "rolling_resistance", 1), ("power", "channel_delay", 1))
_OTHERS = ("track_curvature + viscous_damping", "rough_patch")
_NEAR = 0.03  # of the middle size: near the detection limit
FACTORS = (0.5, 2.0)


def chosen() -> tuple[Trial, ...]:
    """Trials of the plan of the blind trials, the first ones of each kind."""
    picked: list[Trial] = []
    for study, name, count in _TRIALS:
        found = plan((study,), count=count, seeds=count, only=[name])
        picked += [one for one in found if one.factor in (0.0, _NEAR)][:count]
    for name in _OTHERS:
        picked += plan(("confusion",), seeds=1, only=[name])[:1]
    return tuple(picked)


def problem_of(trial: Trial) -> Problem:
    """The problem that a trial poses."""
    with tempfile.TemporaryDirectory(prefix="sensitivity-") as folder:
        return pose(trial, Path(folder) / "case")


def answer(problem: Problem, settings: Settings) -> str:
    """Verdict and names with these settings."""
    found = identify(replace(problem, settings=settings))
    return " + ".join([str(found.verdict), *(one.name for one in found.effects), *map(str, found.depends_on)])


def changed(name: str, factor: float) -> Settings:
    """The settings with one field multiplied; whole numbers stay whole and at least one."""
    value = getattr(DEFAULT, name) * factor
    return replace(DEFAULT, **{name: max(1, round(value)) if isinstance(getattr(DEFAULT, name), int) else value})


def _study(trial: Trial) -> list[tuple[str, str]]:
    """The default answer, and that of each changed setting, (field and factor, answer)."""
    problem = problem_of(trial)
    rows = [("", answer(problem, DEFAULT))]
    for name, *_ in Settings.described():
        for factor in FACTORS:
            settings = changed(name, factor)
            rows.append((f"{name} {factor:g}", rows[0][1] if settings == DEFAULT else answer(problem, settings)))
    return rows


def page(trials: Sequence[Trial], studies: Sequence[Sequence[tuple[str, str]]]) -> str:
    """`docs/settings.md`."""
    answers = [dict(one) for one in studies]
    lines = [
        "# Settings of the identification",
        "",
        "`harness.identify.problem.settings.Settings` holds every number that decides how effects are found. Each row",
        "gives its meaning, its reason, and in how many of the trials below the verdict or a name changes when it is",
        "halved or doubled (`make sensitivity`; simulated rigs). A field without changes is not delicate here.",
        "",
        "| setting | default | meaning | reason | × 0.5 | × 2 |",
        "|---|---|---|---|---|---|",
    ]
    for name, default, meaning, reason in Settings.described():
        cells = [sum(one[f"{name} {factor:g}"] != one[""] for one in answers) for factor in FACTORS]
        lines.append(
            f"| `{name}` | {default:g} | {meaning} | {reason} | {' | '.join(f'{c} of {len(answers)}' for c in cells)} |"
        )
    lines += ["", "Trials, with the answer at the default settings:", ""]
    for trial, one in zip(trials, answers, strict=True):
        lines.append(f"- {trial.study}, {trial.name}, size {trial.size}, {trial.plant}, {trial.encoder}: {one['']}")
    return "\n".join(lines) + "\n"


@click.command()
@click.option("--jobs", default=1, show_default=True, help="Trials side by side.")
@click.option("--out", default=DOC, show_default=True, type=click.Path(path_type=Path), help="Page to write.")
def main(jobs: int, out: Path) -> None:
    """Halve and double every setting of the search on a few blind trials, and tabulate what changes."""
    trials = chosen()
    with ProcessPoolExecutor(jobs) as pool:
        studies = list(pool.map(_study, trials))
    out.write_text(page(trials, studies), encoding="utf-8")
    click.echo(out)


if __name__ == "__main__":
    main()
