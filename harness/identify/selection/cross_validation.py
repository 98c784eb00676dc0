"""Second thoughts where much is left unexplained: what predicts windows of recordings that it was not fitted to?

The likelihood judges the next reading. Where neither the catalogue nor a curve brings the process noise near what the
angle's error gives, the next reading is ruled by what nobody has modelled, and the likelihood may keep a law or a curve
that misleads over seconds, or see nothing of one that helps. There the verdict is left to the windows of the contest
(`harness.identify.validation.baseline_comparison`): 2 s known, 3 s predicted, by fits to the other recordings.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from analytic.motion import FloatArray
from harness.identify.estimate.fit import Fit, fit
from harness.identify.problem.problem import Problem
from harness.identify.selection.candidates import Entry, beside, candidates, explained, found_in
from harness.identify.validation.baseline_comparison import for_horizon, margin, missed
from harness.identify.validation.baselines import windows_of
from harness.identify.validation.held_out import parts
from harness.identify.verdict import Search, judged
from harness.numerics import rms

_LEAST = 12  # windows, below which their scatter decides
_TRIED = 3  # candidates that are fitted without each recording, the best on all of them first
_MOST = 2  # effects that are found so
_ROUNDS = 2  # of a fit without one recording, which begins where the fit to all ended
_CHANCE = 0.05  # two-sided share beyond which a gain is no chance, shared by all candidates

Progress = Callable[[str], None]


def reconsider(said: Search, progress: Progress = lambda _: None) -> Search:
    """What was found, or what predicts better than that; unchanged where the angle's error explains what is left."""
    problem = said.problem
    if explained(problem, said.found) or len(windows_of(problem.records)) < _LEAST:
        return said
    found, ledger = said.found, list(said.ledger)
    if found.hypothesis.shape is not None:
        plain = next(one.against for one in ledger if one.kept and one.fit.hypothesis.shape is not None)
        found = _unless_worse(problem, found, plain, found.hypothesis.shape.name, ledger, progress)
    if found.hypothesis.shape is None and found_in(problem, found):
        found = _unless_worse(problem, found, said.base, " + ".join(found_in(problem, found)), ledger, progress)
    while len(found_in(problem, found)) < _MOST and found.hypothesis.shape is None:
        better = _better(problem, found, ledger, progress)
        if better is None:
            break
        found = better
    return said if found is said.found else judged(problem, said.base, found, ledger)


def _unless_worse(problem: Problem, found: Fit, plain: Fit, name: str, ledger: list[Entry], progress: Progress) -> Fit:
    """`found`, or `plain`, which is it without what is named, where that predicts better."""
    progress(f"{name} on windows that it has not seen")
    before, after = (held_out_misses(problem, one) for one in (plain, found))
    if np.mean(after**2) < np.mean(before**2):
        return found
    because = f"predicts held-out windows worse, by {rms(after):.3g} m against {rms(before):.3g} m RMS"
    ledger.append(_entry(name, plain, found, kept=False, because=because))
    return plain


def _better(problem: Problem, base: Fit, ledger: list[Entry], progress: Progress) -> Fit | None:
    """The candidate beside `base` that predicts held-out windows best, if that is more than chance."""
    seen = windows_of(problem.records)

    def on_all(one: Fit) -> float:
        progress(f"{one.hypothesis.names[-1]} on windows")
        return float(np.mean(np.square(missed(problem, for_horizon(problem, one, seen), seen))))

    tried = sorted(beside(problem, base, progress), key=on_all)[:_TRIED]
    before = held_out_misses(problem, base)
    best: tuple[float, Fit] | None = None
    for one in tried:
        name = one.hypothesis.names[-1]
        progress(f"{name} on windows that it has not seen")
        after = held_out_misses(problem, one)
        gain = margin(before, after, _CHANCE / len(candidates(problem)))
        because = f"predicts held-out windows by {rms(after):.3g} m RMS instead of {rms(before):.3g} m"
        ledger.append(
            _entry(name, base, one, kept=False, because=because + ("" if gain.sure else ", which may be chance"))
        )
        if gain.sure and (best is None or gain.value > best[0]):
            best = gain.value, one
    if best is None:
        return None
    at = next(n for n, entry in enumerate(ledger) if entry.rule == "prediction" and entry.fit is best[1])
    ledger[at] = replace(ledger[at], kept=True)
    return fit(problem, best[1].hypothesis, density=best[1].density, starts=[best[1].numbers])


def held_out_misses(problem: Problem, one: Fit) -> FloatArray:
    """RMS error of every window, shape (windows,) [m], by fits that have not seen its recording."""
    misses: list[float] = []
    for rest, left in parts(problem):
        sub = replace(problem, records=rest)
        again = fit(sub, one.refined, density=one.density, known=one.values(), rounds=_ROUNDS)
        misses += missed(sub, for_horizon(sub, again, windows_of(rest)), windows_of(left))
    return np.array(misses)


def _entry(name: str, base: Fit, one: Fit, *, kept: bool, because: str) -> Entry:
    return Entry(name, base.hypothesis.names, base.score - one.score, kept, because, one, base, rule="prediction")
