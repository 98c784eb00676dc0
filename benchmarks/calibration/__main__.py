"""`python -m benchmarks.calibration`: run the trials that are missing, then write the tables of all there are."""

from __future__ import annotations

import os
from pathlib import Path

import click

from benchmarks.calibration.bar import run_with_bar
from benchmarks.calibration.publish import publish
from benchmarks.calibration.store import Store, sources_digest
from benchmarks.calibration.trials import NULL_TRIALS, SEEDS, STUDIES, plan
from harness.errors import InputError

_ROWS = Path("build/calibration/rows.jsonl")


@click.command(context_settings={"max_content_width": 100})
@click.option("--study", "studies", type=click.Choice(STUDIES), multiple=True, help="This study; default: all of them.")
@click.option("--count", default=NULL_TRIALS, show_default=True, help="Effect-free trials.")
@click.option("--seeds", default=SEEDS, show_default=True, help="Trials of each effect and size.")
@click.option("--only-effect", "only", multiple=True, help='Trials that hide this alone; pairs as "a + b".')
@click.option("--jobs", default=os.cpu_count() or 1, show_default=True, help="Trials side by side.")
@click.option("--on", default="", metavar="dask://HOST:PORT", help="Run them on this Dask cluster instead.")
@click.option("--rows", default=_ROWS, show_default=True, type=click.Path(path_type=Path), help="Kept rows.")
@click.option(
    "--source",
    "sources",
    multiple=True,
    help="Take rows of this digest of the sources for current; default: the digest of what is. Of several, the first "
    "is that of new rows, and of two rows of one trial its own counts.",
)
@click.option("--tables-only", is_flag=True, help="Write tables of the rows there are.")
@click.option(
    "--docs", default=Path("docs"), show_default=True, type=click.Path(path_type=Path), help="Tables go here."
)
def main(
    studies: tuple[str, ...],
    count: int,
    seeds: int,
    only: tuple[str, ...],
    jobs: int,
    on: str,
    rows: Path,
    sources: tuple[str, ...],
    tables_only: bool,
    docs: Path,
) -> None:
    """Diagnose simulated rigs whose truth is known, blind, and tabulate how often that is right.

    Rows are kept; a run that was stopped goes on where it was, and a changed search begins anew.

    Example: python -m benchmarks.calibration --study null --count 20 --jobs 2
    """
    stores = [Store(rows, one) for one in sources or (sources_digest(),)]
    store = stores[0]
    try:
        trials = plan(studies or STUDIES, count=count, seeds=seeds, only=only)
    except InputError as error:
        raise click.UsageError(str(error)) from error
    if not tables_only:
        run_with_bar(trials, store, jobs=jobs, on=on)
    found = list({spec: row for one in reversed(stores) for spec, row in one.rows().items()}.values())
    named = ", ".join(one.source for one in stores)
    if not found:
        kept = ", ".join(f"{name} ({n})" for name, n in store.sources().most_common()) or "none"
        raise click.UsageError(f"{rows}: no rows of sources {named}; there are: {kept}. Choose with --source")
    for path in publish(found, docs, named):
        click.echo(path)
    failed = [row for row in found if row.error is not None]
    for row in failed:
        click.echo(f"failed: {row.trial.name}, number {row.trial.number}: {row.error}", err=True)
    if failed:
        raise SystemExit(1)


if __name__ == "__main__":
    main()
