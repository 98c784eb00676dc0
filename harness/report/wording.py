"""The verdict of a diagnosis as one sentence."""

from collections.abc import Mapping, Sequence

import numpy as np

from analytic.effects import CATALOGUE, Parameter
from analytic.effects.resistance import STEEP
from analytic.rig import Rig
from harness.failures import Part
from harness.formatting import listed, measured, number
from harness.identify.diagnosis import Diagnosis
from harness.identify.estimate.fit import Estimator
from harness.identify.held_at_first import may_be_held
from harness.identify.problem.problem import Problem
from harness.identify.problem.spline_term import Regressor
from harness.identify.problem.windows import AHEAD
from harness.identify.selection.criterion import Criterion
from harness.identify.shaken_beam import may_be_shaking
from harness.identify.validation.baseline_comparison import AFTER, FORECASTS
from harness.identify.validation.held_out import BeforeAfter
from harness.identify.verdict import Estimate, IdentifiedEffect, Verdict

_MAX_NAMES = 5  # further names are counted instead of listed
_AT_BOUND = 1e-3  # of its range: a fit ends that near to a bound that holds it
_HEADLINE = f"{AHEAD:g} s"  # horizon of the error that is told

_SIMPLE: Mapping[str, str] = {
    "at_rest": "a ball at rest",
    "constant_velocity": "a ball at constant velocity",
    "double_integrator": "a double integrator",
}
DEPENDENCES: Mapping[Regressor, str] = {
    Regressor.POSITION: "the ball's position",
    Regressor.VELOCITY: "the ball's velocity",
    Regressor.ANGLE: "the beam angle",
    Regressor.ROLL_ANGLE: "the ball's rolled angle",
    Regressor.TIME: "time",
}


def words(name: str) -> str:
    """An effect's name with blanks: `level error`."""
    return name.replace("_", " ")


def sentence(diagnosis: Diagnosis) -> str:
    """The verdict in words; ± is half the width of a 95 % interval."""
    match diagnosis.verdict:
        case Verdict.NONE:
            return (
                "No missing effect was found: no effect of the catalogue predicts these recordings better"
                f"{_stays(diagnosis.heldout)}{_fitted_to_forecasts(diagnosis)}."
            )
        case Verdict.NOT_IDENTIFIABLE if _far_above_noise_floor(diagnosis):
            return (
                f"Not identifiable from these recordings: {_unexplained(diagnosis)}, but no law that was tried "
                f"predicts significantly better{_stays(diagnosis.heldout)}{_fitted_to_forecasts(diagnosis)}."
            )
        case Verdict.NOT_IDENTIFIABLE:
            failed = " or could not be tried" if diagnosis.failures else ""
            return (
                "Not identifiable from these recordings: nothing was found, but at their typical size "
                f"{_some(diagnosis.unseen)} would be below the detection limit{failed}"
                f"{_fitted_to_forecasts(diagnosis)}."
            )
        case Verdict.UNLISTED:
            beside = f" beside {_found(diagnosis)}" if diagnosis.effects else ""
            what = f"{_spline_term(diagnosis)}{beside}{_fall(diagnosis)}"
            return f"An effect that is not in the catalogue is missing: {what}{_as_good(diagnosis)}."
        case Verdict.EFFECT:
            verb = "was" if len(diagnosis.effects) == 1 else "were"
            text = f"{_found(diagnosis)} {verb} missing{_fall(diagnosis)}{_as_good(diagnosis)}."
            return text[0].upper() + text[1:]


def phrase(finding: IdentifiedEffect, rig: Rig) -> str:
    """An effect with its values: `a rolling resistance of 0.0041 ± 0.0002`."""
    effect = CATALOGUE.get(finding.name)
    known = {} if effect is None else {one.name: one for one in effect.parameters}
    said = {key: _value(known.get(key), each) for key, each in finding.parameters.items()}
    if effect is not None and effect.phrase:
        first = effect.parameters[0]
        unit, factor = first.shown or (first.unit, 1.0)
        return effect.phrase.format(**said, declared=f"{number(factor * first.neutral_on(rig), 4)} {unit}")
    return f"{_one(finding.name)} ({', '.join(f'{words(k)} {v}' for k, v in said.items())})"


def _one(name: str) -> str:
    """`a level error`, `an angle gain`."""
    return f"{'an' if name[0] in 'aeiou' else 'a'} {words(name)}"


def _value(parameter: Parameter | None, one: Estimate) -> str:
    shown = None if parameter is None else parameter.shown
    unit, factor = shown or ("" if one.unit == "1" else one.unit, 1.0)
    text = measured(factor * one.value, 0.5 * factor * (one.high - one.low))
    return text + (unit if unit == "°" else f" {unit}" if unit else "")


def _far_above_noise_floor(diagnosis: Diagnosis) -> bool:
    return Criterion(diagnosis.problem.settings).far_above_noise_floor(diagnosis.problem, diagnosis.found)


def _unexplained(diagnosis: Diagnosis) -> str:
    """That physics is missing: by how much, unless the density is that of a fit to free runs, which only predicts."""
    found = diagnosis.found
    if found.estimator is Estimator.FREE_RUNS:
        return "physics is missing, by the process noise"
    return f"the process noise is {number(found.root_process_noise / diagnosis.problem.angle_floor, 2)} times its floor"


def _found(diagnosis: Diagnosis) -> str:
    problem = diagnosis.problem
    rig = problem.rig
    each = [phrase(one, rig) + _doubts(one, problem) + _implausible(one, rig) for one in diagnosis.effects]
    return listed(each).replace(",,", ",")


def _doubts(finding: IdentifiedEffect, problem: Problem) -> str:
    """In brackets: rivals, what else does as much, parameters at a bound, an interval that holds no effect too."""
    rivals = [words(" and ".join(names)) + " together" * (len(names) > 1) for names in finding.rivals]
    said = [f"indistinguishable from {' or '.join(rivals)}"] if rivals else []
    if may_be_shaking(problem, finding.name, {name: one.value for name, one in finding.parameters.items()}):
        said.append("a beam that shakes between the readings of its angle, as fast as they show, does as much")
    if may_be_held(problem, finding.name, finding.parameters):
        said.append("a ball that is held at first and then let go does as much")
    effect = CATALOGUE.get(finding.name)
    for one in () if effect is None else effect.parameters:
        found, neutral = finding.parameters[one.name], one.neutral_on(problem.rig)
        low, high = one.bounds_on(problem.visited, problem.rig)
        if one.strength and found.low < neutral < found.high:
            said.append(f"the interval of its {words(one.name)} holds no effect too")
        if any(abs(found.value - end) < _AT_BOUND * (high - low) for end in (low, high) if end != neutral):
            said.append(f"its {words(one.name)} is at the end of the range tried")
    return f" ({'; '.join(said)})" if said else ""


def _implausible(finding: IdentifiedEffect, rig: Rig) -> str:
    """A clause on a size that physics does not account for; it ends with a comma."""
    if not finding.implausible:
        return ""
    parameters = {one.name: one for one in CATALOGUE[finding.name].parameters}
    usual = parameters[finding.implausible[0]].usual_on(rig)
    small = usual is not None and 0.0 <= finding.parameters[finding.implausible[0]].value < usual[0]
    return f", which is implausibly {'small' if small else 'large'} for {_one(finding.name)},"


def _some(names: Sequence[str]) -> str:
    more = [f"{len(names) - _MAX_NAMES} more"] if len(names) > _MAX_NAMES else []
    return listed([*map(words, names[:_MAX_NAMES]), *more])


def _spline_term(diagnosis: Diagnosis) -> str:
    spline = diagnosis.found.terms.spline
    assert spline is not None
    most = float(np.max(np.abs(spline.nodes)))
    depends = DEPENDENCES[spline.depends]
    if spline.friction:
        large = ", which is implausibly large for a ball that rolls" if most >= STEEP else ""
        return f"a dry friction that depends on {depends} (by up to {number(most, 2)} of the normal force{large})"
    if spline.sensor:
        return f"an error of the position sensor that depends on {depends} (up to {number(1e3 * most, 2)} mm)"
    again = f" and repeats itself every {number(1e3 * spline.period, 3)} mm" if spline.periodic else ""
    return f"a force that depends on {depends}{again} (up to {number(1e3 * diagnosis.problem.rig.mass * most, 2)} mN)"


def _ends(heldout: BeforeAfter) -> tuple[str, float, float] | None:
    """Over what the held-out error is told, before and after [m].

    Windows of 3 s, else the longest shorter ones, else the rest of a recording: a free run over all of that diverges on
    a beam, which is unstable.
    """
    both = [name for name in heldout.before.rms if name in heldout.after.rms]
    if not both:
        return None
    windows = [name for name in both if name != "whole"]
    name = _HEADLINE if _HEADLINE in windows else windows[-1] if windows else both[-1]
    span = "" if name == "whole" else f" over {name}"
    return span, heldout.before.rms[name], heldout.after.rms[name]


def _fall(diagnosis: Diagnosis) -> str:
    ends = _ends(diagnosis.heldout)
    if ends is None:
        failed = any(one.part is Part.VALIDATION for one in diagnosis.failures)
        why = "held-out errors could not be computed" if failed else "the recordings are too short for held-out errors"
        return f"; {why}"
    span, before, after = ends
    verb = "decreases" if after < before else "increases"
    return f"; the held-out error{span} {verb} from {error_size(before)} to {error_size(after)}"


def _fitted_to_forecasts(diagnosis: Diagnosis) -> str:
    """That predictions use other parameters, if they do."""
    compared = diagnosis.baselines
    if compared is None or compared.predicting != FORECASTS:
        return ""
    without, fitted = error_size(compared.rms(AFTER)), error_size(compared.rms(FORECASTS))
    common = diagnosis.forecasting is not None and diagnosis.forecasting.hypothesis != diagnosis.found.hypothesis
    what = "all effects that are common on measured rigs, together" if common else fitted_numbers(diagnosis)
    return f"; predictions use {what} fitted to forecasts ({fitted} over held-out blocks, {without} without)"


def fitted_numbers(diagnosis: Diagnosis) -> str:
    """What is fitted to forecasts, process noise in any case."""
    fitted = diagnosis.forecasting
    return "a process noise" if fitted is not None and not len(fitted.theta) else "parameters"


def _as_good(diagnosis: Diagnosis) -> str:
    """That predictions use other parameters; that a baseline that is no black box predicts better, or may do so."""
    compared = diagnosis.baselines
    if compared is None:
        return ""
    said = _fitted_to_forecasts(diagnosis)
    best, after = compared.best_simple_baseline, compared.rms(compared.predicting)
    errors = error_size(compared.rms(best))
    if not said:
        errors += f" over held-out blocks, {error_size(after)} with what was found"
    if after >= compared.rms(best):
        return f"{said}; but {_SIMPLE[best]} predicts better ({errors})"
    margin = compared.margin(best)
    if margin is None or margin.sure:
        return said
    return f"{said}; it is not sure that this predicts better than {_SIMPLE[best]} does ({errors})"


def _stays(heldout: BeforeAfter) -> str:
    ends = _ends(heldout)
    return "" if ends is None else f"; the held-out error{ends[0]} is {error_size(ends[1])}"


def error_size(metres: float) -> str:
    """An error in millimetres, from one metre in metres."""
    if metres >= 0.9995:
        return f"{number(metres)} m"
    return f"{number(1e3 * metres, 3 if metres >= 0.00995 else 2)} mm"
