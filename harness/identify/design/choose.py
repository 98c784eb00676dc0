"""The next experiment: the move that would best separate what was found from what it cannot be told from.

After Atkinson and Fedorov, "The design of experiments for discriminating between two rival models", Biometrika 62,
1975: the model found is taken for true, each rival's numbers are fitted anew to what it would record, and the move
counts for what is left between them, at its smallest over all rivals. They are fitted to the new recording alone, and
what it brings is added to what the recordings at hand bring. Diagnosed together all recordings bring at least that: a
rival's numbers then have to do for all of them, and what the process noise takes over has to be paid everywhere.
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
from harness.identify.estimate.fit import Fit
from harness.identify.problem.hypothesis import Terms
from harness.identify.problem.problem import Problem
from harness.identify.selection.candidates import in_threads
from harness.identify.selection.criterion import Criterion
from harness.identify.selection.ledger import Line

_ROUNDS, _REFINED = 3, 3  # Gauss–Newton steps of rivals, and on how many of the best moves; on the others one step
_WORTH = 0.5  # σ, as far as expected and reached separations differ: a smaller gain is none
_EQUAL = 1.0  # of the deviance, within which two laws explain the same


@dataclass(frozen=True)
class RivalPair:
    """A rival of the model found: what is to be told from what, its fit, and the σ from which on it is told."""

    found: str
    rival: str
    fit: Fit
    needed: float


def choose_to_discriminate(
    problem: Problem, found: Fit, pairs: Sequence[RivalPair], *, length: float | None = None
) -> Proposal | None:
    """The move that separates `found` best from all its rivals; `None` where none is left to make that would tell more.

    Args:
        pairs: at least one.
        length: of the beam, where it is known [m].
    """
    envelope = envelope_of(problem, length)
    steady_filters = SteadyFilters.of(envelope.interval, problem.reading_variance, found.process_noise)
    at_hand = [pair.fit.deviance - found.deviance for pair in pairs]

    def attempt(profile: Profile) -> SimulatedRun | None:
        return simulate_closed_loop(problem, found.terms, found.process_noise, profile, envelope)

    def apart(made: SimulatedRun, rounds: int) -> list[float]:
        new = [rival_deviance(problem, made, pair.fit, steady_filters, rounds=rounds) for pair in pairs]
        return [_sigma(problem, old + more) for old, more in zip(at_hand, new, strict=True)]

    simulated = [one for one in in_threads(attempt, LIBRARY) if one is not None]
    if not simulated:
        return None
    looked = dict(zip(simulated, in_threads(partial(apart, rounds=1), simulated), strict=True))
    best = sorted(simulated, key=lambda one: -min(looked[one]))[:_REFINED]
    looked |= dict(zip(best, in_threads(partial(apart, rounds=_ROUNDS), best), strict=True))
    chosen = max(best, key=lambda one: min(looked[one]))
    separations = tuple(
        Separation(pair.found, pair.rival, _sigma(problem, old), sigma, pair.needed)
        for pair, old, sigma in zip(pairs, at_hand, looked[chosen], strict=True)
    )
    if all(one.at_hand >= one.needed and one.expected < one.at_hand + _WORTH for one in separations):
        return None
    tried = {one.recording.name: min(looked[one]) for one in simulated}
    return _proposal(problem, found, envelope, chosen, separations, tried)


def choose_to_detect(
    problem: Problem, found: Fit, unseen: Sequence[str], *, length: float | None = None
) -> Proposal | None:
    """The move that lets most of the effects `unseen` be seen at typical size; `None` where none shows any.

    Each effect makes the move in its own closed loop, for a ball with a level error would run off on the angle of
    another, and the model found is held against what it leaves. The recordings at hand are left out: the new one has to
    show the effect by itself.

    Args:
        unseen: at least one effect of the catalogue.
        length: of the beam, where it is known [m].
    """
    envelope = envelope_of(problem, length)
    steady_filters = SteadyFilters.of(envelope.interval, problem.reading_variance, found.process_noise)
    typical = [_typical(found, name, envelope) for name in unseen]
    criterion = Criterion(problem.settings)
    needed = [criterion.detection_limit(len(envelope.time), len(CATALOGUE[name].parameters)) for name in unseen]

    def attempt(profile: Profile) -> tuple[SimulatedRun, list[float]] | None:
        made = simulate_closed_loop(problem, found.terms, found.process_noise, profile, envelope)
        if made is None:
            return None
        others = (simulate_with_terms(problem, one, found.process_noise, profile, envelope, made) for one in typical)
        return made, [
            _sigma(problem, steady_filters.deviance(mean_innovations(problem, one, found.terms))) for one in others
        ]

    def worth(sigmas: Sequence[float]) -> tuple[int, float]:
        shares = [one / enough for one, enough in zip(sigmas, needed, strict=True)]
        return sum(share >= 1.0 for share in shares), sum(min(share, 1.0) for share in shares)

    tried = [one for one in in_threads(attempt, LIBRARY) if one is not None]
    if not tried:
        return None
    chosen, sigmas = max(tried, key=lambda one: worth(one[1]))
    if not worth(sigmas)[0]:
        return None
    separations = tuple(
        Separation(name, NOTHING, 0.0, sigma, enough)
        for name, sigma, enough in zip(unseen, sigmas, needed, strict=True)
    )
    return _proposal(
        problem, found, envelope, chosen, separations, {m.recording.name: float(worth(s)[0]) for m, s in tried}
    )


def pairs_of(
    found: Fit, ledger: Sequence[Line], indistinguishable: Mapping[str, Sequence[str]], criterion: Criterion
) -> list[RivalPair]:
    """What `found` is to be told from: the rivals of each effect that are not told apart, or else the nearest one.

    Args:
        indistinguishable: effects that were found, each with its rivals.
        criterion: by which two explanations are told apart.
    """

    def pair(name: str, rival: str, fits: Sequence[Fit]) -> RivalPair:
        nearest = min(fits, key=criterion.value)
        return RivalPair(name, rival, nearest, criterion.rival_separation(nearest, found))

    pairs = []
    for name, rivals in indistinguishable.items():
        rest = set(found.hypothesis.names) - {name}
        for rival in rivals:
            fits = [one.fit for one in ledger if rival in one.effects and set(one.beside) == rest]
            if fits:  # what a split replaced was never tried beside what came of it
                pairs.append(pair(name, rival, fits))
    others = [one.fit for one in ledger if _own(one.fit, found) and _own(found, one.fit) and not _holds(one.fit, found)]
    if not pairs and others:
        nearest = min(others, key=criterion.value)
        pairs.append(pair(" + ".join(_own(found, nearest)), " + ".join(_own(nearest, found)), [nearest]))
    return pairs


def _holds(one: Fit, found: Fit) -> bool:
    """Whether a law of more numbers explains as much: it holds what was found, and no recording tells them apart."""
    return len(one.theta) > len(found.theta) and one.deviance < found.deviance + _EQUAL


def _own(one: Fit, other: Fit) -> list[str]:
    """What `one` has and `other` has not."""
    mine = [name for name in one.hypothesis.names if name not in other.hypothesis.names]
    spline, theirs = one.hypothesis.spline, other.hypothesis.spline
    if spline is not None and (
        theirs is None or (spline.depends, spline.friction) != (theirs.depends, theirs.friction)
    ):
        mine.append(spline.name)
    return mine


def _sigma(problem: Problem, deviance: float) -> float:
    """Standard deviations that a difference of deviances stands for."""
    return math.sqrt(max(deviance, 0.0) / problem.settings.overdispersion)


def _typical(found: Fit, name: str, envelope: OperatingEnvelope) -> Terms:
    """What was found with one more effect of typical size, in the middle of the room where it has a place."""
    effect = CATALOGUE[name]
    sizes = {one.name: envelope.middle if one.place else one.typical for one in effect.parameters}
    return replace(found.terms, effects=(*found.terms.effects, Acting(effect, sizes)))


def _proposal(
    problem: Problem,
    found: Fit,
    envelope: OperatingEnvelope,
    made: SimulatedRun,
    separations: tuple[Separation, ...],
    tried: Mapping[str, float],
) -> Proposal:
    (profile,) = (one for one in LIBRARY if one.name == made.recording.name)
    return Proposal(
        profile,
        made.recording.time,
        made.recording.drive.states[:, 0],
        made.reading,
        separations,
        open_loop_drift(problem, found, made),
        tried,
        envelope,
    )
