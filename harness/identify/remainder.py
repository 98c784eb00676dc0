"""Is something left that no entry of the catalogue explains? Curves of unknown law beside what was found."""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

from harness.identify.fit import Fit, fit
from harness.identify.hypothesis import Hypothesis
from harness.identify.problem import Problem
from harness.identify.select import THRESHOLD, Entry
from harness.identify.shape import KINDS, Depends, blank, visited

CURVE_THRESHOLD = 20.0  # of BIC: seven curves of twelve numbers can follow what a law of the catalogue rounds off


def remainder(problem: Problem, found: Fit, progress: Callable[[str], None]) -> tuple[Fit, list[Entry]]:
    """The best fit with a curve, or `found` itself where no curve pays; and every attempt.

    Where a curve pays, each effect found before has to pay beside it again; what does not is dropped: the catalogue may
    have taken what it could of a cause that is not in it.
    """
    names = found.hypothesis.names

    def attempt(kind: tuple[Depends, bool]) -> Fit:
        depends, friction = kind
        progress(f"a curve of {depends}{' in friction' if friction else ''}")
        curve = blank(depends, friction, *visited(problem, depends))
        return fit(problem, Hypothesis(names, curve), density=found.density, known=found.values())

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        tried = list(pool.map(attempt, KINDS))
    best = min(tried, key=lambda one: one.bic)
    ledger = []
    for one in sorted(tried, key=lambda one: one.bic):
        kept = one is best and found.bic - one.bic > CURVE_THRESHOLD
        because = f"gains {found.bic - one.bic:.0f} (BIC)" + ("" if kept else ", too little")
        shape = one.hypothesis.shape
        assert shape is not None
        name = f"curve of {shape.depends}" + (" in friction" if shape.friction else "")
        ledger.append(Entry(name, names, found.bic - one.bic, kept, because, one))
    if found.bic - best.bic <= CURVE_THRESHOLD:
        return found, ledger
    for name in names:
        rest = tuple(other for other in best.hypothesis.names if other != name)
        without = fit(problem, Hypothesis(rest, best.hypothesis.shape), density=best.density, known=best.values())
        if without.bic < best.bic + THRESHOLD:
            ledger.append(Entry(name, rest, without.bic - best.bic, False, "does not pay beside the curve", best))
            best = without
    return best, ledger
