"""Rows into tables: false positives, recovery, confusion, power, coverage. Every rate has its Wilson interval."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence

import numpy as np
import pandas as pd
from scipy.stats import binomtest

from benchmarks.calibration.rows import Interval, Outcome, Row
from benchmarks.calibration.sizes import PAIRS, POWER, SCALES, SIZES, UNLISTED_SCALES

ALL = "all"
ELSEWHERE = ("several", "a curve", "nothing")
"""Columns of the confusion beside the effects."""


def rate(successes: int, trials: int) -> dict[str, float]:
    """Rate with its 95 % interval (Wilson, J. Amer. Statist. Assoc. 22, 1927); NaN of no trials."""
    if not trials:
        return {"rate": math.nan, "low": math.nan, "high": math.nan}
    interval = binomtest(successes, trials).proportion_ci(method="wilson")
    return {"rate": successes / trials, "low": float(interval.low), "high": float(interval.high)}


def tables(rows: Sequence[Row]) -> dict[str, pd.DataFrame]:
    """Every table by the name of its file; tables of studies of which there is no row are left out."""
    made = {
        "null": null(rows),
        "null_named": null_named(rows),
        "recovery": recovery(rows),
        **{f"confusion_{size}": confusion(rows, size) for size in SIZES},
        "beyond": beyond(rows),
        "power": power(rows),
        "coverage": coverage(rows),
        "plants": plants(rows),
    }
    return {name: table for name, table in made.items() if len(table)}


def null(rows: Iterable[Row]) -> pd.DataFrame:
    """False positives of effect-free trials, by plant and encoder, and of all."""
    return _by_plant([row for row in rows if row.trial.study == "null"], _false)


def _false(rows: Sequence[Row]) -> dict[str, float]:
    ended = [row for row in rows if row.error is None]
    wrong = sum(row.outcome is not Outcome.RIGHT for row in ended)
    undecided = sum(row.verdict == "not_identifiable" for row in ended)
    return {"cases": len(ended), "undecided": undecided, "false": wrong, **rate(wrong, len(ended))}


def null_named(rows: Iterable[Row]) -> pd.DataFrame:
    """What was named where nothing acts, and how often."""
    names: dict[str, int] = {}
    for row in rows:
        if row.trial.study == "null":
            curve = [f"a curve of {row.depends_on}"] if row.depends_on else []
            for name in (*(one.name for one in row.named), *curve):
                names[name] = names.get(name, 0) + 1
    ordered = sorted(names.items(), key=lambda item: (-item[1], item[0]))
    return pd.DataFrame(ordered, columns=["named", "cases"])


def recovery(rows: Iterable[Row]) -> pd.DataFrame:
    """Outcomes of single effects of the catalogue by effect and size, and of all effects; `rate`: right or partner."""
    single = [row for row in rows if row.trial.study == "confusion" and row.trial.name in SCALES]
    lines = []
    for effect in (*SCALES, ALL):
        for size in SIZES:
            here = [row for row in single if row.trial.size == size and effect in (row.trial.name, ALL)]
            if here:
                lines.append({"effect": effect, "size": size, **_outcomes(here)})
    return pd.DataFrame(lines)


def _outcomes(rows: Sequence[Row]) -> dict[str, float]:
    counts = {str(outcome): sum(row.outcome is outcome for row in rows) for outcome in Outcome}
    told = counts[Outcome.RIGHT] + counts[Outcome.PARTNER]
    return {"cases": len(rows), **counts, **rate(told, len(rows))}


def confusion(rows: Iterable[Row], size: str) -> pd.DataFrame:
    """What acted (lines) against what was named (columns) at one size: counts. A partner stands under its own name."""
    lines: dict[str, dict[str, int]] = {}
    for row in rows:
        trial = row.trial
        if trial.study == "confusion" and trial.name in SCALES and trial.size == size and row.error is None:
            line = lines.setdefault(trial.name, dict.fromkeys((*SCALES, *ELSEWHERE), 0))
            line[_heading(row)] += 1
    ordered = {name: lines[name] for name in SCALES if name in lines}
    return pd.DataFrame.from_dict(ordered, orient="index").rename_axis("acts").reset_index()


def _heading(row: Row) -> str:
    several, curve, nothing = ELSEWHERE
    if row.depends_on is not None:
        return curve
    if len(row.named) > 1:
        return several
    return row.named[0].name if row.named else nothing


def beyond(rows: Iterable[Row]) -> pd.DataFrame:
    """Outcomes of unlisted structures (right: a curve, of what it depends on most) and of pairs."""
    kinds = dict.fromkeys(UNLISTED_SCALES, "unlisted") | {" + ".join(pair): "pair" for pair in PAIRS}
    confused = [row for row in rows if row.trial.study == "confusion"]
    lines = []
    for kind in ("unlisted", "pair"):
        names = [name for name, of in kinds.items() if of == kind]
        for name in (*names, ALL):
            here = [row for row in confused if row.trial.name in (names if name == ALL else [name])]
            if here:
                curves = sum(row.verdict == "unlisted" for row in here)
                lines.append({"kind": kind, "acts": name, "curves": curves, **_outcomes(here)})
    return pd.DataFrame(lines)


def power(rows: Iterable[Row]) -> pd.DataFrame:
    """How often an effect is found, against its size; `rate` is of those found, right or with something besides."""
    lines = []
    followed = [row for row in rows if row.trial.study in ("confusion", "power") and row.trial.name in POWER]
    for effect in POWER:
        scale, parameter = SCALES[effect], next(iter(SCALES[effect].middle))
        for factor in sorted({row.trial.factor for row in followed if row.trial.name == effect}):
            here = [row for row in followed if row.trial.name == effect and row.trial.factor == factor]
            found = sum(row.outcome.found for row in here)
            change = abs(scale.at(factor, parameter) - scale.neutral)
            line = {"effect": effect, "parameter": parameter, "factor": factor, "change": float(f"{change:.6g}")}
            silent = sum(row.outcome is Outcome.NOTHING for row in here)
            lines.append({**line, "cases": len(here), "nothing": silent, "found": found, **rate(found, len(here))})
    return pd.DataFrame(lines)


def coverage(rows: Iterable[Row]) -> pd.DataFrame:
    """How often 95 % intervals hold the truth where all that acts was named, by parameter, and of all."""
    found = [interval for row in rows for interval in row.intervals()]
    keys = sorted({(one.effect, one.parameter) for one in found}, key=lambda key: (list(SCALES).index(key[0]), key[1]))
    lines = []
    for effect, parameter in keys:
        here = [one for one in found if (one.effect, one.parameter) == (effect, parameter)]
        lines.append({"effect": effect, "parameter": parameter, **_covered(here)})
    if found:
        lines.append({"effect": ALL, "parameter": ALL, **_covered(found)})
    return pd.DataFrame(lines)


def _covered(intervals: Sequence[Interval]) -> dict[str, float]:
    covered, z = sum(one.covers for one in intervals), np.array([one.z for one in intervals])
    finite = z[np.isfinite(z)]
    spread = float(np.sqrt(np.mean(finite**2))) if finite.size else math.nan
    return {"intervals": len(intervals), "covered": covered, **rate(covered, len(intervals)), "z_rms": spread}


def plants(rows: Iterable[Row]) -> pd.DataFrame:
    """Recovery of single effects at the middle size and up, and coverage, by plant and encoder, and of all."""

    def judged(here: Sequence[Row]) -> dict[str, float]:
        sized = [row for row in here if row.trial.factor >= SIZES["middle"] and row.trial.name in SCALES]
        told = sum(row.outcome in (Outcome.RIGHT, Outcome.PARTNER) for row in sized)
        recovered = {f"recovery_{key}": value for key, value in rate(told, len(sized)).items()}
        covered = _covered([interval for row in here for interval in row.intervals()])
        return {"cases": len(sized), "told": told, **recovered, **covered}

    return _by_plant([row for row in rows if row.trial.study == "confusion"], judged)


def _by_plant(rows: Sequence[Row], judged: Callable[[Sequence[Row]], Mapping[str, float]]) -> pd.DataFrame:
    """A line for each plant with each encoder, and one for all."""
    groups: dict[tuple[str, str], list[Row]] = {}
    for row in rows:
        groups.setdefault((row.trial.plant, row.trial.encoder), []).append(row)
    lines = [
        {"plant": plant, "encoder": encoder, **judged(groups[plant, encoder])} for plant, encoder in sorted(groups)
    ]
    if rows:
        lines.append({"plant": ALL, "encoder": ALL, **judged(rows)})
    return pd.DataFrame(lines)
