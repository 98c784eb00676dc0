"""Is something left that no entry of the catalogue explains? Curves of unknown law beside what was found."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from harness.identify.attempts import THRESHOLD, Entry, found_in, side_by_side
from harness.identify.fit import COARSE, Fit, Look, fit, looks, unfitted
from harness.identify.hypothesis import Hypothesis
from harness.identify.problem import Problem
from harness.identify.shape import KINDS, Depends, Shape, blank, visited

CURVE_THRESHOLD = 20.0  # of BIC: seven curves of twelve numbers can follow what a law of the catalogue rounds off
_DENSITIES = 10.0 ** np.arange(
    -2.0, 5.0
)  # of the process noise of a recording that is left out, over that of the others
# Effects that are curves of the same kind themselves: what the catalogue took of a cause that is not in it.
_DRY = ("rolling_resistance", "directional_resistance", "stribeck_friction", "presliding_hysteresis")
_CONTAINED = {
    (Depends.POSITION, False): ("level_error", "track_curvature", "track_bump", "beam_compliance"),
    (Depends.VELOCITY, False): ("viscous_damping", "quadratic_drag"),
    (Depends.POSITION, True): _DRY,
    (Depends.TIME, True): _DRY,
}
_PART = 0.5  # of what the best look promises: curves are nearly linear in their nodes, and keep their promises


def remainder(problem: Problem, found: Fit, progress: Callable[[str], None]) -> tuple[Fit, list[Entry]]:
    """The best fit with a curve, or `found` itself where no curve pays; and every attempt.

    Where a curve pays, each effect found before has to pay beside it again; what does not is dropped: the catalogue may
    have taken what it could of a cause that is not in it.
    """
    tried = _curves(problem, found, progress)
    best = tried[0]
    gains = found.bic - best.bic > CURVE_THRESHOLD
    pays = gains and _recurs(problem, found, best, progress)
    ledger = []
    for one in tried:
        kept = one is best and pays
        because = f"gains {found.bic - one.bic:.0f} (BIC)"
        if one is best and gains and not pays:
            because += ", but fitted to some of the recordings it does not predict the others"
        elif not kept:
            because += ", too little"
        gain = found.bic - one.bic
        ledger.append(Entry(_curve(one).name, found.hypothesis.names, gain, kept, because, one, found))
    if not pays:
        return found, ledger
    for name in found_in(problem, found):
        rest = tuple(other for other in best.hypothesis.names if other != name)
        progress(f"{name} again")
        without = fit(problem, Hypothesis(rest, best.refined.shape), density=best.density, known=best.values())
        stands_in = name in _CONTAINED.get(_kind(best), ()) and without.bic < found.bic - CURVE_THRESHOLD
        if without.bic < best.bic + THRESHOLD or stands_in:
            because = "is contained in the curve" if stands_in else "does not pay beside the curve"
            ledger.append(Entry(name, rest, without.bic - best.bic, False, because, best, without, "curve"))
            best = without
    return best, ledger


def _curve(one: Fit) -> Shape:
    assert one.hypothesis.shape is not None
    return one.hypothesis.shape


def _kind(one: Fit) -> tuple[Depends, bool]:
    return _curve(one).depends, _curve(one).friction


def _recurs(problem: Problem, found: Fit, best: Fit, progress: Callable[[str], None]) -> bool:
    """Whether the curve, fitted to all recordings but one, predicts that one better than no curve, for half of them.

    Twelve numbers can follow what happened once; a law acts again. A recording that goes where no other went is
    predicted badly all the same. One recording alone cannot tell.
    """
    if len(problem.records) == 1:
        return True
    wins = 0
    for left in problem.records:
        progress(f"the curve without {left.name}")
        rest = replace(problem, records=tuple(one for one in problem.records if one is not left))
        alone = replace(problem, records=(left,))
        before, after = (
            _deviance(alone, fit(rest, one.refined, density=one.density, known=one.values())) for one in (found, best)
        )
        wins += after < before
    return 2 * wins >= len(problem.records)


def _deviance(problem: Problem, fitted: Fit) -> float:
    """Of a recording that `fitted` has not seen; phases and process noise are its own."""
    (record,) = problem.records
    start = fitted.hypothesis.starts(problem, fitted.values(), fitted.density)[0]
    phase = float(fitted.hypothesis.read(start, problem).phases[0])
    densities = fitted.density * _DENSITIES
    return min(problem.deviance_of(record, fitted.best.effects, phase, one, fitted.best.shape) for one in densities)


def _curves(problem: Problem, found: Fit, progress: Callable[[str], None]) -> list[Fit]:
    """A curve of every kind beside what was found, the best first; fitted where a look promises something."""
    hypotheses = [Hypothesis(found.hypothesis.names, blank(*kind, *visited(problem, kind[0]))) for kind in KINDS]

    def look(hypothesis: Hypothesis) -> Look:
        assert hypothesis.shape is not None
        progress(f"a {hypothesis.shape.name}")
        return looks(problem, hypothesis, found.density, found.values(), steps=(COARSE, 1.0))[0]

    seen = list(zip(hypotheses, side_by_side(look, hypotheses), strict=True))
    least = _PART * max(found.deviance - min(one.promise, one.deviance) for _, one in seen)

    def follow(each: tuple[Hypothesis, Look]) -> Fit:
        hypothesis, first = each
        if found.deviance - min(first.promise, first.deviance) < least:
            return unfitted(problem, hypothesis, first)
        return fit(problem, hypothesis, density=found.density, starts=[first.numbers])

    return sorted(side_by_side(follow, seen), key=lambda one: one.bic)
