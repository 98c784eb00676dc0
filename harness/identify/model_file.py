"""A found model as JSON and back, so that another recording can be predicted from diagnosis.json alone."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, replace
from typing import Any

import numpy as np

from analytic.effects import CATALOGUE, acting
from analytic.rig import Rig
from harness.errors import InputError
from harness.identify.estimate.fit import Fit
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.problem import Problem, Record
from harness.identify.problem.spline_term import Shape
from harness.recording import Sensors


def model_record(problem: Problem, found: Fit, sensors: Sensors) -> dict[str, Any]:
    """Everything that a prediction needs."""
    shape = found.hypothesis.shape
    return {
        "rig": asdict(problem.rig),
        "sensors": asdict(sensors),
        "declared": [{"name": one.effect.name, "values": dict(one.values)} for one in problem.declared],
        "effects": list(found.hypothesis.names),
        "curve": None if shape is None else shape.record(),
        "numbers": found.numbers.tolist(),
        "phases": len(problem.records),
        "covariance": found.covariance.tolist(),
        "process_noise_m2_s3": found.density,
        "reading_variance_m2": problem.noise,
    }


def read_model(kept: Mapping[str, Any], record: Record, origin: str) -> tuple[Problem, Fit]:
    """The problem and fit to predict `record` with.

    Args:
        kept: as `model_record` wrote it.
        origin: the file, for messages.

    Raises:
        InputError: it is not what this version writes.
    """
    unknown = [name for name in kept.get("effects", ()) if name not in CATALOGUE]
    if unknown:
        raise InputError(
            f"{origin}: found {unknown[0]}, which the catalogue does not have; give the file of an effect of your own "
            "with --effects"
        )
    try:
        declared = tuple(acting(one["name"], one["values"]) for one in kept["declared"])
        problem = Problem((record,) * kept["phases"], Rig(**kept["rig"]), declared, kept["reading_variance_m2"])
        hypothesis = Hypothesis(tuple(kept["effects"]), kept["curve"] and Shape.of(kept["curve"]))
        numbers = np.array(kept["numbers"], dtype=float)
        covariance = np.array(kept["covariance"], dtype=float).reshape(len(numbers), len(numbers))
        found = Fit(
            hypothesis,
            numbers,
            hypothesis.read(numbers, problem),
            kept["process_noise_m2_s3"],
            np.nan,
            covariance,
            problem.readings,
        )
    except (KeyError, TypeError, ValueError) as error:
        raise InputError(f"{origin}: is no diagnosis that this version can use ({error}); diagnose anew") from error
    # The kept phases are those of other recordings: this one's is found from its own readings.
    return replace(problem, records=(replace(record, name=""),) * kept["phases"]), found
