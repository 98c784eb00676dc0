"""The linear model against our own equations, its intervals against Monte Carlo, its files against each other."""

from __future__ import annotations

import importlib.util
import json
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import control
import numpy as np
import pytest
from scipy.io import loadmat
from scipy.signal import lsim

from analytic.effects import CATALOGUE, Acting, acting
from analytic.motion import FloatArray
from analytic.quintic import QuinticMotion
from analytic.rig import Rig
from harness.errors import InputError
from harness.exports.carried import in_linear
from harness.exports.linear import Linear, Point, delay_matrices, linearise
from harness.exports.model import ExportModel, of_effects
from harness.exports.statespace_files import content_of, statespace_files
from tests.exports.exported import effect, ours

POINT = Point(0.1, 0.0)
STEEP = Point(0.34, 0.05)  # beside the bump, on the curve of the angle
SETS = {
    "nothing": [],
    "damped": [effect("viscous_damping"), effect("track_curvature"), effect("beam_compliance")],
    "lags": [effect("angle_lag"), effect("position_lag"), effect("angle_gain"), effect("position_gain")],
    "servo": [effect("angle_servo"), effect("angle_lag"), effect("position_lag")],
    "curves": [effect("angle_nonlinearity"), effect("position_nonlinearity")],
}


def response(linear: Linear, p: complex) -> complex:
    """Transfer function of A, B, C, D."""
    n = len(linear.A)
    return complex((linear.C @ np.linalg.solve(p * np.eye(n) - linear.A, linear.B) + linear.D)[0, 0])


def estimated(covariance: FloatArray) -> ExportModel:
    """A model with four parameters of this covariance, shape (4, 4)."""
    effects = [effect("viscous_damping"), effect("angle_gain"), effect("angle_lag"), effect("channel_delay")]
    keys = tuple((i, one.effect.parameters[0].name) for i, one in enumerate(effects))
    theta = np.array([next(iter(one.values.values())) for one in effects])
    return replace(of_effects(Rig(), effects), theta=theta, covariance=covariance, keys=keys)


def test_cam_has_the_transfer_function_of_equation_14() -> None:
    """Compare with K (g − (h + r + J/(m r)) p²)/p², which eq. 14 is for small angles at s = 0."""
    rig, linear = Rig(), linearise(of_effects(Rig(), []), Point())
    for p in (0.5j, 2.0 + 3.0j, 20.0j):
        expected = rig.rolling_ratio * (rig.gravity - rig.lever * p**2) / p**2
        assert response(linear, p) == pytest.approx(expected, rel=1e-7)  # differences over 1e-5: 1e-9 of g


@pytest.mark.parametrize("which", SETS)
def test_one_input_and_three_inputs_are_the_same_system(which: str) -> None:
    """Compare transfer functions from the angle, and from the angle with its derivatives."""
    linear = linearise(of_effects(Rig(), SETS[which]), POINT)
    for p in (1.0j, 1.0 + 7.0j):
        B = linear.B_angle + p * linear.B_rate + p**2 * linear.B_acceleration
        three = (linear.C @ np.linalg.solve(p * np.eye(len(linear.A)) - linear.A, B))[0, 0]
        assert response(linear, p) == pytest.approx(three, rel=1e-9)


@pytest.mark.parametrize("which", SETS)
def test_small_moves_are_those_of_our_kernel(which: str) -> None:
    """Turn the beam by a few microradians, and compare with the kernel's deviation from the run without."""
    model, size = of_effects(Rig(), SETS[which]), 1e-5
    linear = linearise(model, POINT)
    time = np.arange(0.0, 2.0 + 1e-9, 0.005)
    # (1 − cos)²: at rest with its first three derivatives, as the linear model's states are.
    x = 3.0 * time
    states = size * np.column_stack(
        (
            (1.0 - np.cos(x)) ** 2,
            6.0 * (1.0 - np.cos(x)) * np.sin(x),
            18.0 * (np.sin(x) ** 2 + (1.0 - np.cos(x)) * np.cos(x)),
        )
    )
    runs = [ours(Rig(), SETS[which], QuinticMotion(time, each), POINT.position) for each in (states, 0.0 * states)]
    told = lsim((linear.A, linear.B, linear.C, linear.D), states[:, 0], time)[1]
    moved = runs[0] - runs[1]
    # lsim takes the angle as linear between samples of 5 ms: ω² h²/12 of it, 2e-5 at 3 rad/s and 7e-5 at 6, and the
    # angular acceleration that D and B stand for likewise; squares of the angle are 1e-5 of it.
    np.testing.assert_allclose(told, moved, atol=3e-4 * np.abs(moved).max())


def test_intervals_are_those_of_monte_carlo() -> None:
    """Compare standard deviations by the delta method with those of 4000 draws."""
    deviations = np.array([0.002, 0.01, 0.002, 0.003])
    correlation = np.eye(4) + 0.5 * (np.eye(4, k=1) + np.eye(4, k=-1))
    model = estimated(np.outer(deviations, deviations) * correlation)
    linear = linearise(model, POINT)
    from harness.exports.linear import _linear

    draws = np.random.default_rng(0).multivariate_normal(model.theta, model.covariance, 4000)
    each = [_linear(model, model.with_theta(theta), POINT) for theta in draws]
    for name in ("A", "B", "C", "D"):
        spread = np.std([getattr(one, name) for one in each], axis=0)
        # A deviation from 4000 draws is off by 1/√8000 = 1.1 %, four times that here; 1/T of a lag known to 4 % is not
        # linear in it, by 2 · 0.04² in its deviation, and B has its square.
        np.testing.assert_allclose(linear.deviations[name], spread, rtol=0.06, atol=1e-9)
    assert np.count_nonzero(linear.deviations["A"]) >= 3
    assert linear.delay_deviation == pytest.approx(0.003, rel=1e-6)


@pytest.mark.parametrize("order", [1, 2, 5])
def test_pade_is_that_of_python_control(order: int) -> None:
    """Compare the frequency response of the delay, and of the model with it, with python-control's."""
    linear = linearise(of_effects(Rig(), [effect("channel_delay")]), POINT)
    known = control.tf(*control.pade(linear.delay, order))
    alone, joined = control.ss(*delay_matrices(linear.delay, order)), control.ss(*linear.with_pade(order))
    for p in (1.0j, 10.0j, 3.0 + 2.0j):
        assert complex(alone(p)) == pytest.approx(complex(known(p)), rel=1e-8)
        assert complex(joined(p)) == pytest.approx(complex(known(p)) * response(linear, p), rel=1e-8)


@pytest.mark.parametrize("effects", [[], [acting("channel_delay", {"delay": -0.02})]])
def test_no_pade_without_a_positive_delay(effects: list[Acting]) -> None:
    """Say that there is nothing to approximate."""
    with pytest.raises(InputError, match="no Padé approximation"):
        linearise(of_effects(Rig(), effects), POINT).with_pade(2)


def imported(folder: Path) -> ModuleType:
    """statespace.py of this folder."""
    spec = importlib.util.spec_from_file_location("exported_statespace", folder / "statespace.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize(("delay", "told"), [(-0.02, "feed it the angle 0.02 s early"), (0.0, "there is no delay")])
def test_python_says_why_there_is_no_pade(delay: float, told: str, tmp_path: Path) -> None:
    """Raise an error with what to do instead, where the delay is negative or 0."""
    linear = linearise(of_effects(Rig(), [acting("channel_delay", {"delay": delay})]), POINT)
    for name, data in statespace_files(linear, None, json.dumps(content_of(linear, None))).items():
        (tmp_path / name).write_bytes(data if isinstance(data, bytes) else data.encode())
    assert imported(tmp_path).system().input_labels == ["angle"]
    with pytest.raises(ValueError, match=told):
        imported(tmp_path).system(2)


def test_files_hold_the_same_matrices(tmp_path: Path) -> None:
    """Read .mat, JSON and Python back."""
    model = estimated(np.diag([1e-3, 1e-2, 1e-3, 1e-3]) ** 2)
    linear = linearise(model, POINT)
    content = json.dumps(content_of(linear, 2))
    for name, data in statespace_files(linear, 2, content).items():
        (tmp_path / name).write_bytes(data if isinstance(data, bytes) else data.encode())
    mat, read = loadmat(tmp_path / "statespace.mat"), json.loads(content)
    assert mat["__header__"].split() == [b"MATLAB", b"5.0", b"MAT-file"]  # and not when, so that the file is the same
    assert [str(one.item()) for one in mat["states"].ravel()] == read["states"]
    assert mat["delay"].item() == read["delay_s"] == linear.delay
    module = imported(tmp_path)
    system = module.system()
    for name in "ABCD":
        value = getattr(linear, name)
        np.testing.assert_array_equal(mat[name], value)
        np.testing.assert_array_equal(read[name], value)
        np.testing.assert_array_equal(getattr(system, name), value)
        np.testing.assert_array_equal(mat[f"{name}_pade"], read["pade"][name])
        np.testing.assert_array_equal(mat[f"{name}_low"], read["intervals"][name]["low"])
    assert (system.input_labels, system.output_labels) == (["angle"], ["position"])
    assert (module.system(2).input_labels, module.system(2).output_labels) == (["angle"], ["position"])
    assert complex(module.system(2)(3.0j)) == pytest.approx(complex(control.ss(*linear.with_pade(2))(3.0j)), rel=1e-8)


@pytest.mark.parametrize("name", CATALOGUE)
def test_what_is_left_out_is_said(name: str) -> None:
    """Find an effect that is not carried among what is left out, and any other in the matrices, delay or offset."""
    model = of_effects(Rig(), [effect(name)])
    (told,), linear, bare = in_linear(model), linearise(model, STEEP), linearise(of_effects(Rig(), []), STEEP)
    if not told.carried:
        assert any(line.startswith(f"{name}:") for line in linear.left_out)
        return
    same = linear.A.shape == bare.A.shape and all(
        np.allclose(getattr(linear, each), getattr(bare, each), rtol=1e-8, atol=1e-8) for each in "ABCD"
    )
    differs = not same or linear.delay != 0.0 or abs(linear.offset - bare.offset) > 1e-9
    # A drag that grows with the square of the velocity has no slope at rest; the spread of levels is 0 on the mean.
    assert differs or name in ("quadratic_drag", "level_per_recording")
