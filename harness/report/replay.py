"""The replay: the tilting beam from the side with the balls of all sources, as data of the page.

The script that draws it is `assets/replay.js`; the balls' positions are those of charts on the same page.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from analytic.motion import FloatArray
from analytic.rig import Rig
from harness.report.chart import MAX_ROWS, Mark, pack, thinned


@dataclass(frozen=True)
class Run:
    """What may be replayed: the traces of a chart's first panel, which are positions [m].

    Attributes:
        title: for the choice between several.
        chart: anchor of the chart.
        clock: of that chart.
        time: of the beam's angle, shape (n,) [s].
        angle: shape (n,) [rad].
        marks: instants and spans marked on its time slider.
    """

    title: str
    chart: str
    clock: str
    time: FloatArray
    angle: FloatArray
    marks: Sequence[Mark] = ()


@dataclass(frozen=True)
class Replay:
    """The beam, and what may be replayed on it.

    Attributes:
        anchor: unique on the page.
        rig: sizes of ball and beam.
        low, high: ends of the track that is drawn [m].
        reference: key of the trace that the others are compared with.
        runs: at least one.
    """

    anchor: str
    rig: Rig
    low: float
    high: float
    reference: str
    runs: Sequence[Run]

    def data(self) -> dict[str, Any]:
        """What the script draws, for `json.dumps`."""
        return {
            "id": self.anchor,
            "radius": self.rig.radius,
            "rolling": self.rig.rolling_radius,
            "eccentricity": self.rig.eccentricity,
            "low": self.low,
            "high": self.high,
            "reference": self.reference,
            "runs": [_run(one) for one in self.runs],
        }


def _run(run: Run) -> dict[str, Any]:
    kept = thinned([np.asarray(run.angle, dtype=np.float64)], MAX_ROWS)
    return {
        "title": run.title,
        "chart": run.chart,
        "clock": run.clock,
        "time": pack(run.time[kept], "<f8"),
        "angle": pack(run.angle[kept]),
        "marks": [vars(one) for one in run.marks],
    }


def track(positions: FloatArray, margin: float = 0.15) -> tuple[float, float]:
    """Ends of the track to be drawn: the positions' range, the pivot, and a margin [m]."""
    low, high = min(float(np.nanmin(positions)), 0.0), max(float(np.nanmax(positions)), 0.0)
    room = margin * (high - low)
    return low - room, high + room
