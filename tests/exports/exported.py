"""Exported code made runnable: the C compiled and called by ctypes, the Python imported; and what both should equal."""

from __future__ import annotations

import ctypes
import importlib.util
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from types import ModuleType

import numpy as np

from analytic.effects import Acting, acting, motion_with, parameters_with, sensor_with
from analytic.kernel import Grid, integrate
from analytic.models import CAM
from analytic.motion import FloatArray, beam_states
from analytic.quintic import QuinticMotion
from analytic.rig import Rig
from analytic.slots import ORIGIN
from harness.exports.code_files import c_files, python_files
from harness.exports.model import LONGEST_STEP, ExportModel
from harness.identify.filter.arguments import BeamTable
from harness.identify.filter.free_run import free_runs

RIG = Rig(level_angle=0.002)
EACH = {
    "viscous_damping": {"coefficient": 0.02},
    "quadratic_drag": {"coefficient": 0.05},
    "rolling_resistance": {"coefficient": 0.004},
    "directional_resistance": {"coefficient_plus": 0.003, "coefficient_minus": 0.006},
    "stribeck_friction": {"static_coefficient": 0.008, "kinetic_coefficient": 0.003, "stribeck_velocity": 0.05},
    "presliding_hysteresis": {"coefficient": 0.003, "stiffness": 30.0},
    "level_error": {"angle": 0.004},
    "level_per_recording": {"spread": 0.0},
    "level_drift": {"rate": 5e-4},
    "track_curvature": {"curvature": 0.05, "centre": 0.3},
    "track_bump": {"height": 3e-4, "centre": 0.35, "width": 0.02},
    "beam_compliance": {"compliance": 0.03},
    "ball_imbalance": {"offset": 4e-5},
    "rolling_radius": {"radius": 0.0112},
    "contact_slip": {"friction_coefficient": 0.004},
    "eccentric_pivot": {"eccentricity": 0.01},
    "angle_gain": {"gain": 0.93},
    "angle_nonlinearity": {"square": 0.4, "cube": 2.0},
    "linkage_backlash": {"width": 0.006},
    "angle_hold": {"interval": 0.07},
    "angle_lag": {"time_constant": 0.05},
    "angle_servo": {"lag": 0.12, "damping": 0.7},
    "channel_delay": {"delay": 0.04},
    "position_gain": {"gain": 1.04},
    "position_nonlinearity": {"square": 0.1, "cube": 0.2},
    "position_lag": {"time_constant": 0.03},
}
"""An effect of each name of the catalogue that shows in a run of some seconds."""
SAMPLE = 0.01  # [s]


def effect(name: str) -> Acting:
    """The effect of this name, in a size that shows."""
    return acting(name, EACH[name])


def motion(seconds: float = 4.0) -> QuinticMotion:
    """A beam that turns by 2.6° on two sines, with its states at stamps 10 ms apart."""
    time = np.arange(0.0, seconds + 0.5 * SAMPLE, SAMPLE)
    states = np.zeros((len(time), 3))
    for size, pulse, phase in ((0.03, 4.0, 0.3), (0.015, 9.0, 1.1)):
        at = pulse * time + phase
        states += size * np.column_stack((np.sin(at), pulse * np.cos(at), -(pulse**2) * np.sin(at)))
    return QuinticMotion(time, states)


def ours(rig: Rig, effects: Sequence[Acting], beam: QuinticMotion, s: float, *, phase: float = 0.0) -> FloatArray:
    """What our own kernel has recorded of a ball from rest at s [m], shape (n,) [m]; a delay left out."""
    grid = Grid.over(beam.time, LONGEST_STEP)
    p = parameters_with(CAM, rig, effects, phase=phase)
    p[ORIGIN] = s
    table = grid.tabulate(motion_with(beam, beam.time, effects))
    sensor = sensor_with(effects)
    whole = np.array([0]), np.array([len(beam.time)])
    run = free_runs(*whole, BeamTable(grid.steps, grid.marks, table), p, sensor.lag, np.array([[s, 0.0]]))
    if not sensor.lag:  # the same by the kernel itself
        np.testing.assert_allclose(run, integrate(grid, table, p, np.array([[s, 0.0]])).position[0], atol=1e-12)
    return sensor.curve(run)


def in_python(model: ExportModel, folder: Path) -> ModuleType:
    """The exported Python, imported."""
    ((name, text),) = python_files(model).items()
    (folder / name).write_text(text, encoding="utf-8")
    spec = importlib.util.spec_from_file_location(f"exported_{abs(hash(str(folder)))}", folder / name)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


class Beam(ctypes.Structure):
    _fields_ = [(name, ctypes.c_double) for name in ("angle", "rate", "angular")]


class InC:
    """The exported C, compiled with all warnings as errors."""

    def __init__(self, model: ExportModel, folder: Path) -> None:
        for name, text in c_files(model).items():
            (folder / name).write_text(text, encoding="utf-8")
        built = folder / "libball_beam.so"
        strict = ["-std=c99", "-O1", "-Wall", "-Wextra", "-Werror", "-pedantic", "-ffp-contract=off"]
        main = ["-o", folder / "ball_beam", folder / "main.c", folder / "ball_beam.c", "-lm"]
        subprocess.run(["cc", *strict, *main], check=True)
        subprocess.run(["cc", *strict, "-shared", "-fPIC", "-o", built, folder / "ball_beam.c", "-lm"], check=True)
        self.program, self.compiled = folder / "ball_beam", ctypes.CDLL(str(built))
        for function, count in (("bb_acceleration", 7), ("bb_dry_limit", 8)):
            getattr(self.compiled, function).restype = ctypes.c_double
            getattr(self.compiled, function).argtypes = [ctypes.c_double] * count

    def acceleration(self, *at: float) -> float:
        """s̈ [m/s²]."""
        return float(self.compiled.bb_acceleration(*at))

    def dry_limit(self, *at: float) -> float:
        """What dry friction holds up [m/s²]."""
        return float(self.compiled.bb_dry_limit(*at))

    def run(self, beam: QuinticMotion, s: float, phase: float = 0.0, *, angle_only: bool = False) -> FloatArray:
        """What the example prints of a ball from rest at s [m], shape (n,) [m]."""
        columns = [beam.time, *beam_states(beam, beam.time).T]
        rows = np.column_stack(columns[:2] if angle_only else columns)
        text = "time_s,angle_rad\n" + "\n".join(",".join(f"{one:.17g}" for one in row) for row in rows)
        done = subprocess.run(
            [self.program, f"{s!r}", "0", f"{phase!r}"], input=text, capture_output=True, text=True, check=True
        )
        return np.array([float(line.split(",")[1]) for line in done.stdout.splitlines()[1:]])
