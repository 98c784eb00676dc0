"""Library of motions for the next experiment, and the operating envelope of the rig.

The ball integrates the beam angle twice, so that a prescribed angle lets it run off the beam. Motions are therefore
target positions of the ball, and the angle follows from a simulated closed loop (`design.closed_loop`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from analytic.motion import FloatArray
from harness.identify.problem.problem import Problem

DURATION = 16.0  # of an experiment [s]
_HEADROOM = 1.2  # factor by which the limits exceed those seen in the recordings
_END = 0.05  # distance that the ball keeps from either end of the beam [m]
_SMALLEST = 2e-3  # smallest usable reach of the ball [m]: several times the noise of a reading
_OUTER = (0.5, 99.5)  # percentiles that exclude outliers and artefacts of the smoother
_FASTEST = 200.0  # highest sampling rate [Hz]: a higher one adds little and takes longer to simulate


@dataclass(frozen=True)
class OperatingEnvelope:
    """Ranges that a proposed experiment may use, as far as the recordings show them.

    Attributes:
        low, high: range of the ball position [m].
        angle, rate, acceleration: largest sizes of α, α̇, α̈ [rad, rad/s, rad/s²].
        interval: sampling interval [s].
        pull: acceleration of the ball per beam angle, K g [m/s² per rad].
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
        """Middle of the position range [m]."""
        return 0.5 * (self.low + self.high)

    @property
    def reach(self) -> float:
        """Half of the position range [m]."""
        return 0.5 * (self.high - self.low)

    @property
    def limits(self) -> FloatArray:
        """Limits of α, α̇, α̈, shape (3,)."""
        return np.array([self.angle, self.rate, self.acceleration])

    @property
    def time(self) -> FloatArray:
        """Stamps of an experiment [s]."""
        return self.interval * np.arange(round(DURATION / self.interval) + 1, dtype=np.float64)

    @property
    def usable(self) -> bool:
        """Whether the ball can be moved within it."""
        return self.reach > _SMALLEST and bool(np.all(self.limits > 0.0))

    def quickest(self, amplitude: float) -> float:
        """Angular frequency [rad/s] at which an oscillation of `amplitude` a [m] needs two thirds of a limit.

        α = a ω²/(K g), with a further power of ω for each derivative.
        """
        angle = 1.5 * amplitude / self.pull
        limits = (self.angle / angle) ** (1 / 2), (self.rate / angle) ** (1 / 3), (self.acceleration / angle) ** (1 / 4)
        return float(min(limits))


def envelope_of(problem: Problem, length: float | None = None) -> OperatingEnvelope:
    """Envelope from the recordings, with a fifth more for the beam; a beam of known `length` [m] extends the range of
    the ball up to 5 cm from either end."""
    ball = np.concatenate([recording.reading[np.isfinite(recording.reading)] for recording in problem.recordings])
    low, high = np.percentile(ball, _OUTER).tolist()
    if length is not None and low >= 0.0 and high <= length:  # position is measured from the beam's end
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
"""(stamps, shape (n,) [s], envelope) -> target of the ball relative to the middle [m], and an angle that is added to
that of the position controller [rad], shape (n,) each."""


@dataclass(frozen=True)
class Profile:
    """A motion of the library.

    Attributes:
        name: identifier in results.
        words: description for the report.
        move: target and added angle.
        hold: natural frequency of the position controller [rad/s].
    """

    name: str
    words: str
    move: Move
    hold: float = 2.5


def _ramp(time: FloatArray, span: float = 1.0) -> FloatArray:
    """Smooth transition from 0 to 1 within `span` [s], with a continuous rate."""
    x = np.clip(time / span, 0.0, 1.0)
    return x * x * (3.0 - 2.0 * x)


def _swing(share: float, period: float | None) -> Move:
    """A sine over a share of the reach, with a period [s] or as fast as the envelope allows."""

    def move(time: FloatArray, envelope: OperatingEnvelope) -> tuple[FloatArray, FloatArray]:
        amplitude = share * envelope.reach
        fastest = envelope.quickest(amplitude)
        omega = fastest if period is None else min(2.0 * np.pi / period, fastest)
        return amplitude * _ramp(time) * np.sin(omega * time), np.zeros_like(time)

    return move


def _places(shares: tuple[float, ...], share: float = 0.0) -> Move:
    """Equal dwells at positions given as shares of the reach, with a sine of `share` of the reach at each."""

    def move(time: FloatArray, envelope: OperatingEnvelope) -> tuple[FloatArray, FloatArray]:
        dwell = DURATION / len(shares)
        number = np.minimum((time / dwell).astype(int), len(shares) - 1)
        before = np.array([0.0, *shares])[number]
        after = np.array(shares)[number]
        since = time - dwell * number
        quick = np.pi / envelope.quickest(0.5 * envelope.reach * max(np.ptp([0.0, *shares]), 0.2))
        target = before + (after - before) * _ramp(since, min(quick, 0.8 * dwell))
        swing = share * np.sin(envelope.quickest(share * envelope.reach) * time) if share else 0.0
        return envelope.reach * (target + swing), np.zeros_like(time)

    return move


def _ramps(share: float, period: float) -> Move:
    """A triangle wave of a share of the reach, with a period [s]: constant speed to and fro."""

    def move(time: FloatArray, envelope: OperatingEnvelope) -> tuple[FloatArray, FloatArray]:
        wave = 2.0 / np.pi * np.arcsin(np.sin(2.0 * np.pi * time / period))
        return share * envelope.reach * wave, np.zeros_like(time)

    return move


def _chirp(share: float) -> Move:
    """A sine whose frequency rises from 0.5 rad/s to as fast as the envelope allows."""

    def move(time: FloatArray, envelope: OperatingEnvelope) -> tuple[FloatArray, FloatArray]:
        amplitude = share * envelope.reach
        slow, quick = 0.5, max(envelope.quickest(amplitude), 0.5)
        phase = slow * time + 0.5 * (quick - slow) * time**2 / DURATION
        return amplitude * _ramp(time) * np.sin(phase), np.zeros_like(time)

    return move


def _sines(share: float) -> Move:
    """Four sines with the phases of Schroeder (IEEE Trans. Information Theory 16, 1970), for a low crest factor."""

    def move(time: FloatArray, envelope: OperatingEnvelope) -> tuple[FloatArray, FloatArray]:
        amplitude = 0.5 * share * envelope.reach
        fastest = envelope.quickest(2.0 * amplitude)
        number = np.arange(4)
        waves = np.sin(np.outer(time, fastest * (0.25 + 0.25 * number)) - np.pi * number * (number + 1) / 4)
        return amplitude * _ramp(time) * (waves - waves[0]).sum(axis=1) / 1.5, np.zeros_like(time)

    return move


def _shaken(share: float, shares: tuple[float, ...], lowest: float, highest: float) -> Move:
    """Four sines from `lowest` to `highest` [rad/s] added to the angle, a share of its limit, at each ball position."""

    def move(time: FloatArray, envelope: OperatingEnvelope) -> tuple[FloatArray, FloatArray]:
        target, _ = _places(shares)(time, envelope)
        omega = np.geomspace(lowest, highest, 4)
        number = np.arange(4)
        # The largest amplitudes that rate and acceleration allow at each frequency.
        size = np.minimum(
            0.25 * share * envelope.angle,
            np.minimum(0.2 * envelope.rate / omega, 0.2 * envelope.acceleration / omega**2),
        )
        waves = np.sin(np.outer(time, omega) - np.pi * number * (number + 1) / 4) @ size
        return target, _ramp(time) * waves

    return move


def _tilts(share: float, period: float) -> Move:
    """A triangle wave of a share of the largest angle, with a period [s], added to a weak position controller."""

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
"""The motions tried; of equal ones the first is preferred."""
