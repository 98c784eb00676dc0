"""Rows made by hand, whose tables can be counted on fingers."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import pandas as pd

from benchmarks.calibration.page import FOLDER
from benchmarks.calibration.rows import Named, Row
from benchmarks.calibration.sizes import SIZES
from benchmarks.calibration.trials import Trial

SOURCE = "handmade0000"


def trial(study: str, name: str, number: int, *, size: str = "middle", plant: str = "virtual_rig") -> Trial:
    """A trial that hides effects, by names joined with " + ", each with one parameter of value 1."""
    hidden = {} if name == "none" else {each: {"p": 1.0} for each in name.split(" + ")}
    return Trial(
        study=study,
        name=name,
        factor=0.0 if name == "none" else SIZES[size],
        number=number,
        plant=plant,
        counts=40_000,
        noise=3e-4,
        spikes=0.0,
        hidden=hidden,
        unlisted={},
        declared={},
        seed=number,
    )


def named(name: str, value: float = 1.0, reach: float = 0.5, rivals: Iterable[str] = ()) -> Named:
    """An effect found with its one parameter at `value` ± `reach`."""
    return Named(name, {"p": (value, value - reach, value + reach)}, tuple(rivals))


def row(of: Trial, *found: Named, spline_term: str | None = None) -> Row:
    """What came of a trial."""
    verdict = "unlisted" if spline_term else "effect" if found else "none"
    return Row(trial=of, source=SOURCE, verdict=verdict, named=found, depends_on=spline_term, seconds=2.0)


def committed(docs: Path) -> dict[str, pd.DataFrame]:
    """The tables in `docs`, by name."""
    return {path.stem: pd.read_csv(path) for path in sorted((docs / FOLDER).glob("*.csv"))}
