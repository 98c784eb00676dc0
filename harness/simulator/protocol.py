"""How a rig is recorded: sampled sensors, and a controller that moves the ball between targets."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np

from analytic.effects import sensor_with
from analytic.motion import FloatArray, State
from harness.simulator.channel import Channel
from harness.simulator.effects import Effects, checked, listed
from harness.simulator.plant import Plant, Run, Simulation
from harness.simulator.sensors import Encoder, Laser
from harness.simulator.servo import Servo


@dataclass(frozen=True)
class Record:
    """What the sensors wrote down; arrays of shape (n,).

    Attributes:
        time: [s].
        angle: as the encoder read it [rad].
        position: as the laser read it, NaN where it read nothing [m].
    """

    time: FloatArray
    angle: FloatArray
    position: FloatArray


@dataclass(frozen=True, kw_only=True)
class Sensors:
    """The sensors and how often they are read.

    Attributes:
        encoder: of the beam angle.
        laser: of the ball's position.
        channel: what lies between the ball and the laser's reading.
        rate: readings a second [Hz].
    """

    encoder: Encoder = field(default_factory=Encoder)
    laser: Laser = field(default_factory=Laser)
    channel: Channel = field(default_factory=Channel)
    rate: float = 100.0

    def with_effects(self, effects: Effects) -> Sensors:
        """The same sensors with those of `effects` that are theirs; the others are passed over.

        Raises:
            InputError: names or values that cannot be.
        """
        law, channel = sensor_with(listed(checked(effects))), self.channel
        channel = Channel(
            gain=channel.gain * law.gain,
            time_constant=channel.time_constant + law.lag,
            delay=channel.delay + law.delay,
            square=channel.square + law.square,
            cube=channel.cube + law.cube,
        )
        return replace(self, channel=channel)

    def stride(self, step: float) -> int:
        """Plant steps of `step` [s] between two readings.

        Raises:
            ValueError: the readings do not fall on plant steps.
        """
        stride = round(1.0 / (self.rate * step))
        if stride < 1 or not math.isclose(stride * step * self.rate, 1.0, rel_tol=1e-9):
            raise ValueError(f"a plant step of {step} s does not divide the sampling interval {1.0 / self.rate} s")
        return stride


def record(run: Run, sensors: Sensors, seed: int) -> Record:
    """Read the sensors during a run.

    Args:
        run: what happened.
        sensors: what is read, and how often.
        seed: of the sensors' noise.

    Returns:
        The readings from the first instant of the run on.

    Raises:
        ValueError: the readings do not fall on the run's instants.
    """
    dt = float(run.time[1] - run.time[0])
    time = run.time[:: sensors.stride(dt)].copy()
    encoder_noise, laser_noise = _generators(seed)
    return Record(
        time,
        sensors.encoder.measure(sensors.channel.beside(run.shaft, dt, time), encoder_noise),
        sensors.laser.measure(sensors.channel.read(run.position, dt, time), laser_noise),
    )


@dataclass(frozen=True, kw_only=True)
class Controller:
    """Proportional-derivative control of the measured position, as student rigs have it: no integral part.

    Attributes:
        gain: commanded angle per position error [rad/m].
        damping: commanded angle per velocity [rad s/m].
        filter_time: time constant of the low pass through which position and velocity are seen [s].
        deflection_limit: largest |commanded angle| [rad].
    """

    gain: float = 0.40
    damping: float = 0.31
    filter_time: float = 0.10
    deflection_limit: float = math.radians(3.5)

    def command(self, target: float, position: float, velocity: float, push: float = 0.0) -> float:
        """Angle asked of the servo [rad] for a target, a seen position [m] and velocity [m/s], and a push [rad]."""
        wanted = self.gain * (target - position) - self.damping * velocity + push
        return min(max(wanted, -self.deflection_limit), self.deflection_limit)


@dataclass(frozen=True)
class Protocol:
    """One experiment: the ball lies still on the level beam and is then sent from target to target.

    Attributes:
        start: where the ball lies [m].
        targets: (from when [s], where to [m]), in order of time.
        duration: [s].
        shaking: (amplitude [rad], frequency [rad/s], phase [rad]) of sines that push the command besides.
        strength: (when [s], factor) of the shaking, linear between them and constant outside.
    """

    start: float
    targets: tuple[tuple[float, float], ...]
    duration: float
    shaking: tuple[tuple[float, float, float], ...] = ()
    strength: tuple[tuple[float, float], ...] = ((0.0, 1.0),)

    def target(self, time: float) -> float:
        """Where the ball should be at `time` [s]: the start, or the latest target [m]."""
        reached = [place for begin, place in self.targets if begin <= time]
        return reached[-1] if reached else self.start

    def push(self, time: FloatArray) -> FloatArray:
        """What is added to the commanded angle at `time`, shape (n,) [s]; the same shape [rad]."""
        sines = sum((a * np.sin(w * time + p) for a, w, p in self.shaking), np.zeros_like(time))
        return sines * np.interp(time, *np.transpose(self.strength))


def perform(
    protocol: Protocol, plant: Plant, servo: Servo, controller: Controller, sensors: Sensors, seed: int
) -> tuple[Run, Record]:
    """Carry out an experiment in closed loop: the controller sees what is recorded, and nothing else.

    Where the laser reads nothing the controller goes on with its last reading.

    Args:
        protocol: the experiment.
        plant: the ball on its beam.
        servo: what turns the beam.
        controller: runs once for each reading of the sensors.
        sensors: what is read, and how often.
        seed: of the sensors' noise, and of how the ball lies at the start.

    Returns:
        What happened, and what was recorded of it.

    Raises:
        ValueError: the readings do not fall on plant steps.
    """
    run, written, _ = perform_commanded(protocol, plant, servo, controller, sensors, seed)
    return run, written


def perform_commanded(
    protocol: Protocol, plant: Plant, servo: Servo, controller: Controller, sensors: Sensors, seed: int
) -> tuple[Run, Record, FloatArray]:
    """The same as `perform`, and the angle that the controller commanded at each reading, shape (n,) [rad]."""
    stride = sensors.stride(plant.step)
    simulation = Simulation(plant, State(protocol.start, 0.0), protocol.duration)
    simulation.begin()
    encoder_noise, laser_noise = _generators(seed)
    instants = np.arange(0, simulation.time.size, stride)
    times = simulation.time[instants]
    position, pushes, lagged = (
        np.empty(instants.size),
        protocol.push(times),
        np.full(simulation.time.size, protocol.start),
    )
    commands = np.empty(instants.size)
    seen = reading = protocol.start
    for number, here in enumerate(instants.tolist()):
        delivered = sensors.channel.delivered(lagged[: here + 1], plant.step, times[number : number + 1])
        position[number] = sensors.laser.measure(delivered, laser_noise)[0]
        reading = reading if math.isnan(position[number]) else float(position[number])
        velocity = (reading - seen) / (controller.filter_time + 1.0 / sensors.rate)
        seen += velocity / sensors.rate
        command = controller.command(protocol.target(float(times[number])), seen, velocity, float(pushes[number]))
        commands[number] = command
        period = slice(here, here + stride + 1)
        servo.follow(command, plant.step, *simulation.shaft[:, period])
        simulation.advance(min(here + stride, simulation.time.size - 1))
        sensors.channel.lag(simulation.position[period], lagged[period], plant.step)
    angle = sensors.channel.beside(simulation.shaft[0], plant.step, times)
    return simulation.run(), Record(times.copy(), sensors.encoder.measure(angle, encoder_noise), position), commands


def recording_text(record: Record) -> str:
    """A recording as CSV: `time_s, beam_angle_rad, ball_position_m`; a position that was not read is blank."""
    lines = ["time_s,beam_angle_rad,ball_position_m"]
    for time, angle, position in zip(record.time, record.angle, record.position, strict=True):
        lines.append(f"{time:.4f},{angle:.7f},{'' if math.isnan(position) else f'{position:.4f}'}")
    return "\n".join(lines) + "\n"


def _generators(seed: int) -> tuple[np.random.Generator, np.random.Generator]:
    """Independent noise for encoder and laser, so that neither depends on how often the other is read."""
    encoder, laser, _ = np.random.SeedSequence(seed).spawn(3)
    return np.random.default_rng(encoder), np.random.default_rng(laser)


def turned_before(seed: int) -> float:
    """How the ball happens to lie at the start of the recording with this seed, φ₀ in 0 … 2π [rad]."""
    return float(np.random.default_rng(np.random.SeedSequence(seed).spawn(3)[2]).uniform(0.0, 2.0 * math.pi))
