"""What is proposed as the next experiment, and what it is expected to tell."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from analytic.motion import FloatArray
from harness.identify.design.excitation import OperatingEnvelope, Profile

NOTHING = "nothing"
"""The rival of an effect that is to be seen at all."""
FILE = "next_experiment.csv"
"""Name of the table beside diagnosis.json."""
MOST_RUNS = 10
"""Of one experiment that anybody would make."""


@dataclass(frozen=True)
class Separation:
    """How far two explanations are apart.

    Attributes:
        found, rival: what is to be told from what.
        at_hand: on the recordings at hand [σ]; 0 where the rival even predicts better.
        expected: on these and the new one together [σ].
        needed: from which on they are told apart [σ].
    """

    found: str
    rival: str
    at_hand: float
    expected: float
    needed: float

    @property
    def told(self) -> bool:
        """Whether the new recording is expected to tell them apart."""
        return self.expected >= self.needed

    @property
    def runs(self) -> int:
        """How often the experiment has to be run for that: every run adds as much to the square."""
        each = self.expected**2 - self.at_hand**2
        missing = self.needed**2 - self.at_hand**2
        return math.ceil(min(max(missing / max(each, 1e-12), 1.0), MOST_RUNS + 1.0))


@dataclass(frozen=True)
class Proposal:
    """The next experiment.

    Attributes:
        profile: of the library.
        time: stamps, shape (n,) [s].
        angle: of the beam, shape (n,) [rad].
        reading: what the position sensor should record, shape (n,) [m].
        separations: what it would tell apart; against `nothing`, where an effect of typical size would be seen.
        drift: standard deviation of where the ball is at the end if the angle is played without feedback [m].
        tried: every profile that the rig can make, with its smallest separation [σ], or how many effects it shows.
        room: what the rig is taken to be able to do.
    """

    profile: Profile
    time: FloatArray
    angle: FloatArray
    reading: FloatArray
    separations: tuple[Separation, ...]
    open_loop_drift: float
    tried: Mapping[str, float]
    envelope: OperatingEnvelope

    def table(self) -> dict[str, FloatArray]:
        """`time_s, beam_angle_rad`, and the `ball_position_m` to be expected."""
        return {"time_s": self.time, "beam_angle_rad": self.angle, "ball_position_m": self.reading}

    @property
    def smallest(self) -> Separation:
        """Of the separations."""
        return min(self.separations, key=lambda one: one.expected)


def sentence(proposal: Proposal) -> str:
    """What to do, and what it would bring."""
    run = f"run the profile “{proposal.profile.name}”"
    every = proposal.separations
    if every[0].rival == NOTHING:
        seen = sorted((one for one in every if one.told), key=lambda one: -one.expected)
        best = ", ".join(f"{one.found} at {one.expected:.1f} σ" for one in seen[:3])
        return (
            f"To see what these recordings cannot show, {run}: of the effects that go unseen at their typical size it "
            f"shows {len(seen)} of {len(every)} ({best})."
        )
    one = proposal.smallest
    if one.at_hand >= one.needed:
        return (
            f"The recordings tell {one.found} from its nearest rival, {one.rival}, by {one.at_hand:.1f} σ; to tell "
            f"them better, {run}: expected separation {one.expected:.1f} σ."
        )
    text = (
        f"To tell {one.found} from {one.rival}, {run}: expected separation {one.expected:.1f} σ "
        f"({one.at_hand:.1f} σ on the data at hand)."
    )
    if one.told:
        return text
    if one.runs > MOST_RUNS:
        return f"{text} That is too little: no move within what this rig has shown tells them apart."
    return f"{text} To reach the {one.needed:.1f} σ that tell them apart, run it {one.runs} times."
