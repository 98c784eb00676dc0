"""What is wrong with a record although nothing more acts on the ball: lags, drop-outs, spikes, stamps, noise, zero.

An imperfection is no effect of the catalogue and needs none: it lies between what happened and what was written down.
"""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass

from harness.simulator.servo import Servo

FASTEST = 10.0  # rad/s; a servo that is to lag is not limited besides, so that its lag is the one asked for


@dataclass(frozen=True, kw_only=True)
class WornPlace:
    """A stretch of a resistive track on which the wiper's contact is false.

    Attributes:
        start, end: of the stretch [m].
        step: added to the position while the ball is on it [m].
    """

    start: float
    end: float
    step: float


@dataclass(frozen=True, kw_only=True)
class Imperfections:
    """A rig whose record is imperfect; the defaults are a perfect one.

    The controller of such a rig sees the position as a clean sensor reads it, `control_rate` times a second, and the
    record is made beside it: what is imperfect is the record, never the experiment. Only a servo that lags also turns
    the beam differently.

    Attributes:
        sensor_lag: time constant of the position sensor's first-order lag [s].
        repeated: share of the positions that repeat the reading before [1].
        missing: share of the positions that are blank [1].
        dropout_length: mean length of a run of repeated, or of missing, readings [1].
        spiked: share of the positions that are spikes [1].
        spike_low, spike_high: sizes between which spikes are drawn evenly [m].
        spike_side: 1 or −1, the side to which all of them go [1].
        worn: false stretches of the track.
        uneven: standard deviation of the sampling interval over its mean; the stamps are true [1].
        stamp_error: standard deviation of an error of each stamp over the interval [1].
        bunch: readings that are stamped together, when the last of them is there [1].
        noise_time: correlation time of the position noise, e^(−Δt/τ) between readings Δt apart; 0: white [s].
        drift: amplitude of the wandering zero of the recorded angle, which is right at the start [rad].
        drift_period: of that wandering [s].
        servo_lag: 2 ζ/ω₀ of the servo between the command and the beam [s]; if it is positive, the command is
            recorded in place of the beam's angle.
        servo_damping: ζ [1].
        control_rate: how often the controller gives a command, which is held in between [Hz].

    Raises:
        ValueError: a value is out of its range.
    """

    sensor_lag: float = 0.0
    repeated: float = 0.0
    missing: float = 0.0
    dropout_length: float = 3.0
    spiked: float = 0.0
    spike_low: float = 0.02
    spike_high: float = 0.06
    spike_side: int = 1
    worn: tuple[WornPlace, ...] = ()
    uneven: float = 0.0
    stamp_error: float = 0.0
    bunch: int = 1
    noise_time: float = 0.0
    drift: float = 0.0
    drift_period: float = 30.0
    servo_lag: float = 0.0
    servo_damping: float = 0.7
    control_rate: float = 100.0

    def __post_init__(self) -> None:
        for name in ("sensor_lag", "noise_time", "servo_lag", "uneven", "stamp_error", "spike_low"):
            value = getattr(self, name)
            if not 0.0 <= value < math.inf:
                raise ValueError(f"{name} is {value}; it must be finite and not negative")
        for name in ("repeated", "missing", "spiked"):
            value = getattr(self, name)
            if not 0.0 <= value <= 0.5:
                raise ValueError(f"{name} is {value}; a share must lie between 0 and 0.5")
        for name in ("dropout_length", "bunch"):
            value = getattr(self, name)
            if not 1.0 <= value < math.inf:
                raise ValueError(f"{name} is {value}; it must be at least 1")
        for name in ("drift_period", "servo_damping", "control_rate"):
            value = getattr(self, name)
            if not 0.0 < value < math.inf:
                raise ValueError(f"{name} is {value}; it must be positive")
        if not math.isfinite(self.drift):
            raise ValueError(f"drift is {self.drift}; it must be finite")
        if not self.spike_low <= self.spike_high < math.inf:
            raise ValueError(f"spike_high is {self.spike_high}; it must be finite and at least spike_low")
        if self.spike_side not in (-1, 1):
            raise ValueError(f"spike_side is {self.spike_side}; it must be 1 or -1")

    def servo(self, usual: Servo) -> Servo:
        """What turns the beam: `usual`, or a linear servo with the lag asked for."""
        if self.servo_lag == 0.0:
            return usual
        frequency = 2.0 * self.servo_damping / self.servo_lag
        return Servo(frequency, self.servo_damping, rate_limit=FASTEST, acceleration_limit=FASTEST * frequency)

    def described(self) -> dict[str, object]:
        """All of them by the names of their attributes, for `truth.json` (SI)."""
        return {name: list(value) if isinstance(value, tuple) else value for name, value in asdict(self).items()}
