"""The ball's acceleration against the beam's angle: what tells units and signs from the data themselves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from analytic.motion import FloatArray
from harness.recording.known_rig import KnownRig
from harness.recording.plausibility import Signals, is_conclusive, longest_known_run
from harness.recording.tilt_response import TiltResponse, tilt_response

USUAL_SLOPES = (0.35, 0.85)
"""Slopes by which a unit is told. A ball has 1/(1 + J/(m r²)): 0.71 if solid and 0.6 if a shell on a flat beam, on
rails down to 0.4 (`tilt_response`); beyond that there is a sixth for the gains of sensors. Inches taken for
centimetres, or counts of an encoder for degrees, change the slope by 2.5 and more, which the wider bounds of `check`
let pass."""


def is_usual(slope: float) -> bool:
    """Whether a slope is one of a rolling ball, of either sign."""
    return USUAL_SLOPES[0] <= abs(slope) <= USUAL_SLOPES[1]


@dataclass(frozen=True)
class Evidence:
    """The regression of the ball's acceleration on g α.

    Attributes:
        response: of the data as they are; `None` if there are too few, or one signal is constant.
    """

    response: TiltResponse | None

    @property
    def conclusive(self) -> bool:
        """Whether the acceleration follows the angle clearly enough for any conclusion."""
        return self.response is not None and is_conclusive(self.response)

    @property
    def slope(self) -> float:
        """Acceleration over g α [1]; 0 without a response."""
        return 0.0 if self.response is None else self.response.slope

    def __str__(self) -> str:
        if self.response is None:
            return "the data are too few, or one signal is constant"
        return f"the ball's acceleration is {self.slope:+.3g} g α, correlation {self.response.correlation:.2f}"


def evidence_of(time: FloatArray, angle: FloatArray, position: FloatArray, *, gravity: float | None = None) -> Evidence:
    """Regresses the acceleration.

    Args:
        time: [s]; angle: α [rad]; position: s [m]; each of shape (n,), with NaN where unknown.
        gravity: g [m/s²].
    """
    order = np.argsort(time, kind="stable")
    time, angle, position = time[order], angle[order], position[order]
    known = np.isfinite(time) & np.isfinite(angle)
    known[1:] &= np.diff(time) > 0.0
    if known.sum() < 2:
        return Evidence(None)
    time, angle, position = time[known], angle[known], position[known]
    run = longest_known_run(
        Signals(time, angle, position, np.zeros(len(time), dtype=np.bool_), KnownRig(gravity=gravity))
    )
    if run is None or len(run[1]) > 10_000_000:
        return Evidence(None)
    return Evidence(tilt_response(*run, gravity=gravity or 9.81))
