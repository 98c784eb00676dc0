"""The conclusions of the comparison report in words: closest model, uncertainty, engines, headline horizon."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from analytic.models import CAM
from harness.comparison.horizons import Horizon
from harness.comparison.study import Study
from harness.engines.parameters import EngineParameters
from harness.formatting import brief, length, listed, number, plus_minus
from harness.numerics import rms
from harness.recording.case import typed_path
from harness.report.palette import label_of, names
from harness.report.standing import COVERAGE, Standing, standings

_AGREEMENT = 0.1  # of u_val: largest difference from CAM at which an engine adds no error
_MAX_RELATIVE_ERROR = 0.5  # of the stationary ball's error, hence a fit above 50 %
_MAX_NAMES = 3  # more names are counted instead of listed


@dataclass(frozen=True)
class EngineFact:
    """One engine compared with CAM on the headline horizon.

    Attributes:
        source: its name.
        departure: largest |s_engine − s_CAM|; NaN if no run succeeded [m].
        numerical, contact: RMS of these parts of its free run's error; NaN without attribution [m].
        failed: message of its first failure, else empty.
        chosen: its contact parameters that are not at their defaults, in words.
        scene: file of the user's scene that it runs, else empty.
    """

    source: str
    departure: float
    numerical: float = math.nan
    contact: float = math.nan
    failed: str = ""
    chosen: Sequence[str] = ()
    scene: str = ""


@dataclass(frozen=True)
class Facts:
    """Numbers from which the conclusions are derived.

    Attributes:
        recording: "the recording" or "the simulated recording".
        case: path of the case, for a command.
        seconds: window length of the headline horizon, `None` for the whole recording [s].
        duration: of the free run [s].
        standings: of all sources on the headline horizon, the closest first.
        over_uncertainty: RMS of E/u_val of the closest [1].
        u_val: RMS of u_val on the headline horizon [m].
        still: RMS error of a ball that stays at its mean position in each run [m].
        end_u_val, motion: u_val at the end of the free run, and standard deviation of the ball's position in it [m].
        engines: one each.
        shorter: the longest of the shorter horizons on which a source has a fit above 50 %: its seconds, source and
            RMS error; `None` if there is none.
        declared: names of the declared effects, included in every model.
        lift_offs: sources in whose runs the ball lifts off, in words, with the first instant and what happens there.
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
    lift_offs: Sequence[tuple[str, str]] = ()


def facts_of(study: Study) -> Facts:
    """The facts of a study."""
    setting, headline = study.setting, study.headline
    whole = setting.horizons[0]
    ranked = standings(study, headline)
    return Facts(
        recording="the simulated recording" if setting.case.simulated else "the recording",
        case=str(typed_path(setting.case.path)),
        seconds=headline.seconds,
        duration=float(setting.time[-1] - setting.time[whole.first[0]]),
        standings=ranked,
        over_uncertainty=study.score_of(ranked[0].source, headline).rms_error_over_uncertainty,
        u_val=study.floor(headline),
        still=still_error(study, headline),
        end_u_val=float(study.u_val_of(whole)[-1]),
        motion=float(np.std(setting.ball.position[whole.slices()[0]])),
        engines=[_engine_fact(study, engine.name) for engine, _ in study.engines],
        shorter=_shorter(study),
        declared=[effect.name for effect in setting.case.declared],
        lift_offs=_lift_offs(study),
    )


def answer(study: Study) -> tuple[str, ...]:
    """Which model is valid on this recording, in two to four sentences."""
    return sentences(facts_of(study))


def sentences(facts: Facts) -> tuple[str, ...]:
    """The sentences for `facts`; the first names the closest source."""
    said = [_closest(facts), _uncertainty(facts), _engines(facts), _horizon(facts)]
    return tuple(text[:1].upper() + text[1:] for text in said if text)


def still_error(study: Study, horizon: Horizon) -> float:
    """RMS error of a ball that stays at its mean position in each run [m], the trivial prediction."""
    position, use = study.setting.recording.position, study.setting.ball.trusted
    pieces = [position[where][use[where]] for where in horizon.slices()]
    return rms(np.concatenate([piece - np.mean(piece) for piece in pieces]))


def horizon_text(seconds: float | None, duration: float) -> str:
    """`over windows of 5 s`, `over the whole 16 s`."""
    return f"over the whole {brief(duration)} s" if seconds is None else f"over windows of {seconds:g} s"


def _closest(facts: Facts) -> str:
    best, where = facts.standings[0], horizon_text(facts.seconds, facts.duration)
    error = f"{plus_minus(1e3 * best.rms, 1e3 * best.std)} mm RMS"
    if not math.isfinite(best.rms):
        return f"All sources diverge {where}."
    if best.rms > _MAX_RELATIVE_ERROR * facts.still:
        relation = "more" if best.rms >= facts.still else "not much less"
        text = (
            f"No source follows {facts.recording} {where}: even the closest, {label_of(best.source)}, has an error of "
            f"{error}, {relation} than a stationary ball ({number(1e3 * facts.still)} mm)"
        )
        if facts.shorter is not None:
            seconds, source, error_m = facts.shorter
            text += f"; {horizon_text(seconds, 0.0)} the closest is {label_of(source)} with {_mm(error_m)}"
        return text + "."
    same = [one.source for one in facts.standings if one.same]
    is_closest = f"{names(same)} {'are' if len(same) > 1 else 'is'} closest to {facts.recording}"
    text = f"{is_closest} {where}: {error}"
    if len(same) > 1:
        text += f" ({'both' if len(same) == 2 else 'all'} give the same motion)"
    rivals = [one for one in facts.standings if not one.same]
    equal = [one.source for one in rivals if not one.separated]
    if equal:
        who = names(equal) if len(equal) <= _MAX_NAMES else f"{len(equal)} others"
        return (
            f"{text}; with this recording's uncertainty {who} cannot be distinguished from "
            f"{'them' if len(same) > 1 else 'it'}."
        )
    if rivals:
        return f"{text}, significantly less than the next, {label_of(rivals[0].source)} ({_mm(rivals[0].rms)})."
    return text + "."


def _uncertainty(facts: Facts) -> str:
    best = facts.standings[0]
    if not math.isfinite(best.rms):
        return ""
    floor = f"the uncertainty of angle, start and sensor ({_mm(facts.u_val)} RMS)"
    ratio = number(facts.over_uncertainty, 2)
    if facts.over_uncertainty <= COVERAGE:
        times = "twice " if facts.over_uncertainty > 1.0 else ""
        return (
            f"Its error is within {times}{floor}: E/u_val is {ratio}, and about 1 for a perfect model, so runs of this "
            "length are no evidence against it; a finer angle sensor or shorter windows would be more informative."
        )
    known = f" beyond the declared {_list(facts.declared)}" if facts.declared else ""
    return (
        f"Instant by instant its error is {ratio} times (RMS) {floor}: the models lack physics{known}; "
        f"`harness diagnose {facts.case}` identifies it."
    )


def _engines(facts: Facts) -> str:
    failed = [one for one in facts.engines if one.failed]
    sound = [one for one in facts.engines if math.isfinite(one.departure) and not one.failed]
    near = [one for one in sound if one.departure <= _AGREEMENT * facts.u_val]
    by_text: dict[str, list[str]] = {}
    for one in failed:
        by_text.setdefault(one.failed, []).append(one.source)
    said = [f"{names(sources)} failed: {text}" for text, sources in by_text.items()]
    said += [f"in {who}, at {text}" for who, text in facts.lift_offs]
    if near:
        worst = max(one.departure for one in near)
        verb = "agree" if len(near) > 1 else "agrees"
        said.append(
            f"{names(one.source for one in near)} {verb} with {label_of(CAM.name)} within {length(worst, 2)}, so "
            "step size and contact model do not contribute to the error"
        )
    for one in sound:
        if one in near:
            continue
        part = ""
        if math.isfinite(one.numerical):
            numeric = one.numerical >= one.contact
            stiffness = f"with its {listed(one.chosen)}" if one.chosen else "(stiffen it)"
            cause = "its step size (reduce it)" if numeric else f"its contact model {stiffness}"
            if one.scene and not numeric:
                cause = f"the geometry or the contacts of {one.scene} (`harness check-scene {facts.case}`)"
            part = f", mostly due to {cause}"
        said.append(
            f"{label_of(one.source)} differs from {label_of(CAM.name)} by up to {length(one.departure, 2)}{part}"
        )
    return "; ".join(said) + "." if said else ""


def _horizon(facts: Facts) -> str:
    end, motion = _mm(facts.end_u_val), _mm(facts.motion)
    whole = f"The free run over the whole {brief(facts.duration)} s"
    if facts.seconds is None:
        return f"{whole} is informative: at its end u_val is {end}, and the ball's own motion is {motion} RMS."
    return (
        f"{whole} is not informative: at its end u_val, due to the uncertainty of angle and start, is {end}, "
        f"compared with {motion} RMS of the ball's own motion."
    )


def _engine_fact(study: Study, name: str) -> EngineFact:
    runs, cam = study.run_of(name, study.headline), study.run_of(CAM.name, study.headline)
    away = np.abs(runs.position - cam.position)
    split = next((one.rms() for one in study.attributions if one.source == name), {})
    failures = [failure for failure in study.engine_failures if failure.engine == name]
    engine, parameters = next(pair for pair in study.engines if pair[0].name == name)
    return EngineFact(
        source=name,
        departure=float(np.nanmax(away)) if np.isfinite(away).any() else math.nan,
        numerical=split.get("numerical", math.nan),
        contact=split.get("contact", math.nan),
        failed=str(failures[0]).removeprefix(f"{name} failed ") if failures else "",
        chosen=_chosen(parameters),
        scene=engine.scene_file or "",
    )


def _chosen(parameters: EngineParameters) -> tuple[str, ...]:
    """Contact parameters that are not at their defaults, numbers with their values."""
    changed = parameters.model_dump(exclude_defaults=True, exclude={"time_step", "slip_limit"})
    return tuple(
        f"`{name}` of {value:g}" if isinstance(value, float) else f"`{name}`" for name, value in changed.items()
    )


def _lift_offs(study: Study) -> list[tuple[str, str]]:
    return [
        ("every source" if len(sources) == len(study.sources) else names(sources), text)
        for text, sources in study.sources_by_lift_off.items()
    ]


def _shorter(study: Study) -> tuple[float, str, float] | None:
    limit = math.inf if study.headline.seconds is None else study.headline.seconds
    shorter = [(one.seconds, one) for one in study.setting.horizons if one.seconds is not None and one.seconds < limit]
    for seconds, horizon in sorted(shorter, key=lambda each: -each[0]):
        best = standings(study, horizon)[0]
        if best.rms <= _MAX_RELATIVE_ERROR * still_error(study, horizon):
            return seconds, best.source, best.rms
    return None


def _mm(value: float) -> str:
    return f"{number(1e3 * value)} mm" if math.isfinite(value) else "∞"


def _list(items: Sequence[str]) -> str:
    return ", ".join(item.replace("_", " ") for item in items)
