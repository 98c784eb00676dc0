"""The proposed next experiment and the separations expected from it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from operator import attrgetter

from analytic.motion import FloatArray
from harness.identify.design.excitation import OperatingEnvelope, Profile
from harness.recording.own_files import NEXT_EXPERIMENT

NOTHING = "nothing"
"""The rival of an effect that is to be detected."""
FILE = NEXT_EXPERIMENT
"""Name of the table beside diagnosis.json."""
MOST_RUNS = 10
"""Largest number of repetitions that is proposed."""


@dataclass(frozen=True)
class Separation:
    """Separation √ΔD of the identified model from a rival.

    Attributes:
        found, rival: names of the two.
        at_hand: on the existing recordings [σ]; 0 if the rival predicts better.
        expected: on these and the new one together [σ].
        needed: at which the two are distinguished [σ].
    """

    found: str
    rival: str
    at_hand: float
    expected: float
    needed: float

    @property
    def told(self) -> bool:
        """Whether the new recording is expected to distinguish them."""
        return self.expected >= self.needed

    @property
    def runs(self) -> int:
        """Number of runs needed to distinguish them, at most MOST_RUNS + 1; each adds equally to the square."""
        per_run = self.expected**2 - self.at_hand**2
        missing = self.needed**2 - self.at_hand**2
        return math.ceil(min(max(missing / max(per_run, 1e-12), 1.0), MOST_RUNS + 1.0))


@dataclass(frozen=True)
class Proposal:
    """The next experiment.

    Attributes:
        profile: of the library.
        time: stamps, shape (n,) [s].
        angle: of the beam, shape (n,) [rad].
        reading: predicted position readings, shape (n,) [m].
        separations: expected ones from each rival; from `NOTHING` for effects of typical size that are to be detected.
        open_loop_drift: standard deviation of the final position if the angle is replayed without feedback [m].
        tried: every feasible profile with its smallest separation [σ], or the number of effects it reveals.
        envelope: operating envelope of the rig.
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
        """`time_s, beam_angle_rad`, and the predicted `ball_position_m`."""
        return {"time_s": self.time, "beam_angle_rad": self.angle, "ball_position_m": self.reading}

    @property
    def smallest(self) -> Separation:
        """The smallest expected separation."""
        return min(self.separations, key=attrgetter("expected"))


def sentence(proposal: Proposal) -> str:
    """The recommendation in a sentence, with the expected result."""
    run = f"run the profile “{proposal.profile.name}”"
    separations = proposal.separations
    if separations[0].rival == NOTHING:
        detected = sorted((each for each in separations if each.told), key=lambda each: -each.expected)
        best = ", ".join(f"{each.found} at {each.expected:.1f} σ" for each in detected[:3])
        return (
            f"To detect more effects, {run}: of the {len(separations)} effects whose typical size is below the "
            f"detection limit of these recordings, it reveals {len(detected)} ({best})."
        )
    pair = proposal.smallest
    if pair.at_hand >= pair.needed:
        fewer = " and with fewer parameters" if pair.needed == 0.0 else ""
        return (
            f"The recordings distinguish {pair.found} from {pair.rival} by {pair.at_hand:.1f} σ"
            f"{fewer}; to separate them further, {run}: expected separation {pair.expected:.1f} σ."
        )
    if pair.runs > MOST_RUNS and not pair.told:
        return (
            f"No motion within the operating envelope distinguishes {pair.found} from {pair.rival}: the best of them, "
            f"“{proposal.profile.name}”, separates them by {pair.expected:.1f} σ, where {pair.needed:.1f} σ are needed."
        )
    at_hand = f" ({pair.at_hand:.1f} σ on the data at hand)" if pair.at_hand > 0.0 else ""
    text = f"To distinguish {pair.found} from {pair.rival}, {run}: expected separation {pair.expected:.1f} σ{at_hand}."
    if pair.told:
        return text
    return f"{text} To reach the {pair.needed:.1f} σ that distinguish them, run it {pair.runs} times."
