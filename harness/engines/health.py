"""Health of an engine run, and the named ways in which a run can fail, each with its remedy."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum

_NUMBER = re.compile(r"\d+(?:\.\d+)?(?:e[-+]?\d+)?")


class Failure(StrEnum):
    """Why an engine run is invalid; the value describes cause and remedy."""

    LEFT_GROOVE = "the ball left the rails; check the start position, a jump in the angle, or lower the time step"
    LOST_CONTACT = "the ball does not touch the rails as it should; lower the time step or make the contact stiffer"
    EXTRA_CONTACT = "more points hold the ball than should; lower the time step or raise the contact breaking threshold"
    SLIPPED = "the ball slid instead of rolling; raise the friction coefficient"
    NOT_FINITE = "a state is not a finite number; lower the time step or make the contact softer"
    RESET = "the engine reset its state (bad acceleration); lower the time step or make the contact softer"
    FROZEN = "the engine repeated its state while time advanced; lower the time step"
    CRASHED = "the engine's package raised this; check its installation with another recording, and report it"
    LIFTED_OFF = (
        "the ball lifts off the beam: the normal force of CAM (eq. 14) falls below zero. What follows is no rolling; "
        "move the beam more gently, or end the recording before"
    )
    RAN_OFF = "the ball ran past the end of the rails; check the level angle and the start state"

    @property
    def of_the_rig(self) -> bool:
        """Whether every model says so too: the engine is right, and what was asked of it is no rolling."""
        return self is Failure.LIFTED_OFF


@dataclass(frozen=True)
class Health:
    """Extreme values during a run.

    Attributes:
        contacts_min: fewest contacts ball–beam in any checked step.
        contacts_max: most contacts.
        normal_force_min: smallest sum of normal forces' components normal to the edge plane [N].
        height_error_max: largest |height of the ball's centre above the edge plane − r| [m].
        lateral_offset_max: largest |y| of the ball's centre [m].
        slip_max: largest |ṡ − r (φ̇ − α̇)| after the first step [m/s].
        angle_error_max: largest |beam angle in the engine − angle asked for| [rad].
        steps: number of steps taken.
        warnings: issued by the engine itself.
        lifted_off: when the ball lifted off for the first time, although it came back so that the run is valid [s].
    """

    contacts_min: int
    contacts_max: int
    normal_force_min: float
    height_error_max: float
    lateral_offset_max: float
    slip_max: float
    angle_error_max: float
    steps: int
    warnings: tuple[str, ...] = ()
    lifted_off: float | None = None


def largest_of_each(warnings: Iterable[str]) -> tuple[str, ...]:
    """Each warning once; of those of many runs that differ in numbers alone, the one with the largest."""
    kinds: dict[str, list[str]] = {}
    for text in sorted(set(warnings)):
        kinds.setdefault(_NUMBER.sub("", text), []).append(text)
    return tuple(max(texts, key=lambda text: [float(one) for one in _NUMBER.findall(text)]) for texts in kinds.values())
