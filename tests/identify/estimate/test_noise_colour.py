"""The colour of the reading noise is told by the readings."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import pytest

from harness.identify.estimate.noise_colour import with_noise_colour
from harness.identify.problem.problem import WHITE
from harness.identify.verdict import Verdict, identify
from tests.coloured_record import NOISE, TIME, coloured_problem
from tests.posed import Posed, pose


@pytest.mark.slow
def test_correlation_time_and_variance_are_found(tmp_path: Path) -> None:
    """Find both within four standard errors from 1500 readings, most of the variance coloured."""
    problem = coloured_problem(tmp_path / "case", 1)
    # AR(1) with φ = 0.8: φ to √((1 − φ²)/n) = 0.0155, so τ = −Δt/log φ to 3.9 ms; log σ² to √(2 (1 + φ²)/(n (1 − φ²)))
    assert problem.colour.time == pytest.approx(TIME, abs=4 * 3.9e-3)
    assert math.log(problem.reading_variance / NOISE**2) == pytest.approx(0.0, abs=4 * 0.078)
    assert problem.colour.share > 0.9


def test_white_noise_stays_white(plain: Posed) -> None:
    """Leave the problem as it is where one reading tells nothing of the noise of the next."""
    assert with_noise_colour(plain.problem) is plain.problem


def test_missing_physics_is_not_taken_for_colour(tmp_path: Path) -> None:
    """Leave noise white where a ball that is held back moves otherwise than the model's."""
    hidden = {"rolling_resistance": {"coefficient": 0.006}, "viscous_damping": {"coefficient": 0.03}}
    assert pose(tmp_path / "case", 5, hidden).problem.colour == WHITE


@pytest.mark.slow
@pytest.mark.parametrize("seed", [2, 3])
def test_coloured_noise_alone_is_no_missing_physics(tmp_path: Path, seed: int) -> None:
    """Say that nothing is missing, where taken for white the noise leaves a ball that moves by itself."""
    problem = coloured_problem(tmp_path / "case", seed)
    assert identify(problem).verdict is Verdict.NONE
    white = identify(replace(problem, colour=WHITE))
    assert white.base.root_process_noise > 100.0 * problem.angle_floor


@pytest.mark.slow
def test_an_effect_is_found_beside_coloured_noise(tmp_path: Path) -> None:
    """Name a viscous damping of middle size with an interval that holds it."""
    said = identify(coloured_problem(tmp_path / "case", 4, {"viscous_damping": {"coefficient": 0.02}}))
    (effect,) = said.effects
    assert effect.name == "viscous_damping"
    found = effect.parameters["coefficient"]
    assert found.low <= 0.02 <= found.high
