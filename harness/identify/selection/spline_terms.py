"""Selection of a spline term, tried where effects of the catalogue leave something unexplained."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from analytic.effects import CATALOGUE, Acting, parameters_with
from analytic.law import acceleration, dry_limit
from analytic.motion import FloatArray
from analytic.slots import RESPONSE, ROLL, WEIGHT
from harness.failures import Failures
from harness.identify.estimate.fit import Fit, fit, unrefined
from harness.identify.estimate.own_values import own_of
from harness.identify.estimate.refit import refit
from harness.identify.estimate.screening import COARSE_STEP, ScreeningFit, screen
from harness.identify.filter.run import deviance_of, run_filter
from harness.identify.problem.hypothesis import NOTHING, Hypothesis
from harness.identify.problem.problem import PreparedRecording, Problem
from harness.identify.problem.spline_term import KINDS, Kind, Regressor, SplineTerm, blank
from harness.identify.problem.windows import Fold, folds
from harness.identify.selection.candidates import fitted_each, selected_effects
from harness.identify.selection.criterion import Criterion
from harness.identify.selection.decision import Evidence, Rule
from harness.identify.selection.ledger import Ledger
from harness.identify.selection.period import period_of
from harness.progress import Progress
from harness.threads import in_threads

# Process noise of a held-out recording over that of all without and with the spline term: where the ball comes to
# places that the others did not visit, a spline term leaves as much unexplained as none.
_NOISE_RATIOS = 10.0 ** np.arange(-2.0, 5.0)
# Numbers of nodes with which it is fitted to coarse data: of a force of position 12, 23, 45, of an error of the sensor,
# which has no joints or poles to repeat, 12 and 23.
_HALVINGS = {False: 3, True: 2}
_OPEN = 1e-3  # process noise with which the filter follows the readings despite missing physics [m²/s³]


def with_spline_term(problem: Problem, base: Fit, found: Fit, ledger: Ledger, progress: Progress) -> Fit:
    """`found`, or `base` if that fits better, with the best spline term; `found` if none is kept.

    Effects that imitated an unlisted one stand in the way of its spline term: so it is tried without them too. A spline
    term that is kept is refined to twice the nodes if that pays and the kernel has room for them, and each effect found
    before is tested again beside it.

    Args:
        base, found: fits without and with the effects selected.
    """
    tried = [(found, _fit_kinds(problem, found, progress, ledger.failures))]
    if selected_effects(problem, found):
        tried.append((base, _fit_kinds(problem, base, progress, ledger.failures)))
    chosen = _reproducible(problem, found, tried, ledger, progress)
    if chosen is None:
        return found
    found, best = chosen
    best = ledger.attempt("finer spline term", partial(_with_finer_spline, problem, best, ledger, progress), best)
    for name in selected_effects(problem, found):
        rest = tuple(other for other in best.hypothesis.names if other != name)
        progress(f"without {name}")
        nested = contains(_spline(best), name)
        spline = _with_effect_absorbed(problem, best, name) if nested else best.refined.spline
        without = fit(problem, Hypothesis(rest, spline), process_noise=best.process_noise, initial=best.values())
        stays = ledger.decide(Rule.ABSORB, best, without, (name,), Evidence(holder=found, nested=nested))
        best = best if stays else without
    return best


def _reproducible(
    problem: Problem, found: Fit, tried: Sequence[tuple[Fit, Sequence[Fit]]], ledger: Ledger, progress: Progress
) -> tuple[Fit, Fit] | None:
    """The fit without, and the best fit with a spline term that predicts held-out recordings; `None` if there is none.

    Args:
        found: has to be surpassed in any case.
        tried: fits without a spline term, and with one of each kind, best first.
    """
    criterion, chosen = ledger.criterion, None

    def rank(each: tuple[Fit, Sequence[Fit]]) -> float:
        """The lowest criterion; effects beside a spline term have to pay as much as it has, since they may be of it."""
        return criterion.value(each[1][0]) + (problem.settings.spline_keep if each[0] is found else 0.0)

    for against, splines in sorted((each for each in tried if each[1]), key=rank):
        best = splines[0] if chosen is None else chosen[1]
        surpasses = criterion.gain(best, found) > problem.settings.spline_keep
        pays = chosen is None and surpasses and criterion.needs_evidence(Rule.SPLINE, best, against)
        before, after = held_out_deviances(problem, against, best, progress) if pays else ((), ())
        evidence = Evidence(winner=best if surpasses else found, before=before, after=after)
        kept = [ledger.decide(Rule.SPLINE, one, against, evidence=evidence) for one in splines]
        if any(kept):
            chosen = against, best
    return chosen


def _spline(fit: Fit) -> SplineTerm:
    assert fit.terms.spline is not None
    return fit.terms.spline


def contains(spline: SplineTerm, name: str) -> bool:
    """Whether the law of an effect is nested in a spline term of this kind; none of the catalogue's is periodic."""
    kind = "reading" if spline.sensor else str(spline.depends), spline.friction
    return not spline.periodic and kind in CATALOGUE[name].relations.nested_in


def _with_finer_spline(problem: Problem, best: Fit, ledger: Ledger, progress: Progress) -> Fit:
    """The fit with twice the nodes of its spline term if that pays, and again while much is left to explain."""
    while _spline(best).refinable:
        progress(f"{_spline(best).name} with twice the nodes")
        finer = Hypothesis(best.hypothesis.names, _spline(best).finer())
        refined = fit(problem, finer, process_noise=best.process_noise, initial=best.values())
        if not ledger.decide(Rule.REFINE, refined, best):
            return best
        best = refined
        if ledger.criterion.at_noise_floor(problem, best):
            break
    return best


def _with_effect_absorbed(problem: Problem, best: Fit, name: str) -> SplineTerm:
    """The spline term, with the refined number of nodes, plus the law of an effect that is nested in it."""
    spline = _spline(best)
    if spline.refinable and len(spline.nodes) <= problem.settings.spline_nodes:
        spline = spline.finer()
    (effect,) = (term for term in best.terms.effects if term.effect.name == name)
    return replace(spline, nodes=spline.nodes + _law_at_nodes(problem, effect, spline))


def _law_at_nodes(problem: Problem, effect: Acting, spline: SplineTerm) -> FloatArray:
    """The law of an effect at the nodes of a spline term in which it is nested, in the unit of the nodes, (n,)."""
    if spline.sensor and effect.effect.sensor is not None:
        return effect.effect.sensor(effect.values).curve(spline.places) - spline.places
    if spline.depends is Regressor.TIME and effect.effect.tilting is not None:
        begin = float(problem.recordings[0].time[0])
        return problem.rig.gravity * effect.effect.tilting(effect.values) * (spline.places - begin)
    bare, full = (parameters_with(problem.model, problem.rig, effects) for effects in ((), (effect,)))
    if spline.friction:  # mean over both directions of a rolling ball
        limits = [dry_limit(0.0, sign, sign, 0.0, 0.0, 0.0, full) for sign in (1.0, -1.0)]
        return np.full(len(spline.nodes), np.mean(limits) / (full[RESPONSE] * full[WEIGHT]))
    s, v, angle = np.zeros((3, len(spline.nodes)))
    if spline.depends is Regressor.VELOCITY:
        v = spline.places
    elif spline.depends is Regressor.ANGLE:
        angle = spline.places
    else:
        s = spline.places / full[ROLL] if spline.turning else spline.places

    def at_nodes(p: FloatArray) -> FloatArray:
        return np.array([acceleration(*state, 0.0, 0.0, p) for state in zip(s, v, angle, strict=True)])

    return (at_nodes(full) - at_nodes(bare)) / full[RESPONSE]


def held_out_deviances(
    problem: Problem, found: Fit, best: Fit, progress: Progress
) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Deviance of each recording by fits without its fold, without and with the spline term; empty for a single one."""
    if len(problem.recordings) == 1:
        return (), ()
    densities = np.outer((found.process_noise, best.process_noise), _NOISE_RATIOS).ravel()

    def held_out(fold: Fold) -> list[tuple[float, ...]]:
        progress(f"spline term: {fold.title} held out")
        fits = [refit(fold.problem, full) for full in (found, best)]
        return [tuple(_held_out_deviance(fold.problem, one, each, densities) for one in fits) for each in fold.left]

    deviances = itertools.chain.from_iterable(in_threads(held_out, folds(problem)))
    before, after = zip(*deviances, strict=True)
    return before, after


def _held_out_deviance(problem: Problem, fitted: Fit, recording: PreparedRecording, densities: FloatArray) -> float:
    """Deviance of a held-out recording, with its own values fitted to it and the process noise that suits it best."""
    own = own_of(problem, fitted, recording, recording.reading)
    return min(deviance_of(problem, recording, fitted.terms, density, own=own) for density in densities)


def _fit_kinds(problem: Problem, found: Fit, progress: Progress, failures: Failures | None = None) -> list[Fit]:
    """Fits of `found` with a spline term of each kind, best first; only promising screening fits are optimised.

    Args:
        failures: collects kinds that raise, which are then left out; `None` lets them raise.
    """
    steps = (COARSE_STEP, 1.0)

    def noise(kind: Kind) -> float:
        """Process noise that a fit starts with [m²/s³]: an error of the sensor is fitted as if it explained all."""
        return problem.angle_floor**2 if kind.sensor else found.process_noise

    def begin(kind: Kind) -> Hypothesis:
        """With a zero spline term; one of the rolled angle as fitted to one recording, so that each φ₀ can follow, a
        force or an error of position as fine as pays on coarse data, a periodic one with the best period on these."""
        count, (low, high) = problem.settings.spline_nodes, visited(problem, kind.depends)
        if kind.periodic:
            spline = blank(kind, low, low + period_of(problem.coarse, found, low, high), count)
            hypothesis = Hypothesis(found.hypothesis.names, spline)
            coarse = fit(problem.coarse, hypothesis, process_noise=found.process_noise, initial=found.values())
            return coarse.refined
        spline = blank(kind, low, high, count)
        hypothesis = Hypothesis(found.hypothesis.names, spline)
        if kind in (Kind(Regressor.POSITION), Kind(Regressor.POSITION, sensor=True)):
            return _as_fine_as_pays(problem, found, spline, noise(kind))
        if kind.depends is not Regressor.ROLL_ANGLE:
            return hypothesis
        alone = replace(problem, recordings=(max(problem.recordings, key=lambda one: np.isfinite(one.reading).sum()),))
        theta = screen(alone, hypothesis, found.process_noise, found.values(), steps=steps)[0].theta
        return Hypothesis(hypothesis.names, hypothesis.terms(theta, alone).spline)

    def screened(hypothesis: Hypothesis) -> ScreeningFit:
        progress(f"screening: {title(hypothesis)}")
        return screen(problem, hypothesis, noise(_kind(hypothesis)), found.values(), steps=steps)[0]

    def title(hypothesis: Hypothesis) -> str:
        assert hypothesis.spline is not None
        return hypothesis.spline.name

    kinds = fitted_each(begin, KINDS, lambda kind: blank(kind, 0.0, 1.0).name, failures)
    hypotheses = [hypothesis for _, hypothesis in kinds]
    screenings = fitted_each(screened, hypotheses, title, failures)
    gains = [found.deviance - first.expected_deviance for _, first in screenings]
    least = problem.settings.spline_share * max(gains, default=0.0)

    def finish(screening: tuple[Hypothesis, ScreeningFit]) -> Fit:
        hypothesis, first = screening
        if found.deviance - first.expected_deviance < least:
            return unrefined(problem, hypothesis, first)
        return fit(problem, hypothesis, process_noise=noise(_kind(hypothesis)), starts=[first.theta])

    finished = fitted_each(finish, screenings, lambda screening: title(screening[0]), failures)
    return sorted((one for _, one in finished), key=Criterion(problem.settings).value)


def _kind(hypothesis: Hypothesis) -> Kind:
    assert hypothesis.spline is not None
    return hypothesis.spline.kind


def _as_fine_as_pays(problem: Problem, found: Fit, spline: SplineTerm, process_noise: float) -> Hypothesis:
    """With the spline term as fitted to coarse data, with the number of nodes of lowest BIC.

    A ripple that is shorter than the distance of nodes is not seen at all: of it twice the nodes may not pay, but four
    times the nodes.
    """
    coarse, fits, initial = problem.coarse, [], found.values()
    while True:
        hypothesis = Hypothesis(found.hypothesis.names, spline)
        fits.append(fit(coarse, hypothesis, process_noise=process_noise, initial=initial))
        if len(fits) == _HALVINGS[spline.sensor] or not spline.refinable:
            break
        spline = _spline(fits[-1]).finer()
        process_noise, initial = fits[-1].process_noise, fits[-1].values()
    return min(fits, key=Criterion(problem.settings).value).refined


def visited(problem: Problem, depends: Regressor) -> tuple[float, float]:
    """Range of a regressor in the recordings, in its unit; of a measured one without 0.5 % at either end."""
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
