"""Is something left that no entry of the catalogue explains? Curves of unknown law beside what was found."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from analytic.effects import CATALOGUE, Acting, parameters_with
from analytic.law import acceleration, dry_limit
from analytic.models import RESPONSE, ROLL, WEIGHT
from analytic.motion import FloatArray
from harness.identify.estimate.fit import COARSE, Fit, Look, fit, looks, unfitted
from harness.identify.estimate.roll_phase import phase_of
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.problem import Problem, Record
from harness.identify.problem.spline_term import KINDS, NODES, Depends, Shape, blank, visited
from harness.identify.selection.candidates import THRESHOLD, Entry, found_in, side_by_side

CURVE_THRESHOLD = 20.0  # of BIC: eight curves of twelve numbers can follow what a law of the catalogue rounds off
_DENSITIES = 10.0 ** np.arange(
    -2.0, 5.0
)  # of the process noise of a recording that is left out, over that of the others
_PART = 0.5  # of what the best look promises: curves are nearly linear in their nodes, and keep their promises


def remainder(problem: Problem, found: Fit, progress: Callable[[str], None]) -> tuple[Fit, list[Entry]]:
    """The best fit with a curve, or `found` itself where no curve pays; and every attempt.

    Where a curve pays, it gets twice the nodes if these pay too, and each effect found before has to pay beside it
    again; what does not is dropped, and so is what a curve of its own kind can stand in for: the catalogue may have
    taken what it could of a cause that is not in it.
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
    best = _finer(problem, best, ledger, progress)
    for name in found_in(problem, found):
        rest = tuple(other for other in best.hypothesis.names if other != name)
        progress(f"{name} again")
        contained = _kind(best) in CATALOGUE[name].relations.nested_in
        shape = _with_in_it(problem, best, name) if contained else best.refined.shape
        without = fit(problem, Hypothesis(rest, shape), density=best.density, known=best.values())
        stands_in = contained and without.bic < found.bic - CURVE_THRESHOLD
        if without.bic < best.bic + THRESHOLD or stands_in:
            because = "is contained in the curve" if stands_in else "does not pay beside the curve"
            ledger.append(Entry(name, rest, without.bic - best.bic, False, because, best, without, "curve"))
            best = without
    return best, ledger


def _curve(one: Fit) -> Shape:
    assert one.best.shape is not None
    return one.best.shape


def _kind(one: Fit) -> tuple[Depends, bool]:
    return _curve(one).depends, _curve(one).friction


def _finer(problem: Problem, best: Fit, ledger: list[Entry], progress: Callable[[str], None]) -> Fit:
    """The curve through twice as many nodes, if these pay."""
    shape = _curve(best)
    progress(f"a finer {shape.name}")
    finer = Hypothesis(best.hypothesis.names, shape.finer())
    one = fit(problem, finer, density=best.density, known=best.values())
    gain = best.bic - one.bic
    kept = gain > THRESHOLD
    because = f"twice the nodes gain {gain:.0f} (BIC){'' if kept else ', too little'}"
    ledger.append(Entry(f"finer {shape.name}", best.hypothesis.names, gain, kept, because, one, best, "curve"))
    return one if kept else best


def _with_in_it(problem: Problem, best: Fit, name: str) -> Shape:
    """The curve with the law of an effect of its own kind in it, and with nodes for both."""
    shape = _curve(best)
    shape = shape if len(shape.nodes) > NODES else shape.finer()
    (effect,) = (one for one in best.best.effects if one.effect.name == name)
    return replace(shape, nodes=shape.nodes + _law_along(problem, effect, shape))


def _law_along(problem: Problem, effect: Acting, shape: Shape) -> FloatArray:
    """The law of an effect at the nodes of a curve of its kind, in their unit, shape (n,)."""
    bare, full = (parameters_with(problem.model, problem.rig, each) for each in ((), (effect,)))
    if shape.friction:  # of a rolling ball, and the mean of both directions
        limits = [dry_limit(0.0, towards, towards, 0.0, 0.0, 0.0, full) for towards in (1.0, -1.0)]
        return np.full(len(shape.nodes), np.mean(limits) / (full[RESPONSE] * full[WEIGHT]))
    s, v, angle = np.zeros((3, len(shape.nodes)))
    if shape.depends is Depends.VELOCITY:
        v = shape.places
    elif shape.depends is Depends.ANGLE:
        angle = shape.places
    else:
        s = shape.places / full[ROLL] if shape.turning else shape.places

    def along(p: FloatArray) -> FloatArray:
        return np.array([acceleration(*at, 0.0, 0.0, p) for at in zip(s, v, angle, strict=True)])

    return (along(full) - along(bare)) / full[RESPONSE]


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
        before, after = (
            _deviance(rest, fit(rest, one.refined, density=one.density, known=one.values()), left)
            for one in (found, best)
        )
        wins += after < before
    return 2 * wins >= len(problem.records)


def _deviance(problem: Problem, fitted: Fit, left: Record) -> float:
    """Of a recording that `fitted` has not seen; phase and process noise are its own."""
    phase = phase_of(problem, fitted, left, left.reading)
    densities = fitted.density * _DENSITIES
    return min(problem.deviance_of(left, fitted.best.effects, phase, one, fitted.best.shape) for one in densities)


def _curves(problem: Problem, found: Fit, progress: Callable[[str], None]) -> list[Fit]:
    """A curve of every kind beside what was found, the best first; fitted where a look promises something."""

    def begun(depends: Depends, friction: bool) -> Hypothesis:
        """A curve that turns with the ball begins as one recording has it: how the ball lay in others shows then."""
        hypothesis = Hypothesis(found.hypothesis.names, blank(depends, friction, *visited(problem, depends)))
        if depends is not Depends.ROLL_ANGLE:
            return hypothesis
        alone = replace(problem, records=(max(problem.records, key=lambda one: np.isfinite(one.reading).sum()),))
        numbers = looks(alone, hypothesis, found.density, found.values(), steps=(COARSE, 1.0))[0].numbers
        return Hypothesis(hypothesis.names, hypothesis.read(numbers, alone).shape)

    def look(hypothesis: Hypothesis) -> Look:
        assert hypothesis.shape is not None
        progress(f"a {hypothesis.shape.name}")
        return looks(problem, hypothesis, found.density, found.values(), steps=(COARSE, 1.0))[0]

    hypotheses = side_by_side(lambda kind: begun(*kind), KINDS)

    seen = list(zip(hypotheses, side_by_side(look, hypotheses), strict=True))
    least = _PART * max(found.deviance - min(one.promise, one.deviance) for _, one in seen)

    def follow(each: tuple[Hypothesis, Look]) -> Fit:
        hypothesis, first = each
        if found.deviance - min(first.promise, first.deviance) < least:
            return unfitted(problem, hypothesis, first)
        return fit(problem, hypothesis, density=found.density, starts=[first.numbers])

    return sorted(side_by_side(follow, seen), key=lambda one: one.bic)
