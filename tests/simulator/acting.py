"""A plant on which named effects act, and runs of it that can be solved by hand."""

from __future__ import annotations

from analytic.motion import BeamMotion, State
from analytic.rig import Rig
from harness.simulator import Effects, Plant, Run, simulate
from tests.simulator.motions import Fixed

RIG = Rig()
K, G, M = RIG.rolling_ratio, RIG.gravity, RIG.mass
MOVED = M / K  # m + J/r²

# One of each, of a size that matters on the rig.
EACH: dict[str, dict[str, float]] = {
    "viscous_damping": {"coefficient": 0.03},
    "quadratic_drag": {"coefficient": 0.2},
    "rolling_resistance": {"coefficient": 0.004},
    "directional_resistance": {"coefficient_plus": 0.002, "coefficient_minus": 0.005},
    "stribeck_friction": {"static_coefficient": 0.006, "kinetic_coefficient": 0.003, "stribeck_velocity": 0.02},
    "level_error": {"angle": -0.005},
    "level_per_recording": {"spread": 0.004},
    "level_drift": {"rate": 8e-4},
    "track_curvature": {"curvature": 0.06, "centre": 0.33},
    "track_bump": {"height": 2e-4, "centre": 0.32, "width": 0.02},
    "ball_imbalance": {"offset": 1e-4},
    "rolling_radius": {"radius": 0.0105},
    "contact_slip": {"friction_coefficient": 0.005},
    "angle_gain": {"gain": 1.05},
    "linkage_backlash": {"width": 0.0087},
    "angle_nonlinearity": {"square": 0.6, "cube": 4.0},
    "angle_hold": {"interval": 0.1},
    "angle_lag": {"time_constant": 0.06},
    "angle_servo": {"lag": 0.12, "damping": 0.7},
    "beam_compliance": {"compliance": 0.02},
    "channel_delay": {"delay": 0.06},
    "position_gain": {"gain": 1.03},
    "position_nonlinearity": {"square": 0.2, "cube": -0.1},
    "position_lag": {"time_constant": 0.08},
    "presliding_hysteresis": {"coefficient": 0.004, "stiffness": 50.0},
    "eccentric_pivot": {"eccentricity": 0.1},
}
EACH_UNLISTED: dict[str, dict[str, float]] = {
    "gust": {"force": 0.006, "start": 4.0, "end": 100.0},
    "settling_force": {"force": 0.006, "time_constant": 2.0},
    "fading_resistance": {"coefficient": 0.006, "time_constant": 5.0},
    "rough_patch": {"coefficient": 0.01, "start": 0.30, "end": 0.34},
    "force_hill": {"force": 0.01, "start": 0.30, "end": 0.36},
    "ripple_force": {"force": 0.01, "wavelength": 0.05},
    "magnet": {"force": 0.01, "centre": 0.33, "distance": 0.05},
    "cubic_spring": {"stiffness": 10.0, "centre": 0.32},
    "cubic_drag": {"coefficient": 0.8},
    "cable_pull": {"force": 0.008, "frequency": 60.0},
    "sticky_spot": {"coefficient": 0.015, "width": 0.3},
    "out_of_round": {"torque": 5e-5},
}


def rolled(
    effects: Effects,
    start: State,
    duration: float,
    *,
    motion: BeamMotion | None = None,
    turned_before: float = 0.0,
    step: float = 1e-4,
) -> Run:
    """A run on the paper's rig with `effects`, open loop; the beam stands level unless a motion is given."""
    plant = Plant(step=step).with_effects(effects, turned_before=turned_before)
    return simulate(plant, Fixed() if motion is None else motion, start, duration)
