"""A play that is not there, in records of a servo's commands as a coarse encoder counts them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from harness.identify.estimate.fit import fit
from harness.identify.filter.run import deviance
from harness.identify.pose import problem_of
from harness.identify.problem.hypothesis import Hypothesis
from harness.recording import load_case
from harness.simulator import Experiment, with_imperfections, write_case

pytestmark = pytest.mark.slow

_NARROW = 3e-4  # width in the scale of the fit [5 mrad]: at most an eighth of its standard error


@pytest.mark.parametrize("seed", [0, 1, 4])
def test_a_play_that_is_not_there_gains_nothing_beside_a_servo(tmp_path: Path, seed: int) -> None:
    """Fit a play to simulated records without one: it gains what one number does, and nothing when narrow."""
    perfect = Experiment(
        declared={"rolling_resistance": {"coefficient": 0.003}}, counts=4096, position_noise=2e-4, predict=0, seed=seed
    )
    write_case(tmp_path / "case", with_imperfections(perfect, ("commanded_angle",), seed=seed))
    problem = problem_of(load_case(tmp_path / "case"))
    servo, play = (fit(problem, Hypothesis(names)) for names in (("angle_servo",), ("angle_servo", "linkage_backlash")))
    # χ² of one number exceeds 9 in 0.3 %; were the beam known to stand whenever it does behind the smoothed command,
    # the play would gain up to 65 in other records.
    assert servo.deviance - play.deviance < 9.0
    # The narrower the play, the less it changes. Where the beam turns back is told to one step of the process, which
    # makes the deviance rough by 0.7, whatever the width; known to stand, the play would lose 4, 5 and 78 here.
    narrow = play.hypothesis.terms(np.append(servo.theta, _NARROW), problem)
    assert abs(deviance(problem, narrow, servo.process_noise) - servo.deviance) < 1.0
