"""What of the angle's scatter is an error is told by the ball: on a plant of its own, steps of 0.5 ms."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from analytic.motion import FloatArray
from harness.identify.estimate.fit import fit
from harness.identify.filter.run import deviance
from harness.identify.pose import problem_of
from harness.identify.problem.hypothesis import Hypothesis
from harness.recording import load_case
from harness.signals.held_drive import HeldDrive

MASS, RADIUS, RATIO, GRAVITY = 0.05, 0.0125, 5.0 / 7.0, 9.81  # a solid ball on a flat rail [kg, m, 1, m/s²]
ROLLING, LAG, NOISE, RATE, STEP = 0.003, 0.1, 1.5e-3, 25.0, 1.25e-4  # [1, s, m, Hz, s]
RIG = f"""[ball]
mass_kg = {MASS}
radius_m = {RADIUS}
inertia_kg_m2 = {0.4 * MASS * RADIUS**2}
[beam]
rolling_radius_m = {RADIUS}
eccentricity_m = 0.0
level_angle_rad = 0.0
[environment]
gravity_m_s2 = {GRAVITY}
[recordings]
identify = ["rec_01.csv", "rec_02.csv"]
"""


def controlled(seed: int, level: float = 0.0) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Stamps [s], command [rad], the beam's angle [rad] and noisy positions [m] of a controlled ball, 25 s.

    The controller knows the noisy position and gives a command at each stamp; the beam follows it with a lag.

    Args:
        level: tilt of the rig [rad].
    """
    rng = np.random.default_rng(seed)
    every, count = round(1.0 / RATE / STEP), round(25.0 * RATE)
    levels = rng.uniform(0.1, 0.35, 10)
    lever = RADIUS / RATIO
    time, command, angle, position = np.zeros((4, count))
    s, v, alpha, rate, wanted, before, speed = levels[0], 0.0, 0.0, 0.0, 0.0, levels[0], 0.0
    for k in range(count * every):
        if k % every == 0:
            i, read = k // every, s + rng.normal(0.0, NOISE)
            speed += 0.35 * ((read - before) * RATE - speed)
            wanted = float(np.clip(-0.7 * (read - levels[int(k * STEP / 2.5) % 10]) - 0.5 * speed, -0.14, 0.14))
            time[i], command[i], angle[i], position[i], before = k * STEP, wanted, alpha, read, read
        angular = (2.0 / LAG) ** 2 * (wanted - alpha) - 2.0 * (2.0 / LAG) * rate  # critically damped
        pull = GRAVITY * math.sin(alpha + level) + s * rate**2 - lever * angular
        held = ROLLING * max(GRAVITY * math.cos(alpha + level) - 2.0 * v * rate - s * angular, 0.0)
        if v == 0.0 and abs(pull) <= held:
            faster = 0.0
        else:
            faster = v + RATIO * (pull - math.copysign(held, v or pull)) * STEP
            faster = 0.0 if v * faster < 0.0 else faster
        v, s = faster, s + faster * STEP
        rate += angular * STEP
        alpha += rate * STEP
    return time, command, angle, position


def write(folder: Path, *, measured: float | None, late: int = 0, level: float = 0.0) -> Path:
    """A case of two recordings, of the command or of the angle measured with noise [rad]; nothing is declared of it.

    Args:
        late: rows by which the command is logged behind the reading that it answers.
        level: tilt of the rig [rad].
    """
    folder.mkdir()
    (folder / "rig.toml").write_text(RIG)
    for number in (1, 2):
        time, command, angle, position = controlled(number, level)
        noise = np.random.default_rng(number).normal(0.0, 1.0, len(time))
        told = np.concatenate((command[:1].repeat(late), command))[: len(time)]
        column = told if measured is None else angle + measured * noise
        rows = np.column_stack((time, column, position))
        header = "time_s,beam_angle_rad,ball_position_m"
        np.savetxt(folder / f"rec_0{number}.csv", rows, "%.7g", ",", header=header, comments="")
    return folder


@pytest.mark.slow
def test_a_command_is_held(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Follow a command from its row on, and estimate the ball's friction and the servo's lag without bias."""
    problem = problem_of(load_case(write(tmp_path / "case", measured=None)))
    assert problem.held_command
    found = fit(problem, Hypothesis(("rolling_resistance", "angle_servo")))
    values, deviations = found.values(), found.deviations()
    # Euler's method makes the plant's servo late or early by a part of its steps.
    for name, true, step in (
        (("rolling_resistance", "coefficient"), ROLLING, 0.0),
        (("angle_servo", "lag"), LAG, STEP),
    ):
        assert values[name] == pytest.approx(true, abs=step + 3.0 * deviations[name])
        assert deviations[name] < 0.05 * true
    # An error of 1e-6 rad, behind the servo too, tells nothing else than none.
    whole = deviance(problem, found.terms, found.process_noise)
    monkeypatch.setattr(HeldDrive, "commanded", False)
    assert deviance(problem, found.terms, found.process_noise) == pytest.approx(whole, abs=0.01)


def test_a_level_that_is_off_hides_no_command(tmp_path: Path) -> None:
    """Follow a command from its row on where the rig is tilted by 0.5 degrees, of which nothing is known."""
    assert problem_of(load_case(write(tmp_path / "case", measured=None, level=0.009))).held_command


@pytest.mark.slow
def test_a_command_that_is_logged_late_is_not_smoothed_as_noise(tmp_path: Path) -> None:
    """Follow a scattering command, which the beam does, and estimate the friction that acts on the ball."""
    problem = problem_of(load_case(write(tmp_path / "case", measured=None, late=1)))
    assert problem.noise_share < 1.0
    assert not problem.held_command
    found = fit(problem, Hypothesis(("rolling_resistance", "angle_servo")))
    error = found.deviations()["rolling_resistance", "coefficient"]
    assert found.values()["rolling_resistance", "coefficient"] == pytest.approx(ROLLING, abs=3.0 * error)
    assert error < 0.2 * ROLLING


@pytest.mark.slow
def test_noise_of_a_sensor_stays_noise(tmp_path: Path) -> None:
    """Leave an angle as it is estimated that scatters because its sensor is noisy."""
    problem = problem_of(load_case(write(tmp_path / "case", measured=5e-3)))
    assert problem.noise_share == 1.0
    assert not problem.held_command


@pytest.mark.slow
def test_declared_noise_is_asked_for_too(tmp_path: Path) -> None:
    """Follow a command whose scatter rig.toml calls noise, held or not, and an encoder's counts as they are."""
    case = load_case(write(tmp_path / "case", measured=None, late=1))
    noisy = problem_of(replace(case, sensors=replace(case.sensors, angle_noise=0.01)))
    assert noisy.noise_share < 1.0
    counts = problem_of(replace(case, sensors=replace(case.sensors, angle_resolution=0.004, angle_noise=0.0)))
    assert counts.noise_share == 1.0
    answering = load_case(write(tmp_path / "answering", measured=None))
    assert problem_of(replace(answering, sensors=replace(answering.sensors, angle_noise=0.01))).held_command
