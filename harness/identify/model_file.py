"""The identified model as JSON and back, so that another recording can be predicted from diagnosis.json alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from analytic.effects import CATALOGUE, acting
from analytic.rig import Rig
from harness.errors import InputError
from harness.identify.estimate.fit import Estimator, Fit
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.problem import Colour, PreparedRecording, Problem
from harness.identify.problem.spline_term import SplineTerm
from harness.identify.record import ModelRecord, RigRecord, SensorsRecord
from harness.identify.selection.ledger_record import colour_record, declared_record
from harness.recording import Sensors


def model_record(problem: Problem, found: Fit, sensors: Sensors) -> ModelRecord:
    """The `model` part of diagnosis.json: everything that a prediction needs."""
    spline = found.hypothesis.spline
    return ModelRecord(
        rig=RigRecord.model_validate(problem.rig),
        sensors=SensorsRecord.model_validate(sensors),
        declared=declared_record(problem),
        effects=found.hypothesis.names,
        spline_term=None if spline is None else spline.record(),
        parameters=tuple(found.theta.tolist()),
        phases=len(problem.recordings),
        covariance=tuple(map(tuple, found.covariance.tolist())),
        process_noise_m2_s3=found.process_noise,
        estimator=found.estimator.value,
        band=found.band,
        reading_variance_m2=problem.reading_variance,
        colour=colour_record(problem),
    )


def rig_of(kept: ModelRecord) -> Rig:
    """The rig of a `ModelRecord`."""
    return Rig(**kept.rig.model_dump())


def read_model(kept: ModelRecord, recording: PreparedRecording, origin: str) -> tuple[Problem, Fit]:
    """The problem and fit with which to predict `recording`.

    Args:
        kept: as `model_record` made it.
        origin: the file, for messages.

    Raises:
        InputError: the content is not what this version writes, or an effect is not in the catalogue.
    """
    unknown = [name for name in kept.effects if name not in CATALOGUE]
    if unknown:
        raise InputError(
            f"{origin}: the effect {unknown[0]} is not in the catalogue; give the file of an effect of your own with "
            "--effects"
        )
    try:
        declared = tuple(acting(one.name, one.values) for one in kept.declared)
        colour = Colour(kept.colour.share, kept.colour.time_s)
        problem = Problem((recording,) * kept.phases, rig_of(kept), declared, kept.reading_variance_m2, colour=colour)
        hypothesis = Hypothesis(kept.effects, None if kept.spline_term is None else SplineTerm.of(kept.spline_term))
        theta = np.array(kept.parameters, dtype=float)
        covariance = np.array(kept.covariance, dtype=float).reshape(len(theta), len(theta))
        found = Fit(
            hypothesis,
            theta,
            hypothesis.terms(theta, problem),
            kept.process_noise_m2_s3,
            np.nan,
            covariance,
            problem.readings,
            estimator=Estimator(kept.estimator),
            band=kept.band,
        )
    except (IndexError, ValueError) as error:
        raise InputError(f"{origin}: is no diagnosis that this version can use ({error}); diagnose anew") from error
    # The phases φ₀ in the file belong to other recordings; that of this one is estimated from its own readings.
    return replace(problem, recordings=(replace(recording, name=""),) * kept.phases), found
