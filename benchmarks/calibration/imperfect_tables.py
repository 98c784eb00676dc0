"""Tables of the blind trials with imperfect records, by imperfection."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence

import pandas as pd

from benchmarks.calibration.imperfect import IMPERFECTIONS
from benchmarks.calibration.rows import Outcome, Row
from benchmarks.calibration.statistics import ALL, covered, outcomes, rate

UNDECIDED = "not_identifiable"

SECTIONS: tuple[tuple[str, str, str], ...] = (
    (
        "imperfect_null",
        "Imperfect records: false positives",
        "Only known effects act, but the record is imperfect in one way, or in several. Said: the effect that says "
        "what the imperfection does is named (a delay or lag of positive size where the position is late by a lag, by "
        "repeated readings or by a servo whose command is recorded, or there an angle that is held; a level, of all or "
        "of each recording, a level drift, or a spline term of time, where the zero of the angle wanders; a spline "
        "term of the position sensor where its track is worn), which is right, as naming nothing is. Held angles and "
        "levels of each recording were added to this list when these trials had named them. False: anything else, "
        "whatever it imitates. Undecided: `not_identifiable`, neither right nor false; the rate is of the decided "
        "ones.",
    ),
    (
        "imperfect_named",
        "Imperfect records: what is named falsely",
        "Number of trials, with and without a hidden effect, in which each term is named that neither acts nor says "
        "what the imperfection does.",
    ),
    (
        "imperfect_recovery",
        "Imperfect records: recovery",
        "One effect of middle size is hidden, each of the catalogue in turn; none that would say what the imperfection "
        "does. Outcomes as in blind recovery; naming the imperfection besides is not counted as a further effect. "
        "Undecided ones are counted apart and left out of the rate.",
    ),
    (
        "imperfect_coverage",
        "Imperfect records: coverage",
        "As in coverage, of these trials: a bias by the imperfection counts as a miss.",
    ),
)


def imperfect_tables(rows: Iterable[Row]) -> dict[str, pd.DataFrame]:
    """Every table by the name of its file."""
    here = [row for row in rows if row.trial.study == "imperfect"]
    free, hidden = ([row for row in here if bool(row.trial.hidden) is some] for some in (False, True))
    return {
        "imperfect_null": _by_imperfection(free, _false),
        "imperfect_named": _named(here),
        "imperfect_recovery": _by_imperfection(hidden, _recovered),
        "imperfect_coverage": _by_imperfection(
            hidden, lambda group: covered([i for r in group for i in r.intervals()])
        ),
    }


def _decided(rows: Sequence[Row]) -> list[Row]:
    return [row for row in rows if row.verdict != UNDECIDED]


def _false(rows: Sequence[Row]) -> dict[str, float]:
    ended = [row for row in rows if row.error is None]
    decided = _decided(ended)
    wrong = sum(row.outcome is not Outcome.RIGHT for row in decided)
    said = sum(row.outcome is Outcome.RIGHT and row.says_imperfection for row in decided)
    counts = {"cases": len(ended), "undecided": len(ended) - len(decided), "said": said, "false": wrong}
    return counts | rate(wrong, len(decided))


def _recovered(rows: Sequence[Row]) -> dict[str, float]:
    decided = _decided(rows)
    counts = outcomes(decided)
    return {"cases": len(rows), "undecided": len(rows) - len(decided)} | {
        name: value for name, value in counts.items() if name != "cases"
    }


def _named(rows: Iterable[Row]) -> pd.DataFrame:
    """What was named falsely with each imperfection, with the number of trials."""
    counts: Counter[tuple[str, str]] = Counter()
    for row in _decided([row for row in rows if row.error is None]):
        counts.update((row.trial.imperfection, name) for name in row.false_names)
    lines = sorted(counts.items(), key=lambda item: (IMPERFECTIONS.index(item[0][0]), -item[1], item[0][1]))
    return pd.DataFrame([(*key, count) for key, count in lines], columns=["imperfection", "named", "cases"])


def _by_imperfection(rows: Sequence[Row], summary: Callable[[Sequence[Row]], Mapping[str, float]]) -> pd.DataFrame:
    """The summary of the rows with each imperfection, and of all."""
    lines = []
    for kind in (*IMPERFECTIONS, ALL):
        group = [row for row in rows if kind in (row.trial.imperfection, ALL)]
        if group:
            lines.append({"imperfection": kind, **summary(group)})
    return pd.DataFrame(lines)
