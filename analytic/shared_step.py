"""One step of several balls on the same beam: what is the same for all of them is computed once, where few effects act.

A filter moves its mean and, for the derivatives, balls that are a little off. They differ in place and velocity, not in
the beam's motion. Results are those of `analytic.step.advance` bit for bit (tests/analytic/test_shared_step.py).
"""

from __future__ import annotations

from typing import NamedTuple

from analytic import slots
from analytic.compiled import njit
from analytic.lean_step import (
    DAMPED,
    DAMPED_DRY,
    DRY,
    GENERAL,
    Friction,
    Push,
    damped_step,
    friction_at,
    lost_to,
    push_at,
    resisted,
    smooth_step,
)
from analytic.motion import FloatArray
from analytic.step import advance


class BeamStep(NamedTuple):
    """What the beam does to any ball over one step of a lean path: at its start, middle and end, and to friction."""

    begin: Push
    middle: Push
    end: Push
    friction: Friction


@njit(cache=True, inline="always")
def beam_step(path: int, beam: FloatArray, row: int, p: FloatArray) -> BeamStep:
    """From the three rows of the beam's table from `row` on, as for `advance`; zeros on the path `GENERAL`."""
    if path == GENERAL:
        none = Push(0.0, 0.0, 0.0)
        return BeamStep(none, none, none, Friction(0.0, 0.0, 0.0, 0.0, 0.0, 0.0))
    begin, middle, end = push_at(beam, row, p), push_at(beam, row + 1, p), push_at(beam, row + 2, p)
    return BeamStep(begin, middle, end, friction_at(beam, row + 1, p))


@njit(cache=True, inline="always")
def ball_step(
    path: int, on: BeamStep, s: float, v: float, w: float, h: float, beam: FloatArray, row: int, p: FloatArray
) -> tuple[float, float, float]:
    """(s, ṡ, w) after a step of `h` [s]: `advance`, with what `beam_step` gives for the same path, rows and vector."""
    if path == GENERAL:
        return advance(s, v, w, h, beam, row, p)
    if path in (DAMPED, DAMPED_DRY):
        lost = lost_to(on.friction, s, v, h, p) if path == DAMPED_DRY else 0.0
        s_end, v_end = damped_step(s, v, h, on.begin, on.middle, on.end, lost, p)
    else:
        s_end, v_end = smooth_step(s, v, h, on.begin, on.middle, on.end, p[slots.CENTRIFUGAL])
    if path in (DRY, DAMPED_DRY):
        s_end, v_end = resisted(s, v, h, s_end, v_end, on.friction, p)
    return s_end, v_end, w
