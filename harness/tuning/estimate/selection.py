"""Which parameters to tune: screening by sensitivity, then forward selection, each step judged by one criterion.

A parameter enters if it lowers the BIC (Schwarz, Ann. Statist. 6, 1978) by more than `KEEP`, with the deviance over the
factor by which residuals exceed what noise and angle error explain, the one that widens intervals: what pays then is
surely not its default. It is the threshold of a diagnosis for an effect.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from analytic.motion import FloatArray
from harness.errors import EngineFailure
from harness.formatting import number
from harness.jobs import gathered
from harness.progress import Progress, silent
from harness.tuning.estimate.fit import Fitted, Objective, best_begin, deviance_of, fit
from harness.tuning.estimate.free import LEVEL
from harness.tuning.estimate.runs import Model, known_positions
from harness.tuning.estimate.windows import Stretch

KEEP = 6.0
"""Decrease of the BIC from which a parameter is tuned."""
SEEN = 4.0
"""Squared change of the runs, in standard deviations of what cannot be foreseen, from which a parameter is seen."""
_FITTED = 3  # candidates that are fitted in each step: those that promise most
_PROMISING = 0.5  # share of the decrease that the criterion asks for, from which on a predicted one is worth a fit
_SHARE = 0.2  # of the largest predicted decrease that a candidate has to promise to be fitted in the same step
_STARTS = 2  # values from which the fit of the best candidate begins


@dataclass(frozen=True)
class Screened:
    """A parameter after the screening.

    Attributes:
        name: of the parameter.
        sensitivity: largest change of the runs over the values tried, starts and level fitted, as a root sum of squares
            in standard deviations of what noise and angle error let them differ by [1]; below 2 it is not seen.
        tried: the values.
        begin: those of them from which to fit, most promising first.
        gain: decrease of the deviance that a line from the default to the most promising one predicts.
        response: change of the whitened runs at the most visible value, starts projected out, shape (readings,).
        at: that value.
        failed: of the values tried, those with which the engine does not run through every window.
        failure: how it fails with the first of these.
    """

    name: str
    sensitivity: float
    tried: tuple[float, ...]
    begin: tuple[float, ...]
    gain: float
    response: FloatArray
    at: float
    failed: tuple[float, ...] = ()
    failure: EngineFailure | None = None

    @property
    def seen(self) -> bool:
        """Whether the recordings tell the parameter at all."""
        return self.sensitivity**2 >= SEEN


@dataclass(frozen=True)
class Attempt:
    """One parameter tried: by how much it lowered the deviance and the BIC, and what was decided."""

    name: str
    beside: tuple[str, ...]
    deviance: float
    bic: float
    kept: bool
    why: str


@dataclass(frozen=True)
class Selection:
    """What was selected.

    Attributes:
        before: fit of the windows' starts alone, everything else at its default.
        found: fit of the selected parameters and of the level angle.
        screened: every parameter, by name.
        attempts: every fit that was compared.
        pays: names of what pays, the level angle among them if it does.
    """

    before: Fitted
    found: Fitted
    screened: Mapping[str, Screened]
    attempts: tuple[Attempt, ...]
    pays: tuple[str, ...]


def select(
    model: Model,
    windows: Sequence[Stretch],
    names: Sequence[str],
    progress: Progress = silent,
    levelled: float | None = None,
) -> Selection:
    """Select the parameters that pay, beginning with none.

    Args:
        model: with all that may be tuned.
        windows: to fit to.
        names: of the parameters to try, beside the level angle.
        levelled: a level angle to begin from beside the given one, such as that of another model [rad].

    Raises:
        EngineFailure: the engine fails with its defaults.
    """
    level = model.free[LEVEL]
    given = {LEVEL: float(level.default or 0.0)}
    progress("engine at its defaults", share=0.0)
    # Free runs over 10 s of a ball that friction stops at other places than the beam's true level would have many
    # minima over the level; the filter, which follows the readings, has one.
    begins = [given] if levelled is None else [given, {LEVEL: min(max(levelled, level.low), level.high)}]
    found = fit(model, windows, [level], *best_begin(model, windows, [level], begins))
    before = fit(model, windows, [], {}, found.starts, fixed=given)
    attempts: list[Attempt] = []
    screened: dict[str, Screened] = {}
    rest = list(names)
    for step in range(len(names) + 1):
        progress(
            f"screening of {', '.join(rest)}" if rest else "all parameters tried",
            share=0.1 + 0.6 * step / (len(names) + 1),
        )
        now = screen(model, windows, found, rest)
        screened = {**screened, **({name: one for name, one in now.items() if name not in screened})}
        asked = found.inflation * (KEEP + math.log(len(found.residual)))
        promising = [one for one in now.values() if one.seen and one.gain > _PROMISING * asked]
        promising = sorted(promising, key=lambda one: -one.gain)[:_FITTED]
        worth = [one for one in promising if one.gain >= _SHARE * promising[0].gain]
        fits = _fits_with(model, windows, found, [(one.name, one.begin[0]) for one in worth], progress)
        if not fits:
            break
        best = min(fits, key=lambda name: fits[name].deviance)
        if not fits[best].complete:
            again = _fits_with(model, windows, found, [(best, value) for value in now[best].begin[1:]], progress)
            fits |= {name: made for name, made in again.items() if made.deviance < fits[name].deviance}
        decisions = [attempt(name, found, made, kept=name == best) for name, made in fits.items()]
        attempts += decisions
        if not any(one.kept for one in decisions):
            break
        found = fits[best]
        rest.remove(best)
    found, dropped = _without_idle(model, windows, found)
    attempts += dropped
    others = [one for one in found.free if one.name != LEVEL]
    level_fixed = fit(model, windows, others, found.values, found.starts, fixed=given) if others else before
    about_level = attempt(LEVEL, level_fixed, found, kept=True)
    pays = tuple(one.name for one in others) + ((LEVEL,) if about_level.kept else ())
    return Selection(before, found, screened, (*attempts, about_level), pays)


def attempt(name: str, without: Fitted, with_: Fitted, *, kept: bool) -> Attempt:
    """The decision on one parameter more.

    Args:
        without, with_: fits without and with it.
        kept: whether it is to be kept if it pays; otherwise another one paid more.
    """
    deviance = (without.deviance - with_.deviance) / with_.inflation
    bic = deviance - math.log(len(with_.residual))
    pays = bic > KEEP
    why = f"lowers the BIC by {number(bic)}" if bic > 0.0 else f"does not lower the BIC (+{number(-bic)})"
    if pays and not kept:
        why += ", but another parameter by more"
    elif not pays:
        why += f", and it takes {KEEP:g}"
    return Attempt(name, without.names, deviance, bic, pays and kept, why)


def screen(model: Model, windows: Sequence[Stretch], found: Fitted, names: Sequence[str]) -> dict[str, Screened]:
    """How far each parameter moves the runs beyond what the fitted ones do, and what it promises."""
    objective = Objective(model, windows, found.free, {})
    x = np.concatenate(([one.scaled(found.values[one.name]) for one in found.free], found.starts.ravel()))
    slopes = objective.jacobian(x)[:, len(found.free) :]
    requests = [(name, value) for name in names for value in model.free[name].tried]
    runs = model.runs(windows, [({**found.values, name: value}, found.starts) for name, value in requests])
    here = model.runs(windows, [(found.values, found.starts)])[0]
    projected = objective.projected(found.residual[:, None], slopes)[:, 0]
    basis = np.linalg.qr(found.jacobian)[0] if found.jacobian.size else np.zeros((len(projected), 0))
    made = {}
    for name in names:
        each: list[tuple[float, float, float, FloatArray]] = []
        failed = []
        for (one, value), run in zip(requests, runs, strict=True):
            if one != name:
                continue
            through = [bool(np.isfinite(known_positions(part)).all()) for part in run]
            if not all(through):
                failed.append(value)
            if not any(through):
                continue
            moved = np.concatenate(
                [w.whitened(a - b) * t for w, a, b, t in zip(windows, run, here, through, strict=True)]
            )
            response = objective.projected(moved[:, None], slopes)[:, 0]
            beyond = response - basis @ (basis.T @ response)
            size = float(beyond @ beyond)
            share = min(max(float(projected @ beyond) / size, 0.0), 1.0) if size > 0.0 else 0.0
            gain = deviance_of(projected) - deviance_of(projected - share * beyond)
            each.append((gain, size, value, response))
        tried = tuple(sorted(value for one, value in requests if one == name))
        failure = model.failed(windows, {**found.values, name: failed[0]}, found.starts) if failed else None
        if not each:
            if tried:
                nothing = np.zeros(len(projected))
                made[name] = Screened(name, 0.0, tried, (), 0.0, nothing, tried[0], tuple(failed), failure)
            continue
        ordered = sorted(each, key=lambda one: -one[0])
        plainest = max(each, key=lambda one: one[1])
        made[name] = Screened(
            name, math.sqrt(plainest[1]), tried, tuple(one[2] for one in ordered[:_STARTS]), ordered[0][0],
            plainest[3], plainest[2], tuple(failed), failure,
        )  # fmt: skip
    return made


def _fits_with(
    model: Model,
    windows: Sequence[Stretch],
    found: Fitted,
    wanted: Sequence[tuple[str, float]],
    progress: Progress,
) -> dict[str, Fitted]:
    """The best fit with one parameter more, by its name.

    Args:
        wanted: names, each with the value from which to begin; where the engine fails at the end of a fit, it is none.
    """
    if model.executor is None:
        made = []
        for name, value in wanted:
            progress(f"fit of {', '.join((*found.names, name))}")
            made.append(_fit_with(model, windows, found, name, value))
    else:
        progress(f"fits of {', '.join(dict.fromkeys(name for name, _ in wanted))}")
        made = gathered(
            model.executor, [partial(_fit_with, model.alone, windows, found, name, value) for name, value in wanted]
        )
    best: dict[str, Fitted] = {}
    for (name, _), one in zip(wanted, made, strict=True):
        if one is not None and (name not in best or one.deviance < best[name].deviance):
            best[name] = one
    return best


def _fit_with(model: Model, windows: Sequence[Stretch], found: Fitted, name: str, value: float) -> Fitted | None:
    """The fit with one parameter more from this value; `None` where the engine fails with what comes out."""
    try:
        return fit(model, windows, [*found.free, model.free[name]], {**found.values, name: value}, found.starts)
    except EngineFailure:
        return None


def _without_idle(model: Model, windows: Sequence[Stretch], found: Fitted) -> tuple[Fitted, list[Attempt]]:
    """The fit without parameters that no longer pay beside those which entered later."""
    attempts = []
    for one in found.free[1:-1]:  # the level stays, and the last one has just paid
        rest = [other for other in found.free if other.name != one.name]
        values = {name: value for name, value in found.values.items() if name != one.name}
        without = fit(model, windows, rest, values, found.starts)
        decision = attempt(one.name, without, found, kept=True)
        attempts.append(decision)
        if not decision.kept:
            found = without
    return found, attempts
