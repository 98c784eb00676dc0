"""A drive at every n-th of its stamps, for readings that are used no more often.

It is estimated from all readings of the angle. Between stamps that are 15 ms apart its quintic differs from the one
through all stamps by what a beam does within that time, of which a ball shows nothing.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from analytic.quintic import QuinticMotion
from harness.signals.drive import Drive
from harness.signals.error_process import ErrorProcess


@dataclass(frozen=True, kw_only=True)
class SparseDrive(Drive):
    """Every `every`-th stamp of the drive `whole`."""

    whole: Drive
    every: int

    @cached_property
    def error(self) -> ErrorProcess:
        """The error of `states` as a Gauss–Markov process."""
        return self.whole.error.at(np.arange(0, len(self.whole.time), self.every))

    def rougher(self, factor: float) -> Drive:
        """See `Drive`."""
        return sparse(self.whole.rougher(factor), self.every)

    def quieter(self, share: float) -> Drive:
        """See `Drive`."""
        return sparse(self.whole.quieter(share), self.every)

    def draw(self, count: int, seed: int) -> list[QuinticMotion]:
        """Drawn from the posterior, with the drive's correlated error."""
        stamps = slice(None, None, self.every)
        return [QuinticMotion(self.time, path.states[stamps]) for path in self.whole.draw(count, seed)]


def sparse(drive: Drive, every: int) -> Drive:
    """The same at every `every`-th stamp; itself where that is each one, or where it is a command that jumps."""
    if every == 1 or drive.commanded:
        return drive
    stamps = slice(None, None, every)
    inflation = None if drive.inflation is None else drive.inflation[stamps]
    return SparseDrive(
        drive.time[stamps],
        drive.states[stamps],
        drive.std[stamps],
        drive.sensor,
        drive.residual_ratio,
        drive.reading[stamps],
        inflation,
        whole=drive,
        every=every,
    )
