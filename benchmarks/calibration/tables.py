"""Tables of the blind trials: false positives, recovery, confusion, power, coverage; rates with Wilson intervals."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence

import numpy as np
import pandas as pd

from benchmarks.calibration.imperfect_tables import imperfect_tables
from benchmarks.calibration.rows import Outcome, Row
from benchmarks.calibration.sizes import PAIRS, POWER, SCALES, SIZES, UNLISTED_SCALES
from benchmarks.calibration.statistics import ALL, covered, outcomes, rate

ELSEWHERE = ("several", "spline term", "nothing")
"""Columns of the confusion matrix after those of the effects."""


def tables(rows: Sequence[Row]) -> dict[str, pd.DataFrame]:
    """Every table by the name of its file; empty tables are left out."""
    # Where chance decides whether an effect is found, estimates of those that are found are too large.
    clean = [row for row in rows if not row.trial.imperfection and not row.trial.errors]
    made = {
        "null": null(rows),
        "null_named": null_named(rows),
        "recovery": recovery(rows),
        **{f"confusion_{size}": confusion(rows, size) for size in SIZES},
        "beyond": beyond(rows),
        "power": power(rows),
        "coverage": coverage(clean),
        "plants": plants(rows),
        **imperfect_tables(rows),
    }
    return {name: table for name, table in made.items() if len(table)}


def null(rows: Iterable[Row]) -> pd.DataFrame:
    """False positives in trials without a hidden effect, by plant and encoder, and in total."""
    return _by_plant([row for row in rows if row.trial.study == "null"], _false)


def _false(rows: Sequence[Row]) -> dict[str, float]:
    ended = [row for row in rows if row.error is None]
    wrong = sum(row.outcome is not Outcome.RIGHT for row in ended)
    undecided = sum(row.verdict == "not_identifiable" for row in ended)
    return {"cases": len(ended), "undecided": undecided, "false": wrong, **rate(wrong, len(ended))}


def null_named(rows: Iterable[Row]) -> pd.DataFrame:
    """Terms found in trials without a hidden effect, with the number of trials."""
    names: dict[str, int] = {}
    for row in rows:
        if row.trial.study == "null":
            spline = [f"spline of {row.depends_on}"] if row.depends_on else []
            for name in (*(one.name for one in row.named), *spline):
                names[name] = names.get(name, 0) + 1
    ordered = sorted(names.items(), key=lambda item: (-item[1], item[0]))
    return pd.DataFrame(ordered, columns=["named", "cases"])


def recovery(rows: Iterable[Row]) -> pd.DataFrame:
    """Outcomes of single effects by effect and size, and in total; `rate`: right or partner."""
    single = [row for row in rows if row.trial.study == "confusion" and row.trial.name in SCALES]
    lines = []
    for effect in (*SCALES, ALL):
        for size in SIZES:
            here = [row for row in single if row.trial.size == size and effect in (row.trial.name, ALL)]
            if here:
                lines.append({"effect": effect, "size": size, **outcomes(here)})
    return pd.DataFrame(lines)


def confusion(rows: Iterable[Row], size: str) -> pd.DataFrame:
    """Confusion matrix at one size: hidden effects (rows) against effects found (columns), partners by their names."""
    lines: dict[str, dict[str, int]] = {}
    for row in rows:
        trial = row.trial
        if trial.study == "confusion" and trial.name in SCALES and trial.size == size and row.error is None:
            line = lines.setdefault(trial.name, dict.fromkeys((*SCALES, *ELSEWHERE), 0))
            line[_heading(row)] += 1
    ordered = {name: lines[name] for name in SCALES if name in lines}
    return pd.DataFrame.from_dict(ordered, orient="index").rename_axis("acts").reset_index()


def _heading(row: Row) -> str:
    several, spline, nothing = ELSEWHERE
    if row.depends_on is not None:
        return spline
    if len(row.named) > 1:
        return several
    return row.named[0].name if row.named else nothing


def beyond(rows: Iterable[Row]) -> pd.DataFrame:
    """Outcomes of unlisted effects (right: a spline term with the main regressor) and of pairs."""
    kinds = dict.fromkeys(UNLISTED_SCALES, "unlisted") | {" + ".join(pair): "pair" for pair in PAIRS}
    confused = [row for row in rows if row.trial.study == "confusion"]
    lines = []
    for kind in ("unlisted", "pair"):
        names = [name for name, of in kinds.items() if of == kind]
        for name in (*names, ALL):
            here = [row for row in confused if row.trial.name in (names if name == ALL else [name])]
            if here:
                splines = sum(row.verdict == "unlisted" for row in here)
                lines.append({"kind": kind, "acts": name, "spline_terms": splines, **outcomes(here)})
    return pd.DataFrame(lines)


def power(rows: Iterable[Row]) -> pd.DataFrame:
    """Share of trials in which an effect is found, by effect and size; `rate` counts right, partner and more."""
    followed = [row for row in rows if row.trial.errors]
    lines = []
    for errors in sorted({row.trial.errors for row in followed}):
        sized = [row for row in followed if row.trial.errors == errors]
        for effect in (*POWER, ALL):
            here = [row for row in sized if effect in (row.trial.name, ALL)]
            if not here:
                continue
            parameter = ALL if effect == ALL else next(iter(SCALES[effect].middle))
            line = {"standard_errors": errors, "effect": effect, "parameter": parameter, "cases": len(here)}
            if effect != ALL:
                changes = [abs(row.acted[effect][parameter] - SCALES[effect].neutral) for row in here if row.acted]
                line["median_change"] = float(f"{np.median(changes):.3g}") if changes else math.nan
            nothing = sum(row.outcome is Outcome.NOTHING for row in here)
            found = sum(row.outcome.found for row in here)
            wrong = sum(bool(row.false_names) for row in here)
            lines.append({**line, "nothing": nothing, "wrong": wrong, "found": found, **rate(found, len(here))})
    return pd.DataFrame(lines)


def coverage(rows: Iterable[Row]) -> pd.DataFrame:
    """Share of 95 % intervals that contain the true value if all hidden effects were found, by parameter and total."""
    found = [interval for row in rows for interval in row.intervals()]
    keys = sorted({(one.effect, one.parameter) for one in found}, key=lambda key: (list(SCALES).index(key[0]), key[1]))
    lines = []
    for effect, parameter in keys:
        here = [one for one in found if (one.effect, one.parameter) == (effect, parameter)]
        lines.append({"effect": effect, "parameter": parameter, **covered(here)})
    if found:
        lines.append({"effect": ALL, "parameter": ALL, **covered(found)})
    return pd.DataFrame(lines)


def plants(rows: Iterable[Row]) -> pd.DataFrame:
    """Recovery of single effects of middle and large size, and coverage, by plant and encoder, and in total."""

    def summary(here: Sequence[Row]) -> dict[str, float]:
        sized = [row for row in here if row.trial.factor >= SIZES["middle"] and row.trial.name in SCALES]
        right = sum(row.outcome in (Outcome.RIGHT, Outcome.PARTNER) for row in sized)
        recovered = {f"recovery_{key}": value for key, value in rate(right, len(sized)).items()}
        intervals = covered([interval for row in here for interval in row.intervals()])
        return {"cases": len(sized), "recovered": right, **recovered, **intervals}

    return _by_plant([row for row in rows if row.trial.study == "confusion"], summary)


def _by_plant(rows: Sequence[Row], summary: Callable[[Sequence[Row]], Mapping[str, float]]) -> pd.DataFrame:
    """The summary of the rows of each plant with each encoder, and of all."""
    groups: dict[tuple[str, str], list[Row]] = {}
    for row in rows:
        groups.setdefault((row.trial.plant, row.trial.encoder), []).append(row)
    lines = [
        {"plant": plant, "encoder": encoder, **summary(groups[plant, encoder])} for plant, encoder in sorted(groups)
    ]
    if rows:
        lines.append({"plant": ALL, "encoder": ALL, **summary(rows)})
    return pd.DataFrame(lines)
