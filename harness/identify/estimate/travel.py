"""The travel within which predictions are kept where the likelihood does not explain the recordings.

A beam ends somewhere, and a controller keeps the ball from there. Neither is in the equation of motion: a model that is
wrong by a little has its ball leave the beam, and never return. Nothing in the recordings tells what a ball does
outside of where it was, so that such a prediction stays at the end of the travel.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from analytic.motion import FloatArray
from harness.identify.problem.problem import PreparedRecording
from harness.identify.problem.windows import Window


@dataclass(frozen=True)
class Travel:
    """From where to where a ball is predicted to be.

    Attributes:
        low, high: positions [m].
    """

    low: float = -np.inf
    high: float = np.inf

    @classmethod
    def of(cls, ends: tuple[float, float] | None) -> Travel:
        """The travel between these ends; anywhere without."""
        return ANYWHERE if ends is None else cls(*ends)

    @property
    def ends(self) -> tuple[float, float] | None:
        """Low and high; `None` where it has no ends."""
        return None if self == ANYWHERE else (self.low, self.high)

    def kept(self, position: FloatArray, reading: FloatArray) -> FloatArray:
        """Predicted positions, shape (n,), within the travel and the known readings of their recording [m].

        Args:
            reading: of the same recording, NaN where missing or not known, any shape [m].
        """
        known = reading[np.isfinite(reading)]
        return np.clip(position, np.min(known, initial=self.low), np.max(known, initial=self.high))


ANYWHERE = Travel()


def travel_of(parts: Sequence[PreparedRecording] | Sequence[Window]) -> Travel:
    """From the lowest to the highest reading of recordings or windows, one of which has a reading."""
    readings = np.concatenate([part.reading for part in parts])
    return Travel(float(np.nanmin(readings)), float(np.nanmax(readings)))
