"""Which effects act: found one after the other, tested together, dropped when they no longer pay.

Every step keeps what lowers the deviance, scaled for what it is worth (`Fit.score`), by more than its price: log n for
a number (BIC), and the `threshold` for a choice among many.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial

from analytic.effects import CATALOGUE
from harness.identify.fit import Fit, fit
from harness.identify.hypothesis import Hypothesis
from harness.identify.problem import Problem

THRESHOLD = 6.0  # of the score, beyond which an effect is kept
_NEAR = 3.0  # times the angle's floor
MOST = 4  # effects found beside those declared; more are not told apart by recordings of this length

# Effects whose laws look alike over much of what a rig does: a kept one is held against its relatives once more when
# others have joined it.
FAMILIES = (
    ("rolling_resistance", "directional_resistance", "stribeck_friction", "presliding_hysteresis", "viscous_damping",
     "quadratic_drag"),
    ("rolling_radius", "angle_gain", "position_gain"),
    ("level_error", "track_curvature", "beam_compliance", "track_bump"),
    ("channel_delay", "position_lag", "linkage_backlash"),
)  # fmt: skip

# One law of two numbers that two laws of one number each imitate: on a beam that is not level a resistance differs by
# direction.
SPLITS = {"directional_resistance": ("rolling_resistance", "level_error")}

Progress = Callable[[str], None]


@dataclass(frozen=True)
class Entry:
    """One line of the ledger: what was tried on top of what, what it brought, and what became of it."""

    effect: str
    beside: tuple[str, ...]
    gain: float
    kept: bool
    because: str
    fit: Fit


def candidates(problem: Problem) -> tuple[str, ...]:
    """What can be tried: the catalogue, but for the pivot where the baseline has it."""
    return tuple(name for name in CATALOGUE if not (name == "eccentric_pivot" and problem.model.eccentric))


def select(
    problem: Problem, progress: Progress = lambda _: None, *, threshold: float = THRESHOLD
) -> tuple[Fit, list[Entry]]:
    """Find the effects that the recordings call for.

    Returns:
        The best fit, and every attempt in order.
    """
    best = fit(problem, Hypothesis(()))
    ledger: list[Entry] = []
    while len(best.hypothesis.names) < MOST:
        base = best
        tried = _extend(problem, base, progress, quick=explained(problem, base))
        winner = min(tried, key=lambda one: one.score)
        gain = base.score - winner.score
        for one in sorted(tried, key=lambda one: one.score):
            kept = one is winner and gain > threshold
            ledger.append(_entry(one, base, kept, winner))
        if gain <= threshold:
            break
        best = _settle(problem, winner, ledger, progress, threshold)
    return best, ledger


def explained(problem: Problem, found: Fit) -> bool:
    """Whether what is left is what the angle's own error leaves, or little more."""
    return found.root_density < _NEAR * problem.angle_floor


def _extend(problem: Problem, base: Fit, progress: Progress, *, quick: bool) -> list[Fit]:
    """Every effect that is not there yet, beside those of `base`; a quick look that finds something is made good."""
    names = [name for name in candidates(problem) if name not in base.hypothesis.names]

    def attempt(name: str) -> Fit:
        progress(" + ".join((*base.hypothesis.names, name)))
        names = (*base.hypothesis.names, name)
        found = _fit(problem, names, base, quick=quick)
        return _fit(problem, names, base) if quick and found.score < base.score else found

    return _side_by_side(attempt, names)


def _side_by_side(attempt: Callable[[str], Fit], names: Iterable[str]) -> list[Fit]:
    """All attempts, in order; threads do, because the compiled filter runs without the interpreter's lock."""
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return list(pool.map(attempt, names))


def _settle(problem: Problem, best: Fit, ledger: list[Entry], progress: Progress, threshold: float) -> Fit:
    """Hold each kept effect against its relatives, and drop what no longer pays, until nothing changes."""
    for name, pair in SPLITS.items():
        if name in best.hypothesis.names and not set(pair) & set(best.hypothesis.names):
            rest = tuple(other for other in best.hypothesis.names if other != name)
            progress(f"{' + '.join(pair)} for {name}")
            parted = _fit(problem, (*rest, *pair), best)
            if parted.score < best.score:
                because = f"explain more than {name} did"
                ledger.append(Entry(" + ".join(pair), rest, best.score - parted.score, True, because, parted))
                best = parted
    changed = len(best.hypothesis.names) > 1
    while changed:
        changed = False
        for name in best.hypothesis.names:
            rest = tuple(other for other in best.hypothesis.names if other != name)
            relatives = [o for o in _relatives(name) if o not in rest and o in candidates(problem)]
            progress(f"{name} again")
            without = _fit(problem, rest, best)
            if without.score < best.score + threshold:
                ledger.append(
                    Entry(name, rest, without.score - best.score, False, "no longer pays beside the others", best)
                )
                best, changed = without, True
                break
            swapped = _side_by_side(partial(_instead, problem, rest, best), relatives)
            better = min(swapped, key=lambda one: one.score, default=best)
            if better.score < best.score:
                other = better.hypothesis.names[-1]
                because = f"explains more than {name} did, beside {', '.join(rest)}"
                ledger.append(Entry(other, rest, best.score - better.score, True, because, better))
                best, changed = better, True
                break
    return best


def _fit(problem: Problem, names: Iterable[str], base: Fit, *, quick: bool = False) -> Fit:
    names = tuple(names)
    known = {key: value for key, value in base.values().items() if key[0] in names}
    return fit(problem, Hypothesis(names), density=base.density, known=known, quick=quick)


def _instead(problem: Problem, rest: tuple[str, ...], base: Fit, other: str) -> Fit:
    return _fit(problem, (*rest, other), base)


def _relatives(name: str) -> list[str]:
    return [other for family in FAMILIES if name in family for other in family if other != name]


def _entry(one: Fit, base: Fit, kept: bool, winner: Fit) -> Entry:
    name = one.hypothesis.names[-1]
    gain = base.score - one.score
    if kept:
        because = f"predicts better by {gain:.0f} (scaled BIC)"
    elif gain <= 0.0 or math.isnan(gain):
        because = "does not pay for its parameters"
    elif one is winner:
        because = f"gains {gain:.1f} (scaled BIC), within what chance gives"
    else:
        because = (
            f"gains {gain:.0f} (scaled BIC), {one.score - winner.score:.0f} less than {winner.hypothesis.names[-1]}"
        )
    return Entry(name, base.hypothesis.names, gain, kept, because, one)
