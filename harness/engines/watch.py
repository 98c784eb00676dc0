"""Judges what an engine did: every step's path, and contacts sampled on the way. A bad run raises, never passes on."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from analytic.motion import BallForce
from analytic.rig import Rig
from harness.engines.health import Failure, Health
from harness.engines.leapfrog import Grid, Track
from harness.errors import EngineFailure, InputError

FLATTEST_GROOVE = 0.01  # w/2 over R; at a seventh of it Bullet lets the ball roll out sideways
STANDSTILL = 1e-9  # [rad] a step, [m/s]: more than this moves a position by what a double resolves


@dataclass(frozen=True)
class Limits:
    """Beyond these a run is not the rig's any more.

    Attributes:
        across: |y| [m].
        height: |height of the ball's centre − r| [m].
        along: |s| [m].
        slip: |ṡ − r (φ̇ − α̇)| [m/s].
    """

    across: float
    height: float
    along: float
    slip: float

    def broken(self, along: float, across: float, height_error: float) -> bool:
        """Whether a ball at s, y and this height error [m] is out of bounds, or not anywhere (nan)."""
        return not (
            abs(along) <= self.along and abs(across) <= self.across and abs(height_error) <= self.height
        )  # fmt: skip


def limits_of(rig: Rig, *, reach: float, slip: float) -> Limits:
    """The limits for `rig` on rails from −reach to +reach [m].

    Raises:
        InputError: the groove is too flat to hold a ball in an engine.
    """
    if rig.half_gap < FLATTEST_GROOVE * rig.radius:
        raise InputError(
            f"rolling_radius {rig.rolling_radius:g} m leaves no groove for a ball of radius {rig.radius:g} m; the "
            f"engines need at most {rig.radius * (1 - 0.5 * FLATTEST_GROOVE**2):.9g} m"
        )
    return Limits(
        # The barrier's top is at |y| = w/2. In a sound run |y| stays below 0.1 µm; half way up, the ball is leaving.
        across=0.5 * rig.half_gap,
        # A sound run keeps 0.2 µm at dt = 1 ms. A tenth of r is a rolling radius, hence a slope of s over φ, that is
        # 10 % off; a ball that fell reaches it after √(0.2 r/g) = 15 ms.
        height=0.1 * rig.rolling_radius,
        along=reach - rig.radius,
        slip=slip,
    )


@dataclass
class Samples:
    """Contacts and drive as seen at some steps, filled in by the engine while it runs.

    Attributes:
        step: index n of each sample.
        contacts: number of contacts ball–beam that carry a force.
        normal_force: sum of their normal forces' components normal to the edge plane [N].
        angle_error: |beam angle in the engine − α| [rad].
        frozen: step at which the engine was seen to repeat a state, if any.
    """

    step: list[int] = field(default_factory=list)
    contacts: list[int] = field(default_factory=list)
    normal_force: list[float] = field(default_factory=list)
    angle_error: list[float] = field(default_factory=list)
    frozen: int | None = None

    def add(self, step: int, contacts: int, normal_force: float, angle_error: float) -> None:
        """Append one sample."""
        self.step.append(step)
        self.contacts.append(contacts)
        self.normal_force.append(normal_force)
        self.angle_error.append(angle_error)


def judge(engine: str, rig: Rig, grid: Grid, track: Track, samples: Samples, limits: Limits) -> Health:
    """Health of a run, which may have stopped early.

    Of several failures the cause is named: a state that is not finite, a frozen one, the end of the rails, a slide
    that began before the ball lost its hold, contacts at wrong places, leaving the groove, a lost contact.

    Raises:
        EngineFailure: the run cannot be trusted.
    """
    _require_finite(engine, grid, track)
    height_error = track.height - rig.rolling_radius
    slip = (np.diff(track.along) - rig.rolling_radius * np.diff(track.rolled)) / grid.time_step
    left = _first((np.abs(track.across) > limits.across) | (np.abs(height_error) > limits.height))
    off = _first(np.abs(track.along) > limits.along)
    slid = _first(np.abs(slip) > limits.slip)
    loose = [n for n, count, force in zip(samples.step, samples.contacts, samples.normal_force, strict=True)
             if count < 2 or force <= 0.0]  # fmt: skip
    lost = loose[0] if loose else None
    # A ball without contact slips by definition: only a slide up to the last sound sample is one.
    held = [n for n in samples.step if (left is None or n < left) and (lost is None or n < lost)]

    def fail(failure: Failure, n: int, what: str) -> EngineFailure:
        return EngineFailure(engine, failure, float(grid.time[n]), f"{what}; {failure.value}")

    if samples.frozen is not None:
        raise fail(Failure.FROZEN, samples.frozen, "the ball stood still in space while it should have moved")
    if off is not None and (left is None or off <= left):
        raise fail(Failure.RAN_OFF, off, f"s = {track.along[off]:.2f} m is past the end of the rails")
    if slid is not None and ((left is None and lost is None) or (held and slid <= held[-1])):
        raise fail(Failure.SLIPPED, slid, f"the contact slips at {abs(slip[slid]) * 1e3:.1f} mm/s")
    extra = next((n for n, count in zip(samples.step, samples.contacts, strict=True) if count > 2), None)
    if extra is not None and (lost is None or extra < lost):
        count = samples.contacts[samples.step.index(extra)]
        raise fail(Failure.EXTRA_CONTACT, extra, f"{count} contacts at s = {track.along[extra]:.3f} m")
    if left is not None:
        where = f"the ball is {height_error[left] * 1e3:+.2f} mm off its height and {track.across[left] * 1e3:+.2f} mm"
        raise fail(Failure.LEFT_GROOVE, left, f"{where} off the middle at s = {track.along[left]:.3f} m")
    if lost is not None:
        at = samples.step.index(lost)
        seen = f"{samples.contacts[at]} contacts with {samples.normal_force[at]:.3g} N"
        raise fail(Failure.LOST_CONTACT, lost, f"{seen} at s = {track.along[lost]:.3f} m")
    return Health(
        contacts_min=min(samples.contacts),
        contacts_max=max(samples.contacts),
        normal_force_min=min(samples.normal_force),
        height_error_max=float(np.abs(height_error).max()),
        lateral_offset_max=float(np.abs(track.across).max()),
        slip_max=float(np.abs(slip[1:]).max()) if len(slip) > 1 else 0.0,
        angle_error_max=max(samples.angle_error),
        steps=grid.steps,
    )


def finite_force(engine: str, force: BallForce, s: float, speed: float, angle: float, time: float) -> float:
    """F(s, ṡ, α, t) [N].

    Raises:
        EngineFailure: it is not finite. (DART would ignore such a force without a word.)
    """
    push = force(s, speed, angle, time)
    if not math.isfinite(push):
        raise EngineFailure(engine, Failure.NOT_FINITE, time, f"the extra force is {push} N at s = {s:.3f} m")
    return push


def _require_finite(engine: str, grid: Grid, track: Track) -> None:
    good = np.isfinite(track.along) & np.isfinite(track.across) & np.isfinite(track.height) & np.isfinite(track.rolled)
    bad = _first(~good)
    if bad is not None:
        failure = Failure.NOT_FINITE
        raise EngineFailure(engine, failure, float(grid.time[bad]), f"a state is nan or infinite; {failure.value}")


def _first(condition: NDArray[np.bool_]) -> int | None:
    """Index of the first true element."""
    return int(np.argmax(condition)) if condition.any() else None
