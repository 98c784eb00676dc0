"""A ball in water: its velocity follows the beam, and K shows only beside the damping."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from analytic.effects import CHANNEL_DELAY, ROLLING_RESISTANCE, VISCOUS_DAMPING
from harness.identify import rig_completion
from harness.identify.estimate.rig import FittedRig
from harness.identify.pose import problem_of
from harness.identify.rig_completion import NotRolling, complete_rig
from harness.identify.verdict import Verdict, identify
from harness.recording import load_case
from tests.recording.in_water import STEP, water


@pytest.mark.slow
@pytest.mark.parametrize(
    ("ratio", "damping", "delay"),
    [
        pytest.param(0.4, 4.0, 0.0, id="damped"),
        pytest.param(0.4, 4.0, 0.2, id="damped and late"),
        pytest.param(0.15, 10.0, 0.05, id="damped so much that the velocity follows the angle"),
    ],
)
def test_ratio_of_a_damped_ball(tmp_path: Path, ratio: float, damping: float, delay: float) -> None:
    """Estimate K where the velocity rather than the acceleration follows the angle.

    Without damping in the model it came out at 0.17, 0.18 and 0.02, with errors of 0.004 to 0.015. Four standard errors
    are exceeded once in 16,000; they may not be so large that any K would do. The plant's steps make a delay of 1 ms.
    """
    case = load_case(water(tmp_path / "case", ratio=ratio, damping=damping, delay=delay))
    fitted = complete_rig(case, case.recordings["rec_01.csv"]).fitted
    assert fitted is not None
    assert set(fitted.beside) == {VISCOUS_DAMPING, CHANNEL_DELAY}
    assert abs(fitted.ratio - ratio) < 4.0 * fitted.std[0] < 0.4 * ratio
    found, error = fitted.beside[CHANNEL_DELAY]
    assert abs(found - delay) < 4.0 * error + STEP


def test_a_ball_that_is_hardly_damped(tmp_path: Path) -> None:
    """Leave the estimate beside a rolling friction where the other agrees with it."""
    case = load_case(water(tmp_path / "case", ratio=0.6, damping=0.02, delay=0.0))
    fitted = complete_rig(case, case.recordings["rec_01.csv"]).fitted
    assert fitted is not None
    assert set(fitted.beside) == {ROLLING_RESISTANCE}


def test_a_reversed_angle_of_a_damped_ball_is_refused(tmp_path: Path) -> None:
    """Ask for signs, units and linkage where a ball in water rolls up the recorded angle."""
    case = load_case(water(tmp_path / "case", ratio=0.4, damping=8.0, delay=0.0, sign=-1))
    with pytest.raises(NotRolling, match="sign") as caught:
        complete_rig(case, case.recordings["rec_01.csv"])
    assert "crank" in str(caught.value)


@pytest.mark.parametrize(
    ("plain", "damped", "taken"),
    [
        pytest.param((0.33, 0.01, 0.0), (0.52, 0.01, -500.0), "damped", id="another K"),
        pytest.param((0.52, 0.03, 0.0), (0.54, 0.03, -500.0), "plain", id="the same K"),
        pytest.param((0.33, 0.01, 0.0), (0.52, 0.01, -5.0), "plain", id="another K that fits no better"),
        pytest.param((0.03, 0.01, 0.0), (0.06, 0.02, -50.0), "damped", id="a ball only with damping"),
        pytest.param((0.03, 0.01, 0.0), (0.04, 0.02, -50.0), "plain", id="no ball either way"),
        pytest.param((0.40, 0.01, 0.0), (0.20, 0.01, -500.0), "plain", id="damping does not lower K"),
    ],
)
def test_which_estimate_is_taken(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    plain: tuple[float, float, float],
    damped: tuple[float, float, float],
    taken: str,
) -> None:
    """Take K beside damping and delay where the BIC asks for them and it differs; each is K, its error, deviance."""

    def fitted(
        _: object, *, damped: bool = False, of: Mapping[bool, tuple[float, float, float]], **__: bool
    ) -> FittedRig:
        ratio, error, deviance = of[damped]
        return FittedRig(ratio, 0.0, 0.02, np.diag((error**2, 0.0, 0.0)), deviance, {})

    monkeypatch.setattr(rig_completion, "fit_rig", partial(fitted, of={False: plain, True: damped}))
    case = load_case(water(tmp_path / "case", ratio=0.6, damping=0.02, delay=0.0))
    wanted = plain if taken == "plain" else damped
    if wanted[0] < 0.05:
        with pytest.raises(NotRolling, match=f"K = {wanted[0]:.2f}"):
            complete_rig(case, case.recordings["rec_01.csv"])
        return
    completed = complete_rig(case, case.recordings["rec_01.csv"])
    assert completed.fitted is not None
    assert completed.fitted.ratio == wanted[0]


@pytest.mark.slow
def test_diagnosis_of_a_ball_in_water(tmp_path: Path) -> None:
    """Name the damping and the delay, or what stands for the delay, and nothing else."""
    result = identify(problem_of(load_case(water(tmp_path / "case", ratio=0.4, damping=4.0, delay=0.2))))
    assert result.verdict is Verdict.EFFECT
    damping, late = sorted(result.effects, key=lambda one: one.name != VISCOUS_DAMPING.name)
    assert damping.name == VISCOUS_DAMPING.name
    assert CHANNEL_DELAY.name in (late.name, *late.indistinguishable_from)
