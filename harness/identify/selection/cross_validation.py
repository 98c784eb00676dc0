"""Selection by cross-validation, where effects and spline terms leave much unexplained.

The likelihood judges the next reading. Where the process noise stays far above the input-noise floor, the next reading
is ruled by what nobody has modelled, and the likelihood may keep a term that misleads over seconds, or see nothing of
one that helps. There the decision is left to held-out windows: 2 s known, 3 s predicted, by fits to the other
recordings.
"""

from __future__ import annotations

import numpy as np

from harness.identify.estimate.fit import Fit, fit
from harness.identify.estimate.window_errors import tuned_to_windows, window_errors
from harness.identify.problem.problem import Problem
from harness.identify.problem.windows import folds, windows_of
from harness.identify.selection.candidates import Progress, candidates, fit_candidates, selected_effects
from harness.identify.selection.criterion import Evidence, Rule
from harness.identify.selection.ledger import Ledger


def cross_validate(problem: Problem, base: Fit, found: Fit, ledger: Ledger, progress: Progress) -> Fit:
    """What was found, or what predicts held-out windows better; unchanged where nothing is left to explain.

    Args:
        base: the fit without any effect.
    """
    settings = problem.settings
    if ledger.criterion.explained(problem, found) or len(windows_of(problem.recordings)) < settings.min_windows:
        return found
    if found.hypothesis.spline is not None:
        plain = next(one.against for one in ledger.lines if one.kept and one.rule is Rule.SPLINE)
        found = _validated(problem, found, plain, (), ledger, progress)
    if found.hypothesis.spline is None and selected_effects(problem, found):
        found = _validated(problem, found, base, selected_effects(problem, found), ledger, progress)
    while len(selected_effects(problem, found)) < settings.validated_effects and found.hypothesis.spline is None:
        better = _extended(problem, found, ledger, progress)
        if better is None:
            break
        found = better
    return found


def held_out_errors(problem: Problem, one: Fit) -> tuple[float, ...]:
    """RMS error of every window [m], by fits that have not seen its recording."""
    errors: list[float] = []
    for fold in folds(problem):
        again = fit(
            fold.problem,
            one.refined,
            process_noise=one.process_noise,
            known=one.values(),
            rounds=problem.settings.validated_rounds,
        )
        tuned = tuned_to_windows(fold.problem, again, windows_of(fold.problem.recordings))
        errors += window_errors(fold.problem, tuned, windows_of(fold.left))
    return tuple(errors)


def _validated(
    problem: Problem, found: Fit, plain: Fit, effects: tuple[str, ...], ledger: Ledger, progress: Progress
) -> Fit:
    """`found`, or `plain`, which is it without `effects` or without its spline term, where that predicts better."""
    progress(f"{' + '.join(effects) or 'the spline term'} on held-out windows")
    evidence = Evidence(before=held_out_errors(problem, plain), after=held_out_errors(problem, found))
    return found if ledger.decide(Rule.VALIDATE, found, plain, effects, evidence) else plain


def _extended(problem: Problem, base: Fit, ledger: Ledger, progress: Progress) -> Fit | None:
    """The candidate beside `base` that predicts held-out windows best, if that is more than chance."""
    seen = windows_of(problem.recordings)

    def in_sample(one: Fit) -> float:
        progress(f"{one.hypothesis.names[-1]} on windows")
        return float(np.mean(np.square(window_errors(problem, tuned_to_windows(problem, one, seen), seen))))

    tried = sorted(fit_candidates(problem, base, progress), key=in_sample)[: problem.settings.validated_candidates]
    before, tests = held_out_errors(problem, base), len(candidates(problem))
    rounds = []
    for one in tried:
        progress(f"{one.hypothesis.names[-1]} on held-out windows")
        rounds.append((one, Evidence(before=before, after=held_out_errors(problem, one), tests=tests)))
    margins = [(ledger.criterion.reduction(evidence), one) for one, evidence in rounds]
    sure = [(margin.value, one) for margin, one in margins if margin.sure]
    winner = max(sure, key=lambda each: each[0])[1] if sure else None
    kept = None
    for one, evidence in rounds:
        full = Evidence(winner=winner, before=evidence.before, after=evidence.after, tests=tests)
        if ledger.decide(Rule.EXTEND, one, base, one.hypothesis.names[-1:], full):
            kept = fit(problem, one.hypothesis, process_noise=one.process_noise, starts=[one.theta])
    return kept
