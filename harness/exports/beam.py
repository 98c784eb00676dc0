"""The beam of an exported scene: as long as the recordings need that the model was identified from."""

from __future__ import annotations

import math

from analytic.geometry import BEAM_TO, Channel, channel_of
from analytic.rig import Rig
from harness.errors import InputError
from harness.exports.model import ExportModel
from mjcf.scene import BALL_START

_BEYOND = 0.05  # by which the beam is longer than the ball needs at least [m]


def beam_range(model: ExportModel) -> tuple[float, float]:
    """From where to where the beam reaches along it [m].

    From the pivot to where the recorded ball got and, as a ball that is driven otherwise gets elsewhere, as far again
    on either side; where that is not known, alike on both sides of the pivot and as long as the paper's beam.
    """
    if model.visited is None:
        return -BEAM_TO, BEAM_TO
    low, high = model.visited
    margin = max(high - low, _BEYOND)
    return min(low - margin, -_BEYOND), max(high + margin, _BEYOND)


def beam_told(model: ExportModel) -> str:
    """The same in words, and where the ball starts."""
    low, high = beam_range(model)
    known = "the diagnosis does not tell which positions were recorded"
    if model.visited is not None:
        known = "positions from {:.2f} to {:.2f} m were recorded".format(*model.visited)
    return f"The beam reaches from {low:.2f} to {high:.2f} m: {known}. The ball starts at {start_of(model):g} m."


def start_of(model: ExportModel) -> float:
    """Where the ball lies at the start [m]: where the paper's does, or in the middle of what was recorded."""
    if model.visited is None or model.visited[0] <= BALL_START <= model.visited[1]:
        return BALL_START
    return round(0.5 * math.fsum(model.visited), 3)


def channel_in(model: ExportModel, rig: Rig) -> Channel:
    """The beam of a scene, for the rig of that scene."""
    low, high = beam_range(model)
    return channel_of(rig, x_from=low, x_to=high)


def check_point(model: ExportModel, position: float, angle: float) -> None:
    """Refuse an operating point that no rig has.

    Args:
        model: the model.
        position: of the ball [m].
        angle: the recorded angle [rad].

    Raises:
        InputError: the beam stands upright, or the ball is beyond its ends.
    """
    if not abs(angle) < 0.5 * math.pi:
        raise InputError(f"an operating point at an angle of {angle:g} rad; it must lie within ± 90°, ± 1.5708 rad")
    low, high = beam_range(model)
    if not low <= position <= high:
        raise InputError(
            f"an operating point at a position of {position:g} m; it must lie on the beam, which reaches from "
            f"{low:.2f} to {high:.2f} m as far as the diagnosis tells"
        )
