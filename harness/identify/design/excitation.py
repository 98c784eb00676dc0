"""Moves that a next experiment may make, each as a target for the ball and a push on the beam.

A beam angle that is laid down beforehand runs the ball off the beam, for the ball integrates it twice. Moves are
therefore laid down as where the ball should be; the angle follows from a simulated
closed loop (`harness.identify.design.closed_loop`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from analytic.motion import FloatArray
from harness.identify.problem.problem import Problem

DURATION = 16.0  # [s]
_HEADROOM = 1.2  # by which a rig may go beyond what the recordings show of it
_END = 0.05  # that stays free at either end of a beam [m]
_LEAST = 2e-3  # reach in which a ball can be moved [m]: some readings' noise
_OUTER = (0.5, 99.5)  # percentiles: what lies beyond may be a spike or the smoother's
_FASTEST = 200.0  # [Hz]: readings that come faster say little more of the moves and take longer to judge


@dataclass(frozen=True)
class OperatingEnvelope:
    """What a rig is known to do, for nobody declares its limits.

    Attributes:
        low, high: where the ball may be [m].
        angle, rate, acceleration: of the beam, largest sizes [rad, rad/s, rad/s²].
        interval: between readings [s].
        pull: acceleration of the ball per angle, K g [m/s² per rad].
    """

    low: float
    high: float
    angle: float
    rate: float
    acceleration: float
    interval: float
    pull: float

    @property
    def middle(self) -> float:
        """Between the ends [m]."""
        return 0.5 * (self.low + self.high)

    @property
    def reach(self) -> float:
        """From the middle to either end [m]."""
        return 0.5 * (self.high - self.low)

    @property
    def limits(self) -> FloatArray:
        """Of α, α̇, α̈, shape (3,)."""
        return np.array([self.angle, self.rate, self.acceleration])

    @property
    def time(self) -> FloatArray:
        """Stamps of an experiment [s]."""
        return self.interval * np.arange(round(DURATION / self.interval) + 1, dtype=np.float64)

    @property
    def usable(self) -> bool:
        """Whether a ball can be moved in it at all."""
        return self.reach > _LEAST and bool(np.all(self.limits > 0.0))

    def quickest(self, amplitude: float) -> float:
        """Angular frequency at which a ball that swings by `amplitude` [m] asks for two thirds of what there is.

        α = a ω²/(K g), and a power of ω more for each derivative; in [rad/s].
        """
        angle = 1.5 * amplitude / self.pull
        limits = (self.angle / angle) ** (1 / 2), (self.rate / angle) ** (1 / 3), (self.acceleration / angle) ** (1 / 4)
        return float(min(limits))


def envelope_of(problem: Problem, length: float | None = None) -> OperatingEnvelope:
    """What the recordings show that the rig can do, and a fifth more; on a beam of known `length` [m] the ball may go
    up to 5 cm from either end, else no further than it went."""
    ball = np.concatenate([recording.reading[np.isfinite(recording.reading)] for recording in problem.recordings])
    low, high = np.percentile(ball, _OUTER).tolist()
    if length is not None and low >= 0.0 and high <= length:  # it is counted from the beam's end
        low, high = min(low, _END), max(high, length - _END)
    states = np.abs(np.concatenate([recording.drive.states for recording in problem.recordings]))
    angle = float(states[:, 0].max())
    rate, acceleration = np.percentile(states[:, 1:], _OUTER[1], axis=0).tolist()
    interval = float(np.median(np.concatenate([np.diff(recording.time) for recording in problem.recordings])))
    return OperatingEnvelope(
        low,
        high,
        _HEADROOM * angle,
        _HEADROOM * rate,
        _HEADROOM * acceleration,
        round(max(interval, 1.0 / _FASTEST), 6),
        problem.rig.gravity * problem.rig.rolling_ratio,
    )


Move = Callable[[FloatArray, OperatingEnvelope], tuple[FloatArray, FloatArray]]
"""(stamps, shape (n,) [s], room) -> where the ball should be, relative to the middle [m], and what is added to the beam
angle that keeps it there [rad], shape (n,) each."""


@dataclass(frozen=True)
class Profile:
    """One entry of the library.

    Attributes:
        name: for results.
        words: what it does, for people.
        move: the law.
        hold: natural frequency with which the target is followed [rad/s].
    """

    name: str
    words: str
    move: Move
    hold: float = 2.5


def _envelope(time: FloatArray, span: float = 1.0) -> FloatArray:
    """From 0 to 1 without a jolt."""
    x = np.clip(time / span, 0.0, 1.0)
    return x * x * (3.0 - 2.0 * x)


def _swing(share: float, period: float | None) -> Move:
    """A sine over a share of the reach; as quick as the rig allows where no period is given [s]."""

    def move(time: FloatArray, envelope: OperatingEnvelope) -> tuple[FloatArray, FloatArray]:
        amplitude = share * envelope.reach
        most = envelope.quickest(amplitude)
        omega = most if period is None else min(2.0 * np.pi / period, most)
        return amplitude * _envelope(time) * np.sin(omega * time), np.zeros_like(time)

    return move


def _places(shares: tuple[float, ...], share: float = 0.0) -> Move:
    """From place to place, each a share of the reach from the middle, and a swing of `share` of the reach at each."""

    def move(time: FloatArray, envelope: OperatingEnvelope) -> tuple[FloatArray, FloatArray]:
        dwell = DURATION / len(shares)
        number = np.minimum((time / dwell).astype(int), len(shares) - 1)
        before = np.array([0.0, *shares])[number]
        after = np.array(shares)[number]
        since = time - dwell * number
        quick = np.pi / envelope.quickest(0.5 * envelope.reach * max(np.ptp([0.0, *shares]), 0.2))
        target = before + (after - before) * _envelope(since, min(quick, 0.8 * dwell))
        swing = share * np.sin(envelope.quickest(share * envelope.reach) * time) if share else 0.0
        return envelope.reach * (target + swing), np.zeros_like(time)

    return move


def _ramps(share: float, period: float) -> Move:
    """To and fro at constant speed."""

    def move(time: FloatArray, envelope: OperatingEnvelope) -> tuple[FloatArray, FloatArray]:
        wave = 2.0 / np.pi * np.arcsin(np.sin(2.0 * np.pi * time / period))
        return share * envelope.reach * wave, np.zeros_like(time)

    return move


def _chirp(share: float) -> Move:
    """A sine that grows from slow to as quick as the rig allows."""

    def move(time: FloatArray, envelope: OperatingEnvelope) -> tuple[FloatArray, FloatArray]:
        amplitude = share * envelope.reach
        slow, quick = 0.5, max(envelope.quickest(amplitude), 0.5)
        phase = slow * time + 0.5 * (quick - slow) * time**2 / DURATION
        return amplitude * _envelope(time) * np.sin(phase), np.zeros_like(time)

    return move


def _sines(share: float) -> Move:
    """Four sines together, with the phases of Schroeder (IEEE Trans. Information Theory 16, 1970): a flat sum."""

    def move(time: FloatArray, envelope: OperatingEnvelope) -> tuple[FloatArray, FloatArray]:
        each = 0.5 * share * envelope.reach
        quick = envelope.quickest(2.0 * each)
        number = np.arange(4)
        waves = np.sin(np.outer(time, quick * (0.25 + 0.25 * number)) - np.pi * number * (number + 1) / 4)
        return each * _envelope(time) * (waves - waves[0]).sum(axis=1) / 1.5, np.zeros_like(time)

    return move


def _shaken(share: float, shares: tuple[float, ...], lowest: float, highest: float) -> Move:
    """The beam is shaken by `share` of its angle, slowly to quickly [rad/s], while the ball is held place by place."""

    def move(time: FloatArray, envelope: OperatingEnvelope) -> tuple[FloatArray, FloatArray]:
        target, _ = _places(shares)(time, envelope)
        omega = np.geomspace(lowest, highest, 4)
        number = np.arange(4)
        # As large as the servo's rate and acceleration allow at each frequency.
        size = np.minimum(
            0.25 * share * envelope.angle,
            np.minimum(0.2 * envelope.rate / omega, 0.2 * envelope.acceleration / omega**2),
        )
        waves = np.sin(np.outer(time, omega) - np.pi * number * (number + 1) / 4) @ size
        return target, _envelope(time) * waves

    return move


def _tilts(share: float, period: float) -> Move:
    """The beam is tilted slowly to and fro through the level, against a loosely held ball."""

    def move(time: FloatArray, envelope: OperatingEnvelope) -> tuple[FloatArray, FloatArray]:
        push = share * envelope.angle * 2.0 / np.pi * np.arcsin(np.sin(2.0 * np.pi * time / period))
        return np.zeros_like(time), push

    return move


LIBRARY = (
    Profile("slow swing", "the ball swings slowly over all of the beam", _swing(0.9, 8.0)),
    Profile("quick swing", "the ball swings over all of the beam, as quickly as the servo can", _swing(0.9, None)),
    Profile("half swing", "the ball swings over half of the beam, as quickly as the servo can", _swing(0.45, None)),
    Profile("creeping swing", "the ball creeps to and fro by a tenth of the beam", _swing(0.12, 6.0)),
    Profile("steps", "the ball is sent from end to end every two seconds", _places((-0.8, 0.8) * 4)),
    Profile("short steps", "the ball is sent to and fro by a third of the beam", _places((-0.3, 0.3) * 5)),
    Profile("holds", "the ball is held at five places along the beam", _places((-0.85, -0.4, 0.0, 0.4, 0.85))),
    Profile("both ends", "the ball swings at one end, then at the other", _places((-0.7, 0.7), 0.2)),
    Profile("hold and release", "the ball lies still between long rolls", _places((0.0, 0.8, 0.8, -0.8))),
    Profile("ramps", "the ball rolls to and fro at a constant slow speed", _ramps(0.85, 8.0)),
    Profile("quick ramps", "the ball rolls to and fro at a constant speed", _ramps(0.8, 4.0)),
    Profile("chirp", "the ball swings slowly, then ever quicker", _chirp(0.6)),
    Profile("four sines", "the ball swings at four frequencies together", _sines(0.8)),
    Profile("shaking", "the beam is shaken while the ball is held in the middle", _shaken(0.6, (0.0,), 2.0, 12.0)),
    Profile("shaking at ends", "the beam is shaken with the ball at either end", _shaken(0.4, (-0.6, 0.6), 2.0, 9.0)),
    Profile("slow tilts", "the beam tilts slowly through the level", _tilts(0.3, 6.0), 1.0),
)
"""What is tried, in the order in which equals are preferred."""
