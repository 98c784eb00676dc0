"""The same experiments with the ball moved by a physics engine: another contact, the same truth.

The engine drives the beam as it moved and lets its own ball roll. What acts on the ball besides is one force along the
beam, from the same laws as in the plant. A set-valued resistance has no one value at rest: it is what stops the ball
within a step, as far as c N reaches. What pulls at the ball is seen from how it moved, so that no equation of motion is
needed to know it.
"""

from __future__ import annotations

import math

from analytic.motion import BallForce, BeamMotion, FloatArray, State
from analytic.rig import Rig
from harness.engines.catalogue import engine_of
from harness.errors import InputError
from harness.simulator.experiment import Mover
from harness.simulator.laws import Laws, ball_torque, dahl, force_along, resistance_coefficients, track_tilt
from harness.simulator.plant import Plant, Run

GRIPS = 0.1  # μ below which a ball may slide, which no force along the beam can stand for


class Resistance:
    """Set-valued resistance, its mean over each step, and Dahl's stretch; it remembers, so that one serves one run.

    The engines' velocities live half a step before and after the force (see `harness.engines.leapfrog`), and so do the
    differences of the positions that are seen here.
    """

    def __init__(self, rig: Rig, coefficient: float, laws: Laws, time_step: float) -> None:
        """Take what resists: `coefficient` c beyond that of `laws` [1], in an engine that steps by `time_step` [s]."""
        self._coefficient, self._laws, self._dt = coefficient, laws, time_step
        self._inertia = rig.mass + rig.inertia / rig.rolling_radius**2  # of a ball that rolls
        self._places: list[float] = []
        self._stretch = self._resisted = 0.0

    def force(self, s: float, v: float, rolled: float, time: float, normal_force: float) -> float:
        """Force on the ball along the beam [N] at s [m], ṡ [m/s], φ − α [rad], t [s], pressed on by N [N]."""
        places, dt = self._places, self._dt
        way = s - places[-1] if places else 0.0
        if self._laws.presliding_hysteresis_coefficient:
            self._stretch, _ = dahl(self._stretch, way, normal_force, self._laws)
        speed, drive = (way / dt, 0.0) if places else (v, 0.0)
        if len(places) > 1:
            drive = (way - (places[-1] - places[-2])) / dt**2 - self._resisted / self._inertia
        self._places = [*places[-1:], s]
        c_plus, c_minus = resistance_coefficients(s, v, rolled, time, self._laws)
        plus, minus = ((self._coefficient + c) * normal_force / self._inertia for c in (c_plus, c_minus))
        self._resisted = self._inertia * _mean_resistance(speed, drive, plus, minus, dt)
        pressed = 1.0 if normal_force > 0.0 else 0.0
        return self._resisted - pressed * self._laws.presliding_hysteresis_stiffness * self._stretch


def _mean_resistance(speed: float, drive: float, plus: float, minus: float, dt: float) -> float:
    """Mean deceleration over a step that begins with `speed` [m/s] while `drive` pulls [m/s²].

    Args:
        speed, drive: without the resistance.
        plus, minus: the most that resistance can do against motion towards + and − [m/s²].
        dt: length of the step [s].
    """
    left, now = dt, speed
    if speed != 0.0:
        resisted = drive - plus if speed > 0.0 else drive + minus
        if speed * (speed + resisted * dt) >= 0.0:
            return resisted - drive
        left, now = dt + speed / resisted, 0.0
    onward = drive - min(max(drive, -minus), plus)  # nothing, where the ball is held
    return (now + onward * left - speed) / dt - drive


def force_in_engine(plant: Plant, motion: BeamMotion, start: State, stamps: FloatArray, time_step: float) -> BallForce:
    """What acts on the ball of `plant` besides gravity and the contact, as a force for one run of an engine.

    Args:
        plant: its rig's level error is the engine's own; everything else is in the force.
        motion: of the beam.
        start: the ball at `stamps[0]`.
        stamps: of the run, shape (n,) [s].
        time_step: of the engine [s].

    Raises:
        InputError: the ball may slide.
    """
    if plant.friction < GRIPS:
        raise InputError(f"a ball that slides (μ = {plant.friction:g}) cannot be given to an engine as a force.")
    rig, laws = plant.rig, plant.laws
    resistance = Resistance(rig, plant.rolling_resistance, laws, time_step)
    begin, height = float(stamps[0]), rig.eccentricity + rig.rolling_radius
    rates, turns = motion.derivative(stamps).tolist(), motion.derivative(stamps, 2).tolist()
    spacing = (float(stamps[-1]) - begin) / (len(stamps) - 1)

    def force(s: float, v: float, angle: float, time: float) -> float:
        now = min(max(round((time - begin) / spacing), 0), len(rates) - 1)
        rolled = (s - start.position) / rig.rolling_radius
        tilt = angle + rig.level_angle
        slope = track_tilt(s, laws)
        push = force_along(s, v, angle, time, laws) + ball_torque(rolled, laws) / rig.rolling_radius
        if plant.force is not None:
            push += plant.force(s, v, angle, rolled, time)
        push += rig.mass * rig.gravity * (math.sin(tilt + slope) - math.sin(tilt))
        across = -2.0 * v * rates[now] - s * turns[now] - height * rates[now] ** 2
        normal_force = max(rig.mass * (rig.gravity * math.cos(tilt + slope) + across), 0.0)
        return push + resistance.force(s, v, rolled, time, normal_force)

    return force


def engine_mover(name: str, *, time_step: float = 5e-4) -> Mover:
    """A mover for `Experiment.recordings`: the ball of this engine on the beam that the run drove.

    Args:
        name: `mujoco`, `pybullet`, `dart`.
        time_step: of the engine [s].

    Raises:
        InputError: no such engine.
    """
    engine = engine_of(name)
    settings = engine.parameters(time_step=time_step)

    def move(run: Run, plant: Plant, start: State, stamps: FloatArray) -> tuple[FloatArray, FloatArray]:
        motion = run.beam_motion
        force = force_in_engine(plant, motion, start, stamps, time_step)
        moved = engine.run(plant.rig, motion, start, stamps, parameters=settings, force=force).trajectory
        return moved.position, moved.velocity

    return move
