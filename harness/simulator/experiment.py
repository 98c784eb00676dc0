"""Simulated experiments with a known truth: recordings, what really happened, and what the rig's owner declares."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from analytic.motion import FloatArray, State
from analytic.rig import Rig, RigError
from harness.errors import InputError
from harness.simulator.effects import UNLISTED, Effects, checked
from harness.simulator.imperfect_record import imperfect_record
from harness.simulator.imperfections import Imperfections
from harness.simulator.moves import DEFLECTION, SERVO, random_controller, random_protocol, random_start
from harness.simulator.plant import Plant, Run, simulate
from harness.simulator.protocol import Record, Sensors, perform, perform_commanded, record, turned_before
from harness.simulator.sensors import Encoder, Laser

MARGIN = 0.1  # by which the laser reads further than the ball may roll [m]
STEP = 2e-4  # of the plant [s]: 0.1 µm after 16 s, a thousandth of the laser's noise
CLEAN = 0.3e-3  # noise of what the controller sees where the record is imperfect [m]
TRIES = 20  # moves that are drawn until the ball stays where it may be

Mover = Callable[[Run, Plant, State, FloatArray], tuple[FloatArray, FloatArray]]
"""Moves the ball anew in place of the plant's contact: (run, plant, start, stamps) -> s [m], ṡ [m/s] at the stamps.

The run gives the beam's motion, the plant what acts."""


@dataclass(frozen=True)
class SimulatedRecording:
    """One recording and the truth behind it; arrays of shape (n,) at the record's stamps.

    Attributes:
        record: what was written down.
        position: s [m].
        velocity: ṡ [m/s].
        angle: α, of the beam [rad].
        rolled_angle: φ − α since the start [rad]; NaN where another engine moved the ball.
        noiseless: what the position's channel would have delivered without noise and rounding [m].
        seed: of its noise.
    """

    record: Record
    position: FloatArray
    velocity: FloatArray
    angle: FloatArray
    rolled_angle: FloatArray
    noiseless: FloatArray
    seed: int


@dataclass(frozen=True, kw_only=True)
class Experiment:
    """What is to be recorded.

    Attributes:
        rig: as declared; what differs from it is a hidden effect.
        declared: effects that act and are declared.
        hidden: effects of the catalogue that act and are not declared.
        unlisted: structures that no catalogue has, hidden as well.
        counts: of the encoder per turn.
        angle_noise: standard deviation before counting [rad].
        position_noise: standard deviation [m].
        position_resolution: of the record [m].
        rate: readings a second [Hz].
        duration: of each recording [s].
        identify, predict: how many recordings there are of each kind.
        closed_loop: whether the moves are a controller's that sees the record; else they are those that the controller
            made on a plant without the hidden effects, and a ball that runs off the beam is an error.
        deflection: how far the controller turns the beam at most [rad]; there it rests while the ball is far off.
        start: where the ball is put down [m]; at random when `None`.
        play_start: where a linkage begins within its play, −1 … 1; at random when `None` [1].
        reach: between which places the ball has to stay [m].
        friction: μ between ball and edge, unless `contact_slip` acts [1].
        step: of the plant [s].
        imperfections: of the record; none without them, and the controller then sees the record itself.
        seed: of everything random.

    Raises:
        InputError: effects that cannot be, an effect that is both declared and hidden, or a servo that lags where
            there is no controller.
    """

    rig: Rig = field(default_factory=Rig)
    declared: Effects = field(default_factory=dict)
    hidden: Effects = field(default_factory=dict)
    unlisted: Effects = field(default_factory=dict)
    counts: int = 40_000
    angle_noise: float = 0.0
    position_noise: float = 0.3e-3
    position_resolution: float = 0.1e-3
    rate: float = 100.0
    duration: float = 16.0
    identify: int = 2
    predict: int = 1
    closed_loop: bool = True
    deflection: float = DEFLECTION
    start: float | None = None
    play_start: float | None = 0.0
    reach: tuple[float, float] = (0.12, 0.52)
    friction: float = 0.35
    step: float = STEP
    imperfections: Imperfections | None = None
    seed: int = 0

    def __post_init__(self) -> None:
        for name in (*self.declared, *self.hidden):
            if name in UNLISTED:
                raise InputError(f"{name} is in no catalogue; give it as an unlisted effect.")
        for name in self.unlisted:
            if name not in UNLISTED:
                raise InputError(f"{name} is not an unlisted effect; there are: {', '.join(UNLISTED)}.")
        twice = sorted(set(self.declared) & set(self.hidden))
        if twice:
            raise InputError(f"{twice[0]} is both declared and hidden; give it once, with the values that act.")
        if self.imperfections is not None and self.imperfections.servo_lag > 0.0 and not self.closed_loop:
            raise InputError("a servo that lags is recorded by its commands; close the loop, there are none without.")
        checked(self.acting)

    @property
    def acting(self) -> dict[str, dict[str, float]]:
        """All that acts."""
        effects = {**self.declared, **self.hidden, **self.unlisted}
        return {name: dict(values) for name, values in effects.items()}

    @property
    def seeds(self) -> tuple[int, ...]:
        """A seed for each recording."""
        state = np.random.SeedSequence(self.seed).generate_state(self.identify + self.predict)
        return tuple(int(number) for number in state)

    @property
    def sensors(self) -> Sensors:
        """The sensors, the effects in them included."""
        laser = Laser(
            near=self.reach[0] - MARGIN,
            far=self.reach[1] + MARGIN,
            noise_near=self.position_noise,
            noise_far=self.position_noise,
            resolution=self.position_resolution,
        )
        encoder = Encoder(counts=self.counts, noise=self.angle_noise)
        return Sensors(encoder=encoder, laser=laser, rate=self.rate).with_effects(self.acting)

    def plant(self, seed: int, effects: Effects) -> Plant:
        """The plant of the recording with this seed, with these effects.

        Raises:
            InputError: effects of which the rig cannot be.
        """
        play = self.play_start
        if play is None:
            play = float(np.random.default_rng((seed, 1)).uniform(-1.0, 1.0))
        try:
            bare = Plant(rig=self.rig, friction=self.friction, step=self.step)
            return bare.with_effects(
                effects, turned_before=turned_before(seed), play_start=play, level=self._level(seed)
            )
        except RigError as error:
            raise InputError(f"the rig with these effects cannot exist: {error}.") from error

    def _level(self, seed: int) -> float:
        """Level of the recording with this seed, over the standard deviation of those to identify from [1].

        These have the mean 0 and the standard deviation 1; a single one has the level 1.
        """
        drawn = np.array([np.random.default_rng((each, 3)).standard_normal() for each in self.seeds])
        known = drawn[: self.identify]
        if self.identify < 2 or seed not in self.seeds:
            return 1.0
        return float(((drawn - known.mean()) / known.std())[self.seeds.index(seed)])

    def recordings(self, mover: Mover | None = None) -> tuple[SimulatedRecording, ...]:
        """Carry out all recordings, those to identify from first.

        Args:
            mover: moves the ball in place of the plant's own contact, if given.

        Raises:
            InputError: the ball does not stay on the beam.
        """
        return tuple(self.recording(seed, mover) for seed in self.seeds)

    def recording(self, seed: int, mover: Mover | None = None) -> SimulatedRecording:
        """One recording, with its own moves and its own noise (see `recordings`)."""
        run, written, commands = self._carried_out(seed)
        sensors, dt = self.sensors, self.step
        position, velocity, rolled = run.position, run.velocity, run.rolled_angle
        if mover is not None:
            position, velocity = mover(run, self.plant(seed, self.acting), State(float(run.position[0]), 0.0), run.time)
            rolled = np.full_like(position, math.nan)
            run = replace(run, position=position)
            written = self._written(run, commands, seed)
        stamps = np.minimum(written.time, run.time[-1])  # a late one may lie beyond the end
        return SimulatedRecording(
            written,
            np.interp(stamps, run.time, position),
            np.interp(stamps, run.time, velocity),
            np.interp(stamps, run.time, run.angle),
            np.interp(stamps, run.time, rolled),
            sensors.channel.read(position, dt, stamps),
            seed,
        )

    def carried_out(self, seed: int) -> tuple[Run, Record]:
        """What happened at every step of the recording with this seed, and its record.

        Raises:
            InputError: the ball does not stay within reach.
        """
        run, written, _ = self._carried_out(seed)
        return run, written

    def _carried_out(self, seed: int) -> tuple[Run, Record, FloatArray | None]:
        """The same with the commands, where there were any."""
        plant, sensors = self.plant(seed, self.acting), self.sensors
        for attempt in range(TRIES):
            run, written, commands = self._attempt(plant, sensors, seed, attempt)
            gone = (run.position < self.reach[0]) | (run.position > self.reach[1])
            if not gone.any():
                return run, written, commands
        advice = "Make the effects weaker, or widen it" if self.closed_loop else "Close the loop, or make it shorter"
        raise InputError(
            f"the ball leaves its reach, {self.reach[0]:g}–{self.reach[1]:g} m, with {TRIES} different moves; "
            f"with the last it leaves at {run.time[gone][0]:.1f} s. {advice}."
        )

    def _attempt(
        self, plant: Plant, sensors: Sensors, seed: int, attempt: int
    ) -> tuple[Run, Record, FloatArray | None]:
        generator = np.random.default_rng((seed, 2, attempt))
        start = random_start(generator) if self.start is None else self.start
        controller, protocol = (
            random_controller(generator, self.deflection),
            random_protocol(generator, start, self.duration),
        )
        if self.closed_loop and self.imperfections is not None:
            seen, servo = replace(sensors, laser=_clean(sensors.laser)), self.imperfections.servo(SERVO)
            seen = replace(seen, rate=self.imperfections.control_rate)
            run, _, commands = perform_commanded(protocol, plant, servo, controller, seen, seed)
            return run, self._written(run, commands, seed), commands
        if self.closed_loop:
            return *perform(protocol, plant, SERVO, controller, sensors, seed), None
        known = self.plant(seed, self.declared)
        rehearsal, _ = perform(protocol, known, SERVO, controller, replace(sensors, channel=Sensors().channel), seed)
        run = simulate(plant, rehearsal.shaft_motion, State(start, 0.0), self.duration)
        return run, self._written(run, None, seed), None

    def _written(self, run: Run, commands: FloatArray | None, seed: int) -> Record:
        """The record of a run that is given."""
        if self.imperfections is None:
            return record(run, self.sensors, seed)
        return imperfect_record(run, commands, self.sensors, self.imperfections, seed)


def _clean(laser: Laser) -> Laser:
    """A sensor of the same range that is good enough to control the ball by."""
    return replace(laser, noise_near=CLEAN, noise_far=CLEAN, resolution=CLEAN / 3.0)
