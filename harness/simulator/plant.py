"""The plant: a rig with the resistances it really has, run under a given beam motion."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from functools import cache
from typing import cast

import numba
import numpy as np
from scipy.interpolate import CubicHermiteSpline

from analytic.effects import (
    ANGLE_HOLD,
    ANGLE_LAG,
    ANGLE_NONLINEARITY,
    ANGLE_SERVO,
    CONTACT_SLIP,
    ECCENTRIC_PIVOT,
    LEVEL_DRIFT,
    LEVEL_ERROR,
    LEVEL_PER_RECORDING,
    ROLLING_RESISTANCE,
    Effect,
    rig_with,
    transmission_with,
)
from analytic.motion import BeamMotion, FloatArray, SplineMotion, State, beam_states
from analytic.rig import Rig
from harness.simulator.contact import FORCE_SIGNATURE, AppliedForce, Ball, Beam, Constants
from harness.simulator.effect_force import force_with
from harness.simulator.effects import Effects, checked, listed
from harness.simulator.follower import Follower
from harness.simulator.laws import Laws
from harness.simulator.linkage import Linkage
from harness.simulator.stepping import COLUMNS, advance, describe


@numba.cfunc(FORCE_SIGNATURE, cache=True)  # numba's own cache will do: no other source is compiled in
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
    """A ball on a beam as rigid bodies in contact (see `harness.simulator.contact`).

    Attributes:
        rig: geometry, masses and gravity as they are; `rig.level_angle` is the level error that acts.
        rolling_resistance: c, |F| <= c N against rolling, set-valued [1].
        friction: μ between ball and edge, Coulomb, set-valued [1]; steel on aluminium by default.
        laws: what else acts on the ball.
        linkage: what lies between the measured angle and the beam.
        follower: how the beam follows what the linkage asks of it.
        force: extra force on the ball along the beam, a plain function that numba can compile, or `None`.
        step: time step [s]; the default is good to 0.1 µm over 14 s, stops and starts included.

    Raises:
        ValueError: a coefficient is negative or the step is not positive.
    """

    rig: Rig = field(default_factory=Rig)
    rolling_resistance: float = 0.0
    friction: float = 0.35
    laws: Laws = Laws()  # noqa: RUF009, immutable
    linkage: Linkage = field(default_factory=Linkage)
    follower: Follower = field(default_factory=Follower)
    force: AppliedForce | None = None
    step: float = 1e-4

    def __post_init__(self) -> None:
        for name, value in (("rolling resistance", self.rolling_resistance), ("friction", self.friction)):
            if not 0.0 <= value < math.inf:
                raise ValueError(f"{name} is {value}; it must be finite and not negative")
        if not 0.0 < self.step < math.inf:
            raise ValueError(f"step is {self.step}; it must be positive")

    def with_effects(
        self, effects: Effects, *, turned_before: float = 0.0, play_start: float = 0.0, level: float = 1.0
    ) -> Plant:
        """This plant with effects acting in it too.

        Effects of the sensors are none of the plant's (see `Sensors.with_effects`). An eccentric pivot adds no term,
        for rigid bodies lack none: it only says where the pivot is.

        Args:
            effects: name -> parameters, as in `harness.simulator.effects`.
            turned_before: φ₀, how the ball lies at the start [rad].
            play_start: where a linkage begins within its play, −1 … 1 [1].
            level: of this recording, over the standard deviation of all recordings' levels [1].

        Raises:
            InputError: names or values that cannot be.
            RigError: a rolling radius that the ball cannot have.
        """
        effects = checked(effects)
        acting = listed(effects)

        def value(effect: Effect, default: float) -> float:
            return effects[effect.name][effect.parameters[0].name] if effect.name in effects else default

        rig = rig_with(self.rig, acting)
        rig = rig.with_(
            level_angle=rig.level_angle + value(LEVEL_ERROR, 0.0) + level * value(LEVEL_PER_RECORDING, 0.0),
            eccentricity=value(ECCENTRIC_PIVOT, rig.eccentricity),
        )
        transmission = transmission_with(acting)
        return replace(
            self,
            rig=rig,
            rolling_resistance=self.rolling_resistance + value(ROLLING_RESISTANCE, 0.0),
            friction=value(CONTACT_SLIP, self.friction),
            laws=self.laws.with_effects(effects, rig, turned_before),
            linkage=replace(
                self.linkage,
                gain=self.linkage.gain * transmission.gain,
                width=self.linkage.width + transmission.play,
                play_start=play_start,
            ),
            follower=replace(
                self.follower,
                **effects.get(ANGLE_NONLINEARITY.name, {}),
                hold=self.follower.hold + value(ANGLE_HOLD, 0.0),
                lag=self.follower.lag + value(ANGLE_LAG, 0.0),
                **{f"servo_{name}": number for name, number in effects.get(ANGLE_SERVO.name, {}).items()},
                drift=self.follower.drift + value(LEVEL_DRIFT, 0.0),
            ),
            force=force_with(self.force, acting, turned_before),
        )

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
        shaft: the angle that is measured, θ; α unless a linkage lies between them [rad].
        shaft_rate: θ̇ [rad/s].
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
    shaft: FloatArray
    shaft_rate: FloatArray
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

    # A cubic Hermite spline through angles and rates meets a motion whose acceleration is constant in each step.

    @property
    def beam_motion(self) -> SplineMotion:
        """The beam's motion as a function of time, to run another plant or an engine with it."""
        return SplineMotion(CubicHermiteSpline(self.time, self.angle, self.rate))

    @property
    def shaft_motion(self) -> SplineMotion:
        """The motion of the measured shaft as a function of time."""
        return SplineMotion(CubicHermiteSpline(self.time, self.shaft, self.shaft_rate))


class Simulation:
    """A plant in progress: the shaft's instants are filled in from outside, beam and ball follow on demand.

    Attributes:
        time: instants of the run, shape (n + 1,) [s].
        shaft: θ, θ̇, θ̈ there, shape (3, n + 1), to be filled before `advance` [rad, s].
        beam: α, α̇, α̈ there, shape (3, n + 1) [rad, s].
    """

    def __init__(self, plant: Plant, start: State, duration: float) -> None:
        steps = round(duration / plant.step)
        if steps < 1:
            raise ValueError(f"duration {duration} s is shorter than the plant's step {plant.step} s")
        self._plant, self._start, self._done = plant, start, 0
        self._constants, self._force = plant.constants, compiled(plant.force)
        self._rows = np.empty((steps + 1, len(COLUMNS)))
        self.time: FloatArray = np.arange(steps + 1, dtype=np.float64) * plant.step
        self.shaft: FloatArray = np.zeros((3, steps + 1))
        self._asked: FloatArray = self.shaft if plant.linkage.rigid else np.zeros((3, steps + 1))
        self.beam: FloatArray = self._asked if plant.follower.rigid else np.zeros((3, steps + 1))

    def begin(self) -> None:
        """Put the ball onto the beam as it is at the first instant."""
        self._carried = self._plant.linkage.begin(float(self.shaft[0, 0]))
        self._transmit(0, 0)
        angle, rate, _ = self.beam[:, 0].tolist()
        self._ball = self._plant.ball(self._start, angle, rate)
        describe(self._ball, Beam(angle, rate), math.nan, self._constants, self._rows[0])

    def advance(self, to: int) -> None:
        """Follow the ball up to instant number `to`."""
        here = self._done
        self._transmit(here, to)
        self._ball = advance(
            self._ball,
            self.beam[0, here : to + 1],
            self.beam[1, here : to + 1],
            self.time[here],
            self._plant.step,
            self._constants,
            self._plant.laws,
            self._force,
            self._rows[here + 1 : to + 1],
        )
        self._done = to

    def _transmit(self, first: int, last: int) -> None:
        if not self._plant.linkage.rigid:
            instants = slice(first, last + 1)
            self._carried = self._plant.linkage.transmit(
                self._carried, self.shaft[:, instants], self._asked[:, instants]
            )
        if not self._plant.follower.rigid:
            self._plant.follower.follow(self._asked, self.beam, self._plant.step, first, last)

    @property
    def position(self) -> FloatArray:
        """s at the instants reached so far, shape (k,) [m]."""
        return self._rows[: self._done + 1, 0]

    def run(self) -> Run:
        """The whole run."""
        columns = dict(zip(COLUMNS, self._rows.T, strict=True))
        return Run(self.time, *self.beam, *self.shaft[:2], **columns)


def simulate(plant: Plant, motion: BeamMotion, start: State, duration: float) -> Run:
    """Run the plant open loop from t = 0.

    Args:
        plant: what rolls on what.
        motion: of the shaft, asked at every step; the beam moves with it unless the plant has a linkage.
        start: ball at t = 0, rolling without slip.
        duration: length of the run, rounded to whole steps [s].

    Returns:
        The run, `round(duration / plant.step) + 1` instants.

    Raises:
        ValueError: `duration` is shorter than a step.
    """
    simulation = Simulation(plant, start, duration)
    simulation.shaft[:] = beam_states(motion, simulation.time).T
    simulation.begin()
    simulation.advance(simulation.time.size - 1)
    return simulation.run()
