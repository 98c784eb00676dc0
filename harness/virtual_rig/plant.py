"""The plant: a rig with the resistances it really has, run under a given beam motion."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cache
from typing import cast

import numba
import numpy as np

from analytic.motion import BeamMotion, FloatArray, State
from analytic.rig import Rig
from harness.virtual_rig.contact import COLUMNS, FORCE_SIGNATURE, AppliedForce, Ball, Constants, advance, describe


@numba.cfunc(FORCE_SIGNATURE, cache=True)
def no_force(position: float, velocity: float, angle: float, rolled_angle: float, time: float) -> float:
    """A plant without extra force [N]."""
    return 0.0


@cache
def compiled(force: AppliedForce | None) -> AppliedForce:
    """`force` as machine code; every force has the same compiled type, so that the plant is compiled only once."""
    if force is None:
        return cast(AppliedForce, no_force)
    return cast(AppliedForce, numba.cfunc(FORCE_SIGNATURE)(force))


@dataclass(frozen=True, kw_only=True)
class Plant:
    """A ball on a beam as rigid bodies in contact (see `harness.virtual_rig.contact`).

    Attributes:
        rig: geometry, masses and gravity as they are; `rig.level_angle` is the level error that acts.
        rolling_resistance: c, |F| <= c N against rolling, set-valued [1].
        friction: μ between ball and edge, Coulomb, set-valued [1]; steel on aluminium by default.
        force: extra force on the ball along the beam, a plain function that numba can compile, or `None`.
        step: time step [s]; the default is good to 0.1 µm over 14 s, stops and starts included.

    Raises:
        ValueError: a coefficient is negative or the step is not positive.
    """

    rig: Rig = field(default_factory=Rig)
    rolling_resistance: float = 0.0
    friction: float = 0.35
    force: AppliedForce | None = None
    step: float = 1e-4

    def __post_init__(self) -> None:
        for name in ("rolling_resistance", "friction"):
            if not 0.0 <= getattr(self, name) < math.inf:
                raise ValueError(f"{name} is {getattr(self, name)}; it must be finite and not negative")
        if not 0.0 < self.step < math.inf:
            raise ValueError(f"step is {self.step}; it must be positive")

    @property
    def constants(self) -> Constants:
        """The same in the form the contact works with."""
        rig = self.rig
        return Constants(
            rig.mass,
            rig.inertia,
            rig.rolling_radius,
            rig.eccentricity,
            rig.gravity * math.sin(rig.level_angle),
            -rig.gravity * math.cos(rig.level_angle),
            self.friction * rig.radius / rig.rolling_radius,
            self.rolling_resistance * rig.rolling_radius,
        )

    def ball(self, start: State, angle: float, rate: float) -> Ball:
        """The ball rolling without slip at `start` on the beam at α = `angle` [rad], α̇ = `rate` [rad/s]."""
        sin, cos = math.sin(angle), math.cos(angle)
        height = self.rig.eccentricity + self.rig.rolling_radius
        x = start.position * cos + height * sin
        z = height * cos - start.position * sin
        return Ball(
            x,
            z,
            start.velocity * cos + rate * z,
            -start.velocity * sin - rate * x,
            angle,
            start.velocity / self.rig.rolling_radius + rate,
            start.position,
            0.0,
            0.0,
        )


@dataclass(frozen=True)
class Run:
    """What really happened, at every step of the plant; all arrays have shape (n,).

    Attributes:
        time: [s].
        angle: α [rad].
        rate: α̇ [rad/s].
        acceleration: α̈ [rad/s²].
        position: s [m].
        velocity: ṡ [m/s]; exactly 0 while the ball is held at rest.
        rolled_angle: φ − α, turned relative to the beam since the start [rad].
        spin: ω = φ̇ [rad/s].
        slip: ṡ − r (ω − α̇) at the contact line [m/s].
        gap: height of the centre above its place in the groove [m]; 0 in contact.
        normal_force: N, mean over the step that ends at `time`; NaN at the first instant [N].
        energy: kinetic and potential [J].
        work: given by the beam's torque and the applied force so far [J].
        dissipated: taken by rolling resistance, slip and impact so far [J].
    """

    time: FloatArray
    angle: FloatArray
    rate: FloatArray
    acceleration: FloatArray
    position: FloatArray
    velocity: FloatArray
    rolled_angle: FloatArray
    spin: FloatArray
    slip: FloatArray
    gap: FloatArray
    normal_force: FloatArray
    energy: FloatArray
    work: FloatArray
    dissipated: FloatArray


class Simulation:
    """A plant in progress: the beam's instants are filled in from outside, the ball follows on demand.

    Attributes:
        time: instants of the run, shape (n + 1,) [s].
        angle, rate, acceleration: beam motion there, shape (n + 1,), to be filled before `advance` [rad, s].
    """

    def __init__(self, plant: Plant, start: State, duration: float) -> None:
        steps = round(duration / plant.step)
        if steps < 1:
            raise ValueError(f"duration {duration} s is shorter than the plant's step {plant.step} s")
        self._plant, self._start, self._done = plant, start, 0
        self._constants, self._force = plant.constants, compiled(plant.force)
        self._rows = np.empty((steps + 1, len(COLUMNS)))
        self.time: FloatArray = np.arange(steps + 1, dtype=np.float64) * plant.step
        self.angle, self.rate, self.acceleration = np.zeros((3, steps + 1))

    def begin(self) -> None:
        """Put the ball onto the beam as it is at the first instant."""
        self._ball = self._plant.ball(self._start, float(self.angle[0]), float(self.rate[0]))
        describe(self._ball, self.angle[0], self.rate[0], math.nan, self._constants, self._rows[0])

    def advance(self, to: int) -> None:
        """Follow the ball up to instant number `to`."""
        here = self._done
        self._ball = advance(
            self._ball,
            self.angle[here : to + 1],
            self.rate[here : to + 1],
            self.time[here],
            self._plant.step,
            self._constants,
            self._force,
            self._rows[here + 1 : to + 1],
        )
        self._done = to

    def position(self) -> float:
        """s at the instant reached [m]."""
        return float(self._ball.along)

    def run(self) -> Run:
        """The whole run."""
        columns = dict(zip(COLUMNS, self._rows.T, strict=True))
        return Run(self.time, self.angle, self.rate, self.acceleration, **columns)


def simulate(plant: Plant, motion: BeamMotion, start: State, duration: float) -> Run:
    """Run the plant open loop from t = 0.

    Args:
        plant: what rolls on what.
        motion: beam angle and its derivatives, asked at every step.
        start: ball at t = 0, rolling without slip.
        duration: length of the run, rounded to whole steps [s].

    Returns:
        The run, `round(duration / plant.step) + 1` instants.

    Raises:
        ValueError: `duration` is shorter than a step.
    """
    simulation = Simulation(plant, start, duration)
    simulation.angle[:] = motion.angle(simulation.time)
    simulation.rate[:] = motion.rate(simulation.time)
    simulation.acceleration[:] = motion.acceleration(simulation.time)
    simulation.begin()
    simulation.advance(simulation.time.size - 1)
    return simulation.run()
