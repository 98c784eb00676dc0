"""What stands between the measured angle and the beam's: a wrong gain, and play."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from analytic.compiled import njit
from analytic.effects.effect import Effect, Relations, Transmission, TrialSize
from analytic.effects.parameter import Parameter
from analytic.motion import BeamMotion, FloatArray

_PLAY_STEP = 5e-4  # grid on which the play's contacts are followed [s]: a beam of 1 rad/s moves by a third of a count


@dataclass(frozen=True)
class Scaled:
    """`gain` times another beam motion."""

    base: BeamMotion
    gain: float

    def angle(self, time: FloatArray) -> FloatArray:
        """α [rad] at `time` [s], same shape."""
        return self.gain * self.base.angle(time)

    def rate(self, time: FloatArray) -> FloatArray:
        """α̇ [rad/s] at `time` [s], same shape."""
        return self.gain * self.base.rate(time)

    def acceleration(self, time: FloatArray) -> FloatArray:
        """α̈ [rad/s²] at `time` [s], same shape."""
        return self.gain * self.base.acceleration(time)


@dataclass(frozen=True)
class Played:
    """A beam behind play: it stands while the linkage crosses the gap, and follows at ± half the width else.

    Attributes:
        base: the measured motion.
        time, stand: grid [s] and where the beam stands on it [rad], shape (k,).
        side: +1 or −1 where it is carried by that side of the gap, 0 where it stands, shape (k,).
        half: half the width [rad].
    """

    base: BeamMotion
    time: FloatArray
    stand: FloatArray
    side: FloatArray
    half: float

    def _at(self, time: FloatArray) -> np.ndarray:
        return np.clip(np.searchsorted(self.time, time, side="right") - 1, 0, len(self.time) - 1)

    def angle(self, time: FloatArray) -> FloatArray:
        """α [rad] at `time` [s], same shape."""
        n = self._at(time)
        return np.where(self.side[n] != 0.0, self.base.angle(time) - self.side[n] * self.half, self.stand[n])

    def rate(self, time: FloatArray) -> FloatArray:
        """α̇ [rad/s] at `time` [s], same shape; it jumps where the gap closes."""
        return np.where(self.side[self._at(time)] != 0.0, self.base.rate(time), 0.0)

    def acceleration(self, time: FloatArray) -> FloatArray:
        """α̈ [rad/s²] at `time` [s], same shape, without the jerk of a closing gap."""
        return np.where(self.side[self._at(time)] != 0.0, self.base.acceleration(time), 0.0)


@njit(cache=True)
def play(angle: FloatArray, half: float, stand: FloatArray, side: FloatArray) -> None:
    """Follow the play operator (Krasnosel'skii and Pokrovskii, 1989) from the middle of the gap; fills the outputs."""
    beam = angle[0]
    for n in range(len(angle)):
        side[n] = 0.0
        if angle[n] - beam >= half:
            beam, side[n] = angle[n] - half, 1.0
        elif beam - angle[n] >= half:
            beam, side[n] = angle[n] + half, -1.0
        stand[n] = beam


def transmitted(motion: BeamMotion, stamps: FloatArray, through: Transmission) -> BeamMotion:
    """The beam's motion behind the measured one, over a recording's stamps, shape (n,) [s]."""
    if through.gain != 1.0:
        motion = Scaled(motion, through.gain)
    if through.play == 0.0:
        return motion
    half = 0.5 * through.play
    count = int((stamps[-1] - stamps[0]) / _PLAY_STEP) + 1
    time = np.append(stamps[0] + _PLAY_STEP * np.arange(count), stamps[-1])
    stand, side = np.empty(len(time)), np.empty(len(time))
    play(motion.angle(time), half, stand, side)
    return Played(motion, time, stand, side, half)


ANGLE_GAIN = Effect(
    "angle_gain",
    "beam angle = gain × measured angle",
    (Parameter("gain", "1", 0.1, 10.0, 0.95, neutral=1.0),),
    "a scale error of the angle sensor or its gear",
    transmission=lambda values: Transmission(gain=values["gain"]),
    phrase="a gain of {gain} between measured and real beam angle",
    relations=Relations(stands_for="ratio"),
    trial=TrialSize({"gain": 1.05}, signed=True),
)
LINKAGE_BACKLASH = Effect(
    "linkage_backlash",
    "play of total width b between measured angle and beam",
    # a play as wide as the paper's beam turns, ±0.25 rad, leaves it where it is
    (
        Parameter(
            "width",
            "rad",
            0.0,
            0.5,
            0.005,
            starts=(0.002, 0.008),
            strength=True,
            shown=("°", float(np.degrees(1.0))),
        ),
    ),
    "Krasnosel'skii and Pokrovskii, Systems with Hysteresis, 1989",
    transmission=lambda values: Transmission(play=values["width"]),
    phrase="a linkage backlash of {width}",
    # the jolt of a gap that closes throws the ball off an engine's edges
    trial=TrialSize({"width": 0.0087}, engines=False),
)

DRIVE = (ANGLE_GAIN, LINKAGE_BACKLASH)
