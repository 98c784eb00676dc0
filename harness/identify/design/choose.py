"""Choice of the next experiment: the motion that best discriminates the identified model from its rivals.

After Atkinson and Fedorov, "The design of experiments for discriminating between two rival models", Biometrika 62,
1975: the identified model is taken as true, each rival is fitted to the recording that it predicts, and the motion is
rated by the remaining difference of deviance, at its smallest over all rivals. The rival is fitted to the new recording
alone and the difference is added to that of the existing recordings. This is a lower bound for a diagnosis of all
recordings together, in which the rival has the same parameters and process noise everywhere.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

from analytic.effects import CATALOGUE, Acting
from harness.identify.design.closed_loop import SimulatedRun, simulate_closed_loop, simulate_with_terms
from harness.identify.design.discrimination import SteadyFilters, mean_innovations, open_loop_drift, rival_deviance
from harness.identify.design.excitation import LIBRARY, OperatingEnvelope, Profile, envelope_of
from harness.identify.design.proposal import NOTHING, Proposal, Separation
from harness.identify.estimate.fit import Estimator, Fit
from harness.identify.problem.hypothesis import Terms
from harness.identify.problem.problem import Problem
from harness.identify.selection.criterion import Criterion
from harness.identify.selection.ledger import Line
from harness.threads import in_threads

_ROUNDS, _REFINED = 3, 3  # Gauss–Newton steps for the best motions, and number of these; one step for the others
_WORTH = 0.5  # smallest gain of a separation that counts [σ]: expected and reached separations differ as much
_EQUAL = 1.0  # difference of deviance within which two laws explain the same


@dataclass(frozen=True)
class RivalPair:
    """A rival of the identified model: names of both, its fit, and the separation at which it is distinguished [σ]."""

    found: str
    rival: str
    fit: Fit
    needed: float


def choose_to_discriminate(
    problem: Problem, found: Fit, pairs: Sequence[RivalPair], *, length: float | None = None
) -> Proposal | None:
    """The motion that best separates `found` from all its rivals; `None` if no motion is feasible or adds to that.

    Args:
        pairs: at least one.
        length: of the beam, where it is known [m].
    """
    envelope = envelope_of(problem, length)
    steady_filters = SteadyFilters.of(
        envelope.interval, problem.reading_variance, problem.with_angle(found.process_noise)
    )
    # Fits to free runs are no optima of their deviance, which then tells nothing of the present recordings.
    by_likelihood = found.estimator is Estimator.LIKELIHOOD
    at_hand = [pair.fit.deviance - found.deviance if by_likelihood else 0.0 for pair in pairs]

    def simulate(profile: Profile) -> SimulatedRun | None:
        return simulate_closed_loop(problem, found.terms, found.process_noise, profile, envelope)

    def separate(run: SimulatedRun, rounds: int) -> list[float]:
        new = [rival_deviance(problem, run, pair.fit, steady_filters, rounds=rounds) for pair in pairs]
        return [_sigma(old + more) for old, more in zip(at_hand, new, strict=True)]

    runs = [run for run in in_threads(simulate, LIBRARY) if run is not None]
    if not runs:
        return None
    sigmas = dict(zip(runs, in_threads(partial(separate, rounds=1), runs), strict=True))
    best = sorted(runs, key=lambda run: -min(sigmas[run]))[:_REFINED]
    sigmas |= dict(zip(best, in_threads(partial(separate, rounds=_ROUNDS), best), strict=True))
    chosen = max(best, key=lambda run: min(sigmas[run]))
    separations = tuple(
        Separation(pair.found, pair.rival, _sigma(old), sigma, pair.needed)
        for pair, old, sigma in zip(pairs, at_hand, sigmas[chosen], strict=True)
    )
    if all(one.at_hand >= one.needed and one.expected < one.at_hand + _WORTH for one in separations):
        return None
    tried = {run.recording.name: min(sigmas[run]) for run in runs}
    return _proposal(problem, found, envelope, chosen, separations, tried)


def choose_to_detect(
    problem: Problem, found: Fit, unseen: Sequence[str], *, length: float | None = None
) -> Proposal | None:
    """The motion that reveals most of the effects `unseen` at typical size; `None` if none reveals any.

    The motion is simulated in closed loop with each effect, since the angle for one would let the ball run off with
    another, and the identified model is tested on the result. The new recording has to reveal the effect by itself.

    Args:
        unseen: at least one effect of the catalogue.
        length: of the beam, where it is known [m].
    """
    envelope = envelope_of(problem, length)
    steady_filters = SteadyFilters.of(
        envelope.interval, problem.reading_variance, problem.with_angle(found.process_noise)
    )
    alternatives = [_with_typical_effect(problem, found, name, envelope) for name in unseen]
    criterion = Criterion(problem.settings)
    needed = [criterion.detection_limit(len(envelope.time), len(CATALOGUE[name].parameters)) for name in unseen]

    def simulate(profile: Profile) -> tuple[SimulatedRun, list[float]] | None:
        run = simulate_closed_loop(problem, found.terms, found.process_noise, profile, envelope)
        if run is None:
            return None
        others = (simulate_with_terms(problem, a, found.process_noise, profile, envelope, run) for a in alternatives)
        return run, [_sigma(steady_filters.deviance(mean_innovations(problem, other, found.terms))) for other in others]

    def rating(sigmas: Sequence[float]) -> tuple[int, float]:
        """Number of effects revealed, and the sum of shares of the detection limits for equal numbers."""
        shares = [sigma / limit for sigma, limit in zip(sigmas, needed, strict=True)]
        return sum(share >= 1.0 for share in shares), sum(min(share, 1.0) for share in shares)

    tried = [result for result in in_threads(simulate, LIBRARY) if result is not None]
    if not tried:
        return None
    chosen, sigmas = max(tried, key=lambda result: rating(result[1]))
    if not rating(sigmas)[0]:
        return None
    separations = tuple(
        Separation(name, NOTHING, 0.0, sigma, limit) for name, sigma, limit in zip(unseen, sigmas, needed, strict=True)
    )
    revealed = {run.recording.name: float(rating(each)[0]) for run, each in tried}
    return _proposal(problem, found, envelope, chosen, separations, revealed)


def pairs_of(
    found: Fit, ledger: Sequence[Line], rivals: Mapping[str, Sequence[tuple[str, ...]]], criterion: Criterion
) -> list[RivalPair]:
    """Rivals of `found`: those indistinguishable from its effects, or else the one of lowest criterion.

    Args:
        rivals: the identified effects, each with the sets of effects that are indistinguishable from it.
    """

    def pair(name: str, rival: str, fits: Sequence[Fit]) -> RivalPair:
        nearest = min(fits, key=criterion.value)
        return RivalPair(name, rival, nearest, criterion.rival_separation(nearest, found))

    pairs = []
    for name, sets in rivals.items():
        rest = set(found.hypothesis.names) - {name}
        for rival in sets:
            fits = [line.fit for line in ledger if set(rival) <= set(line.effects) and set(line.beside) == rest]
            if fits:  # an effect replaced in a split was never tried beside the other of the pair
                pairs.append(pair(name, " + ".join(rival), fits))
    tried = (line.fit for line in ledger)
    others = [
        one
        for one in tried
        if one.estimator is found.estimator
        and _only_in(one, found)
        and _only_in(found, one)
        and not _contains(one, found)
    ]
    if not pairs and others:
        nearest = min(others, key=criterion.value)
        pairs.append(pair(" + ".join(_only_in(found, nearest)), " + ".join(_only_in(nearest, found)), [nearest]))
    return pairs


def _contains(fit: Fit, found: Fit) -> bool:
    """Whether a fit with more parameters explains as much, so that no recording would distinguish it."""
    return len(fit.theta) > len(found.theta) and fit.deviance < found.deviance + _EQUAL


def _only_in(fit: Fit, other: Fit) -> list[str]:
    """Names of the terms of `fit` that `other` lacks."""
    names = [name for name in fit.hypothesis.names if name not in other.hypothesis.names]
    spline, theirs = fit.hypothesis.spline, other.hypothesis.spline
    if spline is not None and (theirs is None or spline.kind != theirs.kind):
        names.append(spline.name)
    return names


def _sigma(deviance: float) -> float:
    """Separation √ΔD of a difference of deviance ΔD [σ]."""
    return math.sqrt(max(deviance, 0.0))


def _with_typical_effect(problem: Problem, found: Fit, name: str, envelope: OperatingEnvelope) -> Terms:
    """The identified terms and one more effect of typical size, in the middle of the envelope if it has a place."""
    effect = CATALOGUE[name]
    sizes = {
        p.name: envelope.middle if p.place else p.typical_on(problem.visited, problem.rig) for p in effect.parameters
    }
    return replace(found.terms, effects=(*found.terms.effects, Acting(effect, sizes)))


def _proposal(
    problem: Problem,
    found: Fit,
    envelope: OperatingEnvelope,
    run: SimulatedRun,
    separations: tuple[Separation, ...],
    tried: Mapping[str, float],
) -> Proposal:
    (profile,) = (profile for profile in LIBRARY if profile.name == run.recording.name)
    return Proposal(
        profile,
        run.recording.time,
        run.recording.drive.states[:, 0],
        run.reading,
        separations,
        open_loop_drift(problem, found, run),
        tried,
        envelope,
    )
