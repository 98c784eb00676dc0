"""Spline terms of unknown law, tried where effects leave something unexplained."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from analytic.effects import CATALOGUE, Acting, parameters_with
from analytic.law import acceleration, dry_limit
from analytic.models import RESPONSE, ROLL, WEIGHT
from analytic.motion import FloatArray
from harness.identify.estimate.fit import Fit, fit, unrefined
from harness.identify.estimate.initial_phase import phase_of
from harness.identify.estimate.screening import COARSE_STEP, ScreeningFit, screen
from harness.identify.filter.run import deviance_of, run_filter
from harness.identify.problem.hypothesis import NOTHING, Hypothesis
from harness.identify.problem.problem import PreparedRecording, Problem
from harness.identify.problem.spline_term import KINDS, Regressor, SplineTerm, blank
from harness.identify.problem.windows import Fold, folds
from harness.identify.selection.candidates import Progress, in_threads, selected_effects
from harness.identify.selection.criterion import Evidence, Rule
from harness.identify.selection.ledger import Ledger

# Process noise of a held-out recording over that of the others.
_NOISE_RATIOS = 10.0 ** np.arange(-2.0, 5.0)
_OPEN = 1e-3  # process noise with which a filter follows the readings whatever the model lacks [m²/s³]


def with_spline_term(problem: Problem, found: Fit, ledger: Ledger, progress: Progress) -> Fit:
    """The best fit with a spline term beside the effects of `found`, or `found` itself where none pays.

    Where one pays, it gets twice the nodes if these pay too, and each effect found before has to pay beside it again.
    """
    tried = _fit_kinds(problem, found, progress)
    best = tried[0]
    pays = ledger.criterion.gain(best, found) > problem.settings.spline_keep
    before, after = held_out_deviances(problem, found, best, progress) if pays else ((), ())
    evidence = Evidence(winner=best, before=before, after=after)
    kept = [one for one in tried if ledger.decide(Rule.SPLINE, one, found, evidence=evidence)]
    if not kept:
        return found
    best = _refined(problem, best, ledger, progress)
    for name in selected_effects(problem, found):
        rest = tuple(other for other in best.hypothesis.names if other != name)
        progress(f"{name} again")
        nested = _kind(best) in CATALOGUE[name].relations.nested_in
        spline = _with_law_in_it(problem, best, name) if nested else best.refined.spline
        without = fit(problem, Hypothesis(rest, spline), process_noise=best.process_noise, known=best.values())
        stays = ledger.decide(Rule.ABSORB, best, without, (name,), Evidence(holder=found, nested=nested))
        best = best if stays else without
    return best


def _shape(one: Fit) -> SplineTerm:
    assert one.terms.spline is not None
    return one.terms.spline


def _kind(one: Fit) -> tuple[Regressor, bool]:
    return _shape(one).depends, _shape(one).friction


def _refined(problem: Problem, best: Fit, ledger: Ledger, progress: Progress) -> Fit:
    """The spline term through twice as many nodes, if these pay."""
    progress(f"a finer {_shape(best).name}")
    finer = Hypothesis(best.hypothesis.names, _shape(best).finer())
    one = fit(problem, finer, process_noise=best.process_noise, known=best.values())
    return one if ledger.decide(Rule.REFINE, one, best) else best


def _with_law_in_it(problem: Problem, best: Fit, name: str) -> SplineTerm:
    """The spline term with the law of an effect that it contains added to its nodes, and with nodes for both."""
    spline = _shape(best)
    spline = spline if len(spline.nodes) > problem.settings.spline_nodes else spline.finer()
    (effect,) = (one for one in best.terms.effects if one.effect.name == name)
    return replace(spline, nodes=spline.nodes + _law_along(problem, effect, spline))


def _law_along(problem: Problem, effect: Acting, spline: SplineTerm) -> FloatArray:
    """The law of an effect at the nodes of a spline term of its kind, in their unit, shape (n,)."""
    bare, full = (parameters_with(problem.model, problem.rig, each) for each in ((), (effect,)))
    if spline.friction:  # of a rolling ball, and the mean of both directions
        limits = [dry_limit(0.0, towards, towards, 0.0, 0.0, 0.0, full) for towards in (1.0, -1.0)]
        return np.full(len(spline.nodes), np.mean(limits) / (full[RESPONSE] * full[WEIGHT]))
    s, v, angle = np.zeros((3, len(spline.nodes)))
    if spline.depends is Regressor.VELOCITY:
        v = spline.places
    elif spline.depends is Regressor.ANGLE:
        angle = spline.places
    else:
        s = spline.places / full[ROLL] if spline.turning else spline.places

    def along(p: FloatArray) -> FloatArray:
        return np.array([acceleration(*at, 0.0, 0.0, p) for at in zip(s, v, angle, strict=True)])

    return (along(full) - along(bare)) / full[RESPONSE]


def held_out_deviances(
    problem: Problem, found: Fit, best: Fit, progress: Progress
) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Deviance of each recording by fits to the others, without and with the spline term; none of a single one."""
    if len(problem.recordings) == 1:
        return (), ()
    before: list[float] = []
    after: list[float] = []
    for fold in folds(problem):
        progress(f"the spline term without {fold.title}")
        for one, deviances in ((found, before), (best, after)):
            refit = fit(fold.problem, one.refined, process_noise=one.process_noise, known=one.values())
            deviances.append(_deviance(fold, refit))
    return tuple(before), tuple(after)


def _deviance(fold: Fold, fitted: Fit) -> float:
    """Of the held-out recording; its phase and process noise are its own."""
    recording: PreparedRecording = fold.left[0]
    phase = phase_of(fold.problem, fitted, recording, recording.reading)
    process_noises = fitted.process_noise * _NOISE_RATIOS
    return min(deviance_of(fold.problem, recording, fitted.terms, one, phase=phase) for one in process_noises)


def _fit_kinds(problem: Problem, found: Fit, progress: Progress) -> list[Fit]:
    """A spline term of every kind beside what was found, best first; fitted where its screening fit promises it."""
    steps = (COARSE_STEP, 1.0)

    def begin(depends: Regressor, friction: bool) -> Hypothesis:
        """One of the rolled angle begins as one recording has it: how the ball lay in the others shows then."""
        count = problem.settings.spline_nodes
        spline = blank(depends, friction, *visited(problem, depends), count)
        hypothesis = Hypothesis(found.hypothesis.names, spline)
        if depends is not Regressor.ROLL_ANGLE:
            return hypothesis
        alone = replace(problem, recordings=(max(problem.recordings, key=lambda one: np.isfinite(one.reading).sum()),))
        theta = screen(alone, hypothesis, found.process_noise, found.values(), steps=steps)[0].theta
        return Hypothesis(hypothesis.names, hypothesis.terms(theta, alone).spline)

    def screened(hypothesis: Hypothesis) -> ScreeningFit:
        assert hypothesis.spline is not None
        progress(f"a {hypothesis.spline.name}")
        return screen(problem, hypothesis, found.process_noise, found.values(), steps=steps)[0]

    hypotheses = in_threads(lambda kind: begin(*kind), KINDS)
    seen = list(zip(hypotheses, in_threads(screened, hypotheses), strict=True))
    least = problem.settings.spline_share * max(found.deviance - one.hoped for _, one in seen)

    def follow(each: tuple[Hypothesis, ScreeningFit]) -> Fit:
        hypothesis, first = each
        if found.deviance - first.hoped < least:
            return unrefined(problem, hypothesis, first)
        return fit(problem, hypothesis, process_noise=found.process_noise, starts=[first.theta])

    fits = in_threads(follow, seen)
    return sorted(fits, key=lambda one: one.deviance + np.log(one.readings) * len(one.theta))


def visited(problem: Problem, depends: Regressor) -> tuple[float, float]:
    """Between what the recordings keep what a curve depends on; the outermost half percents are left out."""
    match depends:
        case Regressor.TIME:
            return min(r.time[0] for r in problem.recordings), max(r.time[-1] for r in problem.recordings)
        case Regressor.ROLL_ANGLE:
            return 0.0, 2.0 * np.pi
        case Regressor.ANGLE:
            values = [recording.table[:, 0] for recording in problem.recordings]
        case Regressor.POSITION:
            values = [recording.reading[np.isfinite(recording.reading)] for recording in problem.recordings]
        case Regressor.VELOCITY:
            runs = ((run_filter(problem, one, NOTHING, _OPEN), np.isfinite(one.reading)) for one in problem.recordings)
            values = [run.state[known, 1] for run, known in runs]
    low, high = np.percentile(np.concatenate(values), [0.5, 99.5])
    return float(low), float(high)
