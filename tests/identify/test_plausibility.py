"""A finding of absurd size is marked as implausible."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from harness.identify.estimate.fit import fit
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.record import EffectRecord
from harness.identify.selection.search import Selection
from harness.identify.verdict import judge
from tests.posed import Posed

GAIN = Hypothesis(("angle_gain",))


@pytest.mark.parametrize(("gain", "implausible"), [(1.2, ()), (2.5, ("gain",))])
def test_a_gain_of_more_than_two_is_implausible(plain: Posed, gain: float, implausible: tuple[str, ...]) -> None:
    """Name the parameter in the verdict and in its record, whatever the fit."""
    problem = plain.problem
    base = fit(problem, Hypothesis(()))
    theta = np.array([gain]) / GAIN.scale(problem)
    found = replace(fit(problem, GAIN), theta=theta, terms=GAIN.terms(theta, problem))
    (effect,) = judge(Selection(problem, base, found, ())).effects
    assert effect.implausible == implausible
    assert EffectRecord.model_validate(effect).implausible == implausible
