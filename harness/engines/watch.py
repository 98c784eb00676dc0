"""Validity check of an engine run from the path at every step and sampled contacts; an invalid run raises."""

from __future__ import annotations

import math
from array import array
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from analytic.geometry import channel_of
from analytic.lift_off import first_lift_off
from analytic.motion import BallForce, FloatArray
from analytic.rig import Rig
from harness.engines.health import Failure, Health
from harness.engines.leapfrog import Grid, Track
from harness.errors import EngineFailure

# What a ball does that has lifted off, or is about to: the grip goes with the normal force, some steps before.
_AFTER_LIFT_OFF = (Failure.SLIPPED, Failure.EXTRA_CONTACT, Failure.LEFT_GROOVE, Failure.LOST_CONTACT)
_NEARLY = 0.01  # [s]
STANDSTILL = 1e-9  # [rad] per step, [m/s]: smaller motions may be lost in rounding


@dataclass(frozen=True)
class Limits:
    """Bounds of a valid run.

    Attributes:
        across: |y| [m].
        height: |height of the ball's centre − r| [m].
        along: |s − middle| [m].
        slip: |ṡ − r (φ̇ − α̇)| [m/s].
        middle: of the rails [m].
        contacts: fewest and most contacts that carry the ball.
    """

    across: float
    height: float
    along: float
    slip: float
    middle: float
    contacts: tuple[int, int]

    def exceeded(self, along: float, across: float, height_error: float) -> bool:
        """Whether a ball at s, y and this height error [m] is out of bounds or NaN."""
        return not (
            abs(along - self.middle) <= self.along and abs(across) <= self.across and abs(height_error) <= self.height
        )


def limits_of(rig: Rig, *, reach: float, slip: float) -> Limits:
    """Limits for `rig` on rails from −reach to +reach [m]."""
    return Limits(
        # The top of the edge is at |y| = w/2. In a valid run |y| stays below 0.1 µm; at half of w/2 the ball leaves.
        # Nothing guides it on a flat rail, where it may not meet a guard.
        across=channel_of(rig).lateral_limit,
        # A valid run keeps 0.2 µm at dt = 1 ms. A tenth of r means a rolling radius, hence a slope of s over φ, 10 %
        # off; a falling ball reaches it after √(0.2 r/g) = 15 ms.
        height=0.1 * rig.rolling_radius,
        along=reach - rig.radius,
        slip=slip,
        middle=0.0,
        contacts=(channel_of(rig).contacts,) * 2,
    )


def _integers() -> array[int]:
    return array("q")


def _floats() -> array[float]:
    return array("d")


@dataclass
class Samples:
    """Contacts and drive at sampled steps, filled in by the engine during the run, or at once after it.

    The columns can be appended to, and are read by NumPy without a copy: of a run of a minute there are 6000 samples.

    Attributes:
        step: index n of each sample.
        contacts: number of ball–beam contacts that carry a force.
        normal_force: sum of their normal forces' components normal to the edge plane [N].
        angle_error: |beam angle in the engine − α| [rad].
        frozen: step at which the engine repeated a state, if any.
        stopped: step, kind and text of a failure that the engine itself reports, if any.
        extremes: values of `Health` that the engine knows of every step, in place of those of the samples.
    """

    step: array[int] = field(default_factory=_integers)
    contacts: array[int] = field(default_factory=_integers)
    normal_force: array[float] = field(default_factory=_floats)
    angle_error: array[float] = field(default_factory=_floats)
    frozen: int | None = None
    stopped: tuple[int, Failure, str] | None = None
    extremes: dict[str, Any] = field(default_factory=dict)

    def add(self, step: int, contacts: int, normal_force: float, angle_error: float) -> None:
        """Append one sample."""
        self.step.append(step)
        self.contacts.append(contacts)
        self.normal_force.append(normal_force)
        self.angle_error.append(angle_error)


def judge(
    engine: str, rig: Rig, grid: Grid, track: Track, samples: Samples, limits: Limits, beam: FloatArray
) -> Health:
    """Health of a run, which may have stopped early.

    Of several failures the first applicable one is reported, causes before consequences: non-finite state, frozen
    state, end of the rails, sliding before contact was lost, extra contacts, leaving the groove, lost contact. Where
    the beam falls away faster than the ball does, all but the first three are called lifting off, at the instant at
    which the normal force of eq. 14 falls below zero.

    Args:
        engine: its name.
        rig, grid, track, samples, limits: of the run.
        beam: α, α̇, α̈ on the grid, shape (steps + 1, 3) [rad, s].

    Raises:
        EngineFailure: the run is invalid.
    """

    def fail(failure: Failure, n: int, what: str) -> EngineFailure:
        if failure in _AFTER_LIFT_OFF:
            seen = n + math.ceil(_NEARLY / grid.time_step)
            lifted = _lifted(rig, grid, track, beam, seen)
            if lifted is not None:
                return EngineFailure(engine, Failure.LIFTED_OFF, lifted, Failure.LIFTED_OFF.value)
        return EngineFailure(engine, failure, float(grid.time[n]), f"{what}; {failure.value}")

    # A sum is finite where all its terms are: they are metres and radians.
    bad = _first(~np.isfinite(track.along + track.across + track.height + track.rolled))
    if bad is not None:
        raise fail(Failure.NOT_FINITE, bad, "a state is NaN or infinite")
    (needed, most), height_error = limits.contacts, track.height - rig.rolling_radius
    slip = (np.diff(track.along) - rig.rolling_radius * np.diff(track.rolled)) / grid.time_step
    sideways, lifted, slipping = np.abs(track.across), np.abs(height_error), np.abs(slip)
    left = _first((sideways > limits.across) | (lifted > limits.height))
    off = _first(np.abs(track.along - limits.middle) > limits.along)
    slid = _first(slipping > limits.slip)
    # There is a sample every few steps: loops in Python over them took a third of the time in here.
    steps, counts, loads = np.asarray(samples.step), np.asarray(samples.contacts), np.asarray(samples.normal_force)
    loose = steps[(counts < needed) | (loads <= 0.0)]
    lost = int(loose[0]) if loose.size else None

    if samples.frozen is not None:
        raise fail(Failure.FROZEN, samples.frozen, "the ball did not move although it should have")
    if off is not None and (left is None or off <= left):
        raise fail(Failure.RAN_OFF, off, f"s = {track.along[off]:.2f} m is past the end of the rails")
    # A ball without contact always slips: slip counts only up to the last sample with contact.
    ends = [n for n in (left, lost) if n is not None]
    held = steps[steps < min(ends)] if ends else steps
    if slid is not None and (not ends or (held.size and slid <= held[-1])):
        raise fail(Failure.SLIPPED, slid, f"the contact slips at {abs(slip[slid]) * 1e3:.1f} mm/s")
    crowded = _first(counts > most)
    if crowded is not None and (lost is None or steps[crowded] < lost):
        extra = samples.step[crowded]
        raise fail(Failure.EXTRA_CONTACT, extra, f"{counts[crowded]} contacts at s = {track.along[extra]:.3f} m")
    if left is not None:
        where = f"the ball is {height_error[left] * 1e3:+.2f} mm off its height and {track.across[left] * 1e3:+.2f} mm"
        raise fail(Failure.LEFT_GROOVE, left, f"{where} off the middle at s = {track.along[left]:.3f} m")
    if lost is not None:
        at = samples.step.index(lost)
        seen = f"{samples.contacts[at]} contacts with {samples.normal_force[at]:.3g} N"
        raise fail(Failure.LOST_CONTACT, lost, f"{seen} at s = {track.along[lost]:.3f} m")
    if samples.stopped is not None:
        n, failure, what = samples.stopped
        raise fail(failure, n, what)
    health = Health(
        contacts_min=int(counts.min()),
        contacts_max=int(counts.max()),
        normal_force_min=float(loads.min()),
        height_error_max=float(lifted.max()),
        lateral_offset_max=float(sideways.max()),
        slip_max=float(slipping[1:].max()) if len(slip) > 1 else 0.0,
        angle_error_max=float(np.max(samples.angle_error)),
        steps=grid.steps,
        lifted_off=_lifted(rig, grid, track, beam, grid.steps),
    )
    return replace(health, **samples.extremes)


def _lifted(rig: Rig, grid: Grid, track: Track, beam: FloatArray, last: int) -> float | None:
    """First time at which the normal force of eq. 14 is negative on the engine's own path up to step `last` [s]."""
    count = min(last + 1, len(track.along))
    if count < 2:
        return None
    velocity = np.gradient(track.along[:count], grid.time_step)
    found = first_lift_off(track.along[:count], velocity, beam[:count], rig)
    return None if found is None else float(grid.time[found])


def finite_force(engine: str, force: BallForce, s: float, speed: float, angle: float, time: float) -> float:
    """F(s, ṡ, α, t) [N].

    Raises:
        EngineFailure: it is not finite (DART would silently ignore such a force).
    """
    push = force(s, speed, angle, time)
    if not math.isfinite(push):
        raise EngineFailure(engine, Failure.NOT_FINITE, time, f"the extra force is {push} N at s = {s:.3f} m")
    return push


def _first(condition: NDArray[np.bool_]) -> int | None:
    """Index of the first true element."""
    return int(np.argmax(condition)) if condition.any() else None
