"""Effects between the measured angle and the beam's: a gain error, a curve, backlash, steps, lags."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analytic.compiled import njit
from analytic.effects.effect import Effect, Follower, Relations, Transmission
from analytic.effects.following import CurvedMotion, held, lagged
from analytic.effects.parameter import Parameter
from analytic.effects.sensor import CHANNEL_DELAY
from analytic.effects.servo import behind_servo
from analytic.effects.source_code import Code
from analytic.motion import BeamMotion, FloatArray, ScaledMotion
from analytic.quintic import finely


@dataclass(frozen=True)
class BacklashMotion:
    """A beam behind a linkage with backlash: it rests while the linkage crosses the gap, else follows at ± half of it.

    Attributes:
        base: the measured motion.
        time, stand: grid [s] and the beam's angle on it [rad], shape (k,).
        side: the side of the gap that is in contact, +1 or −1, 0 where none is, shape (k,).
        half: half the gap's width [rad].
    """

    base: BeamMotion
    time: FloatArray
    stand: FloatArray
    side: FloatArray
    half: float

    def _at(self, time: FloatArray) -> np.ndarray:
        return np.clip(np.searchsorted(self.time, time, side="right") - 1, 0, len(self.time) - 1)

    def evaluate(self, time: FloatArray) -> FloatArray:
        """α [rad] at `time` [s], same shape."""
        n = self._at(time)
        return np.where(self.side[n] != 0.0, self.base.evaluate(time) - self.side[n] * self.half, self.stand[n])

    def derivative(self, time: FloatArray, order: int = 1) -> FloatArray:
        """α̇ [rad/s], which jumps where the gap closes, or α̈ [rad/s²] without these impulses; same shape as `time`."""
        return np.where(self.moved_at(time), self.base.derivative(time, order), 0.0)

    def moved_at(self, time: FloatArray) -> NDArray[np.bool_]:
        """Whether the linkage moves the beam at `time` [s], same shape."""
        return np.asarray(self.side[self._at(time)] != 0.0)


@njit(cache=True)
def play(angle: FloatArray, half: float, begin: float, stand: FloatArray, side: FloatArray) -> None:
    """Fill `stand` and `side` by the play operator (Krasnosel'skii and Pokrovskii, 1989).

    Args:
        begin: where the beam is at first, of half the gap from its middle, −1 … 1 [1].
    """
    beam = angle[0] + begin * half
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
        motion = ScaledMotion(motion, through.gain)
    return motion if through.play == 0.0 else beam_in_play(motion, stamps, through.play)


def beam_in_play(motion: BeamMotion, stamps: FloatArray, width: float, begin: float = 0.0) -> BacklashMotion:
    """The beam's motion behind a linkage with a gap of this width [rad], from `begin` on (`play`)."""
    half = 0.5 * width
    time, angle = finely(motion, stamps)
    stand, side = np.empty(len(time)), np.empty(len(time))
    play(angle, half, begin, stand, side)
    return BacklashMotion(motion, time, stand, side, half)


ANGLE_GAIN = Effect(
    "angle_gain",
    "beam angle = gain × measured angle",
    # half or twice the angle is another gear, not an error of it
    (Parameter("gain", "1", 0.1, 10.0, 0.95, neutral=1.0, usual=(0.5, 2.0)),),
    "a scale error of the angle sensor or its gear",
    transmission=lambda values: Transmission(gain=values["gain"]),
    code=Code(stage="gain"),
    phrase="a gain of {gain} between measured and real beam angle",
    relations=Relations(stands_for="ratio"),
)
LINKAGE_BACKLASH = Effect(
    "linkage_backlash",
    "play of total width b between measured angle and beam",
    # a play as wide as the paper's beam turns, ±0.25 rad, leaves it where it is; one of ±0.05 rad is seen by eye
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
            usual=(0.0, 0.1),
        ),
    ),
    "Krasnosel'skii and Pokrovskii, Systems with Hysteresis, 1989",
    transmission=lambda values: Transmission(play=values["width"]),
    code=Code(stage="play"),
    phrase="a linkage backlash of {width}",
)
ANGLE_LAG = Effect(
    "angle_lag",
    "the beam follows the recorded angle, or command, as T β̇ + β = α",
    # behind a lag that is longer than a move along the beam takes, some 1 s, the beam hardly turns
    (
        Parameter(
            "time_constant", "s", 0.0, 1.0, 0.05, starts=(0.02,), strength=True, shown=("ms", 1e3), usual=(0.0, 1.0)
        ),
    ),
    "first-order low pass",
    turn=lambda motion, stamps, values: lagged(motion, stamps, values["time_constant"]),
    follower=lambda values: Follower(values["time_constant"]),
    code=Code(stage="lag"),
    phrase="a lag of {time_constant} of the beam behind the recorded angle",
    relations=Relations(once=True, late=True),
)
ANGLE_SERVO = Effect(
    "angle_servo",
    "the beam follows the recorded angle, or command, as (T/2ζ)² β̈ + T β̇ + β = α",
    (
        Parameter("lag", "s", 0.0, 1.0, 0.1, starts=(0.05,), strength=True, shown=("ms", 1e3), usual=(0.0, 1.0)),
        # below, a step of the command swings for seconds; above, `angle_lag` says the same
        Parameter("damping", "1", 0.05, 5.0, 0.8, starts=(0.8,), fitted=lambda _, rig: (0.2, 2.0)),
    ),
    "position servo of second order: Franklin, Powell, Emami-Naeini, Feedback Control of Dynamic Systems, chapter 3",
    turn=lambda motion, stamps, values: behind_servo(motion, stamps, values["lag"], values["damping"]),
    follower=lambda values: Follower(values["lag"], (0.5 * values["lag"] / values["damping"]) ** 2),
    code=Code(stage="servo"),
    phrase="a servo that follows the recorded angle {lag} late, with a damping ratio of {damping}",
    relations=Relations(once=True, late=True, splits_into=(ANGLE_LAG, CHANNEL_DELAY)),
)
ANGLE_NONLINEARITY = Effect(
    "angle_nonlinearity",
    "beam angle = α + square α² + cube α³ of the measured angle α",
    # fitted so that the beam turns on with the angle within ±0.25 rad, which the paper's does
    (
        Parameter("square", "1/rad", -1.5, 1.5, 0.4, starts=(0.0,), strength=True, fitted=lambda _, rig: (-1.0, 1.0)),
        Parameter("cube", "1/rad²", -2.5, 10.0, 4.0, starts=(0.0,), strength=True, fitted=lambda _, rig: (-2.0, 10.0)),
    ),
    "geometry of a crank linkage or a servo horn, to third order",
    turn=lambda motion, stamps, values: CurvedMotion(motion, values["square"], values["cube"]),
    code=Code(stage="curve"),
    phrase="a curve between measured and real beam angle of {square} α² and {cube} α³",
    relations=Relations(once=True),
)
ANGLE_HOLD = Effect(
    "angle_hold",
    "beam = mean of the angle over the last T: of a beam, or command, held in steps of T; T/2 late, and smoother",
    # beyond steps of 0.5 s a beam is not driven, but put
    (Parameter("interval", "s", 0.0, 0.5, 0.1, starts=(0.05,), strength=True, shown=("ms", 1e3)),),
    "zero-order hold: Franklin, Powell, Workman, Digital Control of Dynamic Systems, 1998, chapter 4",
    turn=lambda motion, stamps, values: held(motion, stamps, values["interval"]),
    # (1 − e^(−Tp))/(Tp) = 1/(1 + Tp/2 + (Tp)²/12) up to (Tp)⁴
    follower=lambda values: Follower(0.5 * values["interval"], values["interval"] ** 2 / 12.0),
    code=Code(stage="hold"),
    phrase="a beam that holds its angle in steps of {interval}",
    relations=Relations(once=True, late=True),
)

DRIVE = (ANGLE_GAIN, ANGLE_NONLINEARITY, LINKAGE_BACKLASH, ANGLE_HOLD, ANGLE_LAG, ANGLE_SERVO)
