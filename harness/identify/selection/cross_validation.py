"""Selection by cross-validation, for recordings in which effects and spline terms leave much unexplained.

The likelihood weighs one-step predictions. If the process noise stays far above the input-noise floor, unmodelled
physics dominates these, and the likelihood may keep a term that worsens predictions over seconds or miss one that
improves them. Held-out windows then decide: 2 s known, 3 s predicted, by fits to the other recordings.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from harness.identify.estimate.fit import Fit, fit
from harness.identify.estimate.window_errors import tuned_to_windows, window_errors
from harness.identify.problem.problem import Problem
from harness.identify.problem.windows import folds, windows_of
from harness.identify.selection.candidates import candidates, fit_candidates, selected_effects
from harness.identify.selection.criterion import Evidence, Rule
from harness.identify.selection.ledger import Ledger
from harness.progress import Progress


def cross_validate(problem: Problem, base: Fit, found: Fit, ledger: Ledger, progress: Progress) -> Fit:
    """The fit that predicts held-out windows best; `found` unchanged if nothing is left to explain.

    Args:
        base: the fit without any effect.
    """
    settings = problem.settings
    if ledger.criterion.at_noise_floor(problem, found) or len(windows_of(problem.recordings)) < settings.min_windows:
        return found
    if found.hypothesis.spline is not None:
        plain = next(line.against for line in ledger.lines if line.kept and line.rule is Rule.SPLINE)
        found = _validated(problem, found, plain, (), ledger, progress)
    if found.hypothesis.spline is None and selected_effects(problem, found):
        found = _validated(problem, found, base, selected_effects(problem, found), ledger, progress)
    while len(selected_effects(problem, found)) < settings.validated_effects and found.hypothesis.spline is None:
        better = _extended(problem, found, ledger, progress)
        if better is None:
            break
        found = better
    return found


def held_out_errors(problem: Problem, full: Fit) -> tuple[float, ...]:
    """RMS error of every window [m], by a fit of the same hypothesis without the window's recording."""
    errors: list[float] = []
    for fold in folds(problem):
        refit = fit(
            fold.problem,
            full.refined,
            process_noise=full.process_noise,
            initial=full.values(),
            rounds=problem.settings.validated_rounds,
        )
        tuned = tuned_to_windows(fold.problem, refit, windows_of(fold.problem.recordings))
        errors += window_errors(fold.problem, tuned, windows_of(fold.left))
    return tuple(errors)


def _validated(
    problem: Problem, found: Fit, plain: Fit, effects: tuple[str, ...], ledger: Ledger, progress: Progress
) -> Fit:
    """`found`, or if it predicts better `plain`, the fit without `effects` or without the spline term."""
    progress(f"cross-validation: {' + '.join(effects) or 'spline term'}")
    evidence = Evidence(before=held_out_errors(problem, plain), after=held_out_errors(problem, found))
    return found if ledger.decide(Rule.VALIDATE, found, plain, effects, evidence) else plain


def _extended(problem: Problem, base: Fit, ledger: Ledger, progress: Progress) -> Fit | None:
    """`base` with the candidate that reduces the held-out error most; `None` if no reduction is significant."""
    windows = windows_of(problem.recordings)

    def in_sample(candidate: Fit) -> float:
        progress(f"window errors: {candidate.hypothesis.names[-1]}")
        tuned = tuned_to_windows(problem, candidate, windows)
        return float(np.mean(np.square(window_errors(problem, tuned, windows))))

    fits = fit_candidates(problem, base, progress, failures=ledger.failures)
    tried = sorted(fits, key=in_sample)[: problem.settings.validated_candidates]
    before, tests = held_out_errors(problem, base), len(candidates(problem))
    rounds = []
    for candidate in tried:
        progress(f"cross-validation: {candidate.hypothesis.names[-1]}")
        rounds.append((candidate, Evidence(before=before, after=held_out_errors(problem, candidate), tests=tests)))
    winner = ledger.criterion.largest_reduction(rounds)
    kept = None
    for candidate, evidence in rounds:
        full = replace(evidence, winner=winner)
        if ledger.decide(Rule.EXTEND, candidate, base, candidate.hypothesis.names[-1:], full):
            kept = fit(problem, candidate.hypothesis, process_noise=candidate.process_noise, starts=[candidate.theta])
    return kept
