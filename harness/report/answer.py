"""The answer in words: which model to trust, how far, why, and what to do next. Every word follows from a number."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from analytic.models import CAM
from harness.comparison.horizons import Horizon
from harness.comparison.study import Study
from harness.formatting import brief, length, number, plus_minus
from harness.report.palette import label_of, names
from harness.report.standing import COVERAGE, Standing, standings

_AGREES = 0.1  # of u_val: an engine this close to CAM adds nothing to the error
_FOLLOWS = 0.5  # of the still ball's error: a source that errs by more has a fit below 50 %
_MANY = 3  # more names than this are counted, not listed


@dataclass(frozen=True)
class EngineFact:
    """One engine beside CAM on the headline horizon.

    Attributes:
        source: its name.
        departure: largest |s_engine − s_CAM|; NaN if no run succeeded [m].
        numerical, contact: RMS of these parts of its free run's error; NaN if they could not be split [m].
        failed: advice of its first failure; empty if it has none.
    """

    source: str
    departure: float
    numerical: float = math.nan
    contact: float = math.nan
    failed: str = ""


@dataclass(frozen=True)
class Facts:
    """What the answer is made from.

    Attributes:
        recording: what it is called: "the recording" or "the simulated recording".
        case: path to give to a command.
        seconds: length of the headline horizon's windows, `None` for the whole recording [s].
        duration: of the whole free run [s].
        standings: of all sources on the headline horizon, the closest first.
        over_uncertainty: RMS of E/u_val of the closest [1].
        u_val: RMS of u_val on the headline horizon [m].
        still: error of a ball that stays at its mean place in each run, RMS [m].
        end_u_val, motion: u_val at the end of the whole free run, and the ball's RMS motion in it [m].
        engines: one each.
        shorter: the longest of the shorter horizons on which a source follows the motion: its seconds, source and
            RMS error; `None` if there is none.
        declared: names of effects known to act, which every model here has.
    """

    recording: str
    case: str
    seconds: float | None
    duration: float
    standings: Sequence[Standing]
    over_uncertainty: float
    u_val: float
    still: float
    end_u_val: float
    motion: float
    engines: Sequence[EngineFact] = ()
    shorter: tuple[float, str, float] | None = None
    declared: Sequence[str] = ()


def is_simulated(study: Study) -> bool:
    """Whether the recording's origin says that it was simulated."""
    return (study.setting.case.origin or "").lower().startswith("simulated")


def facts_of(study: Study) -> Facts:
    """Collect from a study what the answer needs."""
    setting, headline = study.setting, study.headline
    whole = setting.horizons[0]
    ranked = standings(study, headline)
    return Facts(
        recording="the simulated recording" if is_simulated(study) else "the recording",
        case=str(setting.case.path),
        seconds=headline.seconds,
        duration=float(setting.time[-1] - setting.time[whole.first[0]]),
        standings=ranked,
        over_uncertainty=study.score_of(ranked[0].source, headline).rms_error_over_uncertainty,
        u_val=_pooled(study.u_val_of(headline)),
        still=still_error(study, headline),
        end_u_val=float(study.u_val_of(whole)[0, whole.last[0]]),
        motion=float(np.std(setting.ball.position[whole.slices()[0]])),
        engines=[_engine_fact(study, engine.name) for engine, _ in study.engines],
        shorter=_shorter(study),
        declared=[effect.name for effect in setting.case.declared],
    )


def answer(study: Study) -> tuple[str, ...]:
    """The answer to "which model can I trust on this recording?", in two to four sentences."""
    return sentences(facts_of(study))


def sentences(facts: Facts) -> tuple[str, ...]:
    """The words for `facts`; the first sentence names the closest source."""
    said = [_closest(facts), _uncertainty(facts), _engines(facts), _horizon(facts)]
    return tuple(text[:1].upper() + text[1:] for text in said if text)


def still_error(study: Study, horizon: Horizon) -> float:
    """RMS error of a ball that stays at its mean place in each run [m]: what any model has to beat."""
    position, use = study.setting.recording.position, study.setting.ball.trusted
    pieces = [position[where][use[where]] for where in horizon.slices()]
    return float(np.sqrt(np.mean(np.concatenate([piece - np.mean(piece) for piece in pieces]) ** 2)))


def horizon_text(seconds: float | None, duration: float) -> str:
    """`over windows of 5 s`, `over the whole 16 s`."""
    return f"over the whole {brief(duration)} s" if seconds is None else f"over windows of {seconds:g} s"


def _closest(facts: Facts) -> str:
    best, where = facts.standings[0], horizon_text(facts.seconds, facts.duration)
    error = f"{plus_minus(1e3 * best.rms, 1e3 * best.std)} mm RMS"
    if not math.isfinite(best.rms):
        return f"No source gave a finite motion {where}."
    if best.rms > _FOLLOWS * facts.still:
        beside = "more" if best.rms >= facts.still else "not much less"
        text = (
            f"No source follows {facts.recording} {where}: even the closest, {label_of(best.source)}, errs by {error}, "
            f"{beside} than a ball that stayed in place ({number(1e3 * facts.still)} mm)"
        )
        if facts.shorter is not None:
            seconds, source, rms = facts.shorter
            text += f"; {horizon_text(seconds, 0.0)} the closest is {label_of(source)} with {number(1e3 * rms)} mm"
        return text + "."
    same = [one.source for one in facts.standings if one.same]
    is_closest = f"{names(same)} {'are' if len(same) > 1 else 'is'} closest to {facts.recording}"
    text = f"{is_closest} {where}: {error}"
    if len(same) > 1:
        text += f" ({'both' if len(same) == 2 else 'all'} give the same motion)"
    rivals = [one for one in facts.standings if not one.same]
    equal = [one.source for one in rivals if not one.separated]
    if equal:
        who = names(equal) if len(equal) <= _MANY else f"{len(equal)} others"
        return (
            f"{text}; {who} cannot be told from {'them' if len(same) > 1 else 'it'} with this recording's uncertainty."
        )
    if rivals:
        return f"{text}, ahead of the next, {label_of(rivals[0].source)} ({_mm(rivals[0].rms)}), beyond doubt."
    return text + "."


def _uncertainty(facts: Facts) -> str:
    best = facts.standings[0]
    if not math.isfinite(best.rms):
        return ""
    floor = f"what angle, start and sensor leave open ({_mm(facts.u_val)} RMS)"
    ratio = number(facts.over_uncertainty, 2)
    if facts.over_uncertainty <= COVERAGE:
        return (
            f"Its error is within {floor}: E/u_val is {ratio}, where a perfect model has about 1, so runs of this "
            "length hold no evidence against it; a finer angle sensor, or shorter windows, would tell more."
        )
    known = f" beyond the declared {_list(facts.declared)}" if facts.declared else ""
    return (
        f"Stamp by stamp its error is {ratio} times {floor}: the models lack physics{known}; `harness diagnose "
        f"{facts.case}` looks for it."
    )


def _engines(facts: Facts) -> str:
    failed = [one for one in facts.engines if one.failed]
    sound = [one for one in facts.engines if math.isfinite(one.departure) and not one.failed]
    near = [one for one in sound if one.departure <= _AGREES * facts.u_val]
    said = [f"{label_of(one.source)} failed: {one.failed}" for one in failed]
    if near:
        worst = max(one.departure for one in near)
        verb = "repeat" if len(near) > 1 else "repeats"
        said.append(
            f"{names([one.source for one in near])} {verb} {label_of(CAM.name)} within {length(worst, 2)}, so "
            "step size and contact model add nothing to the error"
        )
    for one in sound:
        if one in near:
            continue
        part = ""
        if math.isfinite(one.numerical):
            numeric = one.numerical >= one.contact
            part = (
                ", mostly from its step size (lower it)" if numeric else ", mostly from its contact model (stiffen it)"
            )
        said.append(
            f"{label_of(one.source)} departs from {label_of(CAM.name)} by up to {length(one.departure, 2)}{part}"
        )
    return "; ".join(said) + "." if said else ""


def _horizon(facts: Facts) -> str:
    end, motion = _mm(facts.end_u_val), _mm(facts.motion)
    whole = f"The free run over the whole {brief(facts.duration)} s"
    if facts.seconds is None:
        return (
            f"{whole} is a fair test: at its end the inputs leave {end} open, and the ball's own motion is "
            f"{motion} RMS."
        )
    return (
        f"{whole} is no test of a model: by its end the errors of angle and start alone can move the ball by {end}, "
        f"against {motion} RMS of real motion."
    )


def _engine_fact(study: Study, name: str) -> EngineFact:
    runs, cam = study.run_of(name, study.headline), study.run_of(CAM.name, study.headline)
    away = np.abs(runs.position - cam.position)
    split = next((one.rms() for one in study.attributions if one.source == name), {})
    failures = [failure for failure in study.failures if failure.engine == name]
    return EngineFact(
        source=name,
        departure=float(np.nanmax(away)) if np.isfinite(away).any() else math.nan,
        numerical=split.get("numerical", math.nan),
        contact=split.get("contact", math.nan),
        failed=str(failures[0]).removeprefix(f"{name} failed ") if failures else "",
    )


def _shorter(study: Study) -> tuple[float, str, float] | None:
    horizons = study.setting.horizons
    limit = math.inf if study.headline.seconds is None else study.headline.seconds
    for horizon in sorted(horizons[1:], key=lambda one: -(one.seconds or 0.0)):
        seconds = horizon.seconds
        if seconds is None or seconds >= limit:
            continue
        best = standings(study, horizon)[0]
        if best.rms <= _FOLLOWS * still_error(study, horizon):
            return seconds, best.source, best.rms
    return None


def _pooled(values: np.ndarray) -> float:
    return float(np.sqrt(np.nanmean(values**2)))


def _mm(value: float) -> str:
    return f"{number(1e3 * value)} mm" if math.isfinite(value) else "∞"


def _list(items: Sequence[str]) -> str:
    return ", ".join(item.replace("_", " ") for item in items)
