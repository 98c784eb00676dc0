"""The motions of a finished run as functions of time, to run another plant or an engine with them.

A cubic Hermite spline through angles and rates meets a motion exactly if its acceleration is constant in each step.
"""

from __future__ import annotations

from scipy.interpolate import CubicHermiteSpline

from analytic.motion import SplineMotion
from harness.simulator.plant import Run


def beam_motion(run: Run) -> SplineMotion:
    """The beam's motion in `run`."""
    return SplineMotion(CubicHermiteSpline(run.time, run.angle, run.rate))


def shaft_motion(run: Run) -> SplineMotion:
    """The motion of the measured shaft in `run`."""
    return SplineMotion(CubicHermiteSpline(run.time, run.shaft, run.shaft_rate))
