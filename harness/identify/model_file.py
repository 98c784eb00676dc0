"""The identified model as JSON and back, so that another recording can be predicted from diagnosis.json alone."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from analytic.effects import CATALOGUE, Acting, EffectError, acting
from analytic.motion import FloatArray
from analytic.rig import Rig
from harness.errors import InputError
from harness.identify.estimate.band import Band
from harness.identify.estimate.fit import Estimator, Fit
from harness.identify.estimate.travel import Travel
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.problem import Colour, PreparedRecording, Problem
from harness.identify.problem.spline_term import Regressor, SplineTerm
from harness.identify.record import (
    AT_BOUND,
    ForecastRecord,
    ModelRecord,
    RigRecord,
    SensorsRecord,
    covariance_fault,
    unusable,
)
from harness.identify.selection.ledger_record import colour_record, declared_record
from harness.identify.selection.spline_terms import visited
from harness.preparation.readings import UsedReadings
from harness.preparation.recordings import Observed, observe
from harness.recording import Recording, Sensors


def model_record(problem: Problem, found: Fit, sensors: Sensors, forecasting: Fit | None = None) -> ModelRecord:
    """The `model` part of diagnosis.json: everything that a prediction needs.

    Args:
        forecasting: what predictions use, if that is another fit.
    """
    spline = found.hypothesis.spline
    return ModelRecord(
        rig=RigRecord.model_validate(problem.rig),
        sensors=SensorsRecord.model_validate(sensors),
        declared=declared_record(problem),
        effects=found.hypothesis.names,
        spline_term=None if spline is None else spline.record(),
        parameters=tuple(found.theta.tolist()),
        phases=len(problem.recordings),
        covariance=tuple(map(tuple, _covariance(found).tolist())),
        process_noise_m2_s3=found.process_noise,
        estimator=found.estimator.value,
        band=found.band.factor,
        band_growth_m2_s=found.band.growth,
        travel_m=(forecasting or found).travel.ends,
        reading_variance_m2=problem.reading_variance,
        readings_in_mean=problem.readings_in_mean,
        colour=colour_record(problem),
        roughness=problem.roughness,
        noise_share=problem.noise_share,
        held_command=problem.held_command,
        visited_m=visited(problem, Regressor.POSITION),
        forecast=None
        if forecasting is None
        else ForecastRecord(
            effects=forecasting.hypothesis.names,
            parameters=tuple(forecasting.theta.tolist()),
            covariance=tuple(map(tuple, _covariance(forecasting).tolist())),
            process_noise_m2_s3=forecasting.process_noise,
            band=forecasting.band.factor,
            band_growth_m2_s=forecasting.band.growth,
        ),
    )


def _covariance(found: Fit) -> FloatArray:
    """The covariance of a fit, shape (k, k), without what rounding leaves of negative variances."""
    covariance = found.covariance
    if not covariance_fault(covariance) or not np.isfinite(covariance).all():
        return covariance
    deviations = np.sqrt(np.diag(covariance).clip(min=0.0))
    unit = np.outer(*[np.where(deviations > 0.0, deviations, 1.0)] * 2)
    values, vectors = np.linalg.eigh(0.5 * (covariance + covariance.T) / unit)
    nearest = (vectors * values.clip(min=0.0)) @ vectors.T
    return np.asarray(0.5 * (nearest + nearest.T) * unit)


def rig_of(kept: ModelRecord) -> Rig:
    """The rig of a `ModelRecord`."""
    return Rig(**kept.rig.model_dump())


def observed_for(kept: ModelRecord, recording: Recording, sensors: Sensors) -> Observed:
    """A recording, prepared for the rig and with the noise of the angle that the model was identified with.

    Raises:
        InputError: as of `observe`.
    """
    return observe(recording, sensors, rig_of(kept), kept.noise_share, held_command=kept.held_command)


def prepared_for(kept: ModelRecord, observed: Observed) -> PreparedRecording:
    """A recording from `observed_for`, with the roughness of the beam's motion that the model was identified with.

    It has all stamps of the recording.
    """
    return PreparedRecording.at_all_stamps(observed).rougher(kept.roughness)


def with_noise_of(kept: ModelRecord, used: UsedReadings) -> ModelRecord:
    """The model with the noise of these readings, which may be means of more readings, or of fewer, than its own.

    White noise is averaged; coloured noise is taken for one that neighbours share.
    """
    white = (1.0 - kept.colour.share) * kept.readings_in_mean / used.every
    factor = white + kept.colour.share
    colour = kept.colour.model_copy(update={"share": kept.colour.share / factor})
    variance = factor * kept.reading_variance_m2
    changed = {"reading_variance_m2": variance, "readings_in_mean": used.every, "colour": colour}
    return kept.model_copy(update=changed)


def read_model(kept: ModelRecord, recording: PreparedRecording, origin: str) -> tuple[Problem, Fit]:
    """The problem and fit of what was found, for a filter over `recording`.

    Args:
        kept: as `model_record` made it, `with_noise_of` the recording's readings.
        recording: from `prepared_for`.
        origin: the file, for messages.

    Raises:
        InputError: the content is not what this version writes, or an effect is not in the catalogue.
    """
    hypothesis = _hypothesis(kept, origin)
    declared = _declared(kept, origin)
    colour = Colour(kept.colour.share, kept.colour.time_s)
    problem = Problem(
        (recording,) * kept.phases,
        rig_of(kept),
        declared,
        kept.reading_variance_m2,
        colour=colour,
        roughness=kept.roughness,
        noise_share=kept.noise_share,
    )
    theta = np.array(kept.parameters, dtype=float)
    _check_parameters(theta, hypothesis, problem, origin)
    if any(one is None for row in kept.covariance for one in row):
        raise unusable(origin, "model.covariance", "holds null, as the recordings do not tell how sure its numbers are")
    try:
        terms = hypothesis.terms(theta, problem)
    except (IndexError, ValueError) as error:
        raise unusable(origin, "model", str(error)) from error
    found = Fit(
        hypothesis,
        theta,
        terms,
        kept.process_noise_m2_s3,
        np.nan,
        np.array(kept.covariance, dtype=float).reshape(len(theta), len(theta)),
        problem.readings,
        estimator=Estimator(kept.estimator),
        band=Band(kept.band, kept.band_growth_m2_s),
        travel=Travel.of(kept.travel_m),
    )
    # The phases φ₀ in the file belong to other recordings; that of this one is estimated from its own readings.
    return replace(problem, recordings=(replace(recording, name=""),) * kept.phases), found


def read_forecasting(kept: ModelRecord, recording: PreparedRecording, origin: str) -> tuple[Problem, Fit]:
    """The problem and fit with which to predict `recording`: what was found, or what predicts better.

    Args and errors are those of `read_model`.
    """
    if kept.forecast is None:
        return read_model(kept, recording, origin)
    of_forecasts = {name: getattr(kept.forecast, name) for name in ForecastRecord.model_fields}
    problem, found = read_model(kept.model_copy(update=of_forecasts), recording, origin)
    return problem, replace(found, estimator=Estimator.FORECASTS)


def read_terms(kept: ModelRecord, origin: str) -> tuple[Problem, Fit]:
    """The problem and fit of a model without a recording: for its effects and values alone, not to predict with.

    Raises:
        InputError: as `read_model`.
    """
    # Some bounds follow from where the ball has been; `_check_parameters` also takes those of the effect itself.
    blank = PreparedRecording("", np.array([0.0, 1.0]), np.array([0.1, 0.5]), None)  # type: ignore[arg-type]
    return read_model(kept, blank, origin)


def _hypothesis(kept: ModelRecord, origin: str) -> Hypothesis:
    """The terms of the model, without values."""
    _in_catalogue(kept.effects, origin)
    if len(set(kept.effects)) < len(kept.effects):
        raise unusable(origin, "model.effects", f"one of {', '.join(kept.effects)} stands there twice")
    return Hypothesis(kept.effects, None if kept.spline_term is None else SplineTerm.of(kept.spline_term))


def _declared(kept: ModelRecord, origin: str) -> tuple[Acting, ...]:
    """The declared effects, with their values."""
    _in_catalogue([one.name for one in kept.declared], origin)
    try:
        return tuple(acting(one.name, one.values) for one in kept.declared)
    except EffectError as error:
        raise unusable(origin, "model.declared", str(error).rstrip(".")) from error


def _in_catalogue(names: Iterable[str], origin: str) -> None:
    for name in names:
        if name not in CATALOGUE:
            raise InputError(
                f"{origin}: the effect {name} is not in the catalogue; give the file of an effect of your own with "
                "--effects"
            )


def _check_parameters(theta: FloatArray, hypothesis: Hypothesis, problem: Problem, origin: str) -> None:
    """Refuse scaled parameters, shape (k,), that are not those of the hypothesis, or that no fit could have reached.

    Where the bounds of a fit depend on the recordings, which here are others, a number may also be within the bounds of
    the effect itself.
    """
    size = hypothesis.size(problem)
    if len(theta) != size:
        raise unusable(origin, "model.parameters", f"{len(theta)} numbers, but its effects and spline term have {size}")
    scale, (lows, highs) = hypothesis.scale(problem), hypothesis.bounds(problem)
    for at, (effect, name) in enumerate(hypothesis.parameters):
        (parameter,) = (one for one in CATALOGUE[effect].parameters if one.name == name)
        low, high = min(parameter.low, lows[at] * scale[at]), max(parameter.high, highs[at] * scale[at])
        value, slack = theta[at] * scale[at], AT_BOUND * (high - low)
        if not low - slack <= value <= high + slack:
            text = f"{name} of {effect} is {value:g}; it must lie between {low:g} and {high:g} {parameter.unit}"
            raise unusable(origin, f"model.parameters.{at}", text.removesuffix(" 1"))
