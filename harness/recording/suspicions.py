"""What looks wrong in a recording that reads well: units, signs, swapped columns, places no ball can be.

Physics decides where it can (see `tilt_response`): the ball's acceleration follows the tilt with a known factor, so a
wrong unit is a wrong factor. Only where the ball tells too little do plain magnitudes speak. Each returns warnings.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analytic.motion import FloatArray
from harness.recording.resolution import inferred_resolution
from harness.recording.tilt_response import TiltResponse, tilt_response

PLAUSIBLE_SLOPE = (0.2, 1.5)  # K is 0.4 … 0.8; friction, gain errors and noise widen it, no unit slip is that small
EXCHANGED_SLOPE = (0.4, 0.8)  # nothing but a rolling ball itself
CLEAR_CORRELATION, CLEAR_EVIDENCE = 0.8, 6.0
LARGEST_ANGLE = 0.7  # 40°: beyond it balls leave their beams [rad]
LARGEST_POSITION = 5.0  # [m]
LARGEST_STEP = 1.0  # [s]
RESOLUTION_TOLERANCE = 1.3  # data sheets round their steps
FEWEST_LEVELS = 20  # fewer may by chance all be multiples of two steps

UNIT_SLIPS = (
    (math.pi / 180, "the angle seems to be in degrees, not radians; name its column beam_angle_deg"),
    (1e3, "the position seems to be in millimetres, not metres; name its column ball_position_mm"),
    (1e2, "the position seems to be in centimetres, not metres; name its column ball_position_cm"),
    (
        1e3 * math.pi / 180,
        "the angle seems to be in degrees and the position in millimetres; name the columns beam_angle_deg and "
        "ball_position_mm",
    ),
    (1e-3, "the position seems to be a thousand times too small, or the angle in milliradians; check their units"),
    (1e-6, "the time seems to be in milliseconds, not seconds; name its column time_ms"),
    (1e6, "the time seems to be in seconds, not milliseconds; name its column time_s"),
    (1e-12, "the time seems to be in microseconds, not seconds; name its column time_us"),
)


@dataclass(frozen=True)
class Suspect:
    """A recording as the suspicions see it: SI units as the headers claim, shape (n,) each.

    Attributes:
        time: strictly increasing [s].
        angle: α, free of NaN [rad].
        position: s, NaN where not known [m].
        outlier: positions that are spikes.
        gravity: g [m/s²].
        length: of the beam, if known [m].
        angle_resolution: declared, if known [rad].
        position_resolution: declared, if known [m].
    """

    time: FloatArray
    angle: FloatArray
    position: FloatArray
    outlier: NDArray[np.bool_]
    gravity: float = 9.81
    length: float | None = None
    angle_resolution: float | None = None
    position_resolution: float | None = None


def suspicions(suspect: Suspect) -> list[str]:
    """Everything that looks wrong, one text each: what is seen and what to do. Empty for a sound recording."""
    physics = list(_against_physics(suspect))
    plain = [] if physics else list(_implausible_magnitudes(suspect))
    outside = [] if physics or plain else list(_off_the_beam(suspect))
    return [*physics, *plain, *outside, *_constant(suspect), *_quantisation(suspect)]


def _against_physics(suspect: Suspect) -> Iterator[str]:
    run = _longest_known_run(suspect)
    if run is None:
        return
    step, angle, position = run
    response = tilt_response(step, angle, position, gravity=suspect.gravity)
    if response is None:
        return
    if _is_clear(response) and _plausible(response.slope):
        return
    # Half a swing may fit either way; only a ball's travel in metres exceeds its beam's swing in radians.
    if np.max(np.abs(angle)) > np.max(np.abs(position)):
        exchanged = tilt_response(step, position, angle, gravity=suspect.gravity)
        if (
            exchanged is not None
            and exchanged.evidence > response.evidence
            and _is_clear(exchanged)
            and EXCHANGED_SLOPE[0] <= exchanged.slope <= EXCHANGED_SLOPE[1]
        ):
            yield (
                "the angle and the position seem to be exchanged: the column named as angle accelerates as the "
                f"one named as position would make it (correlation {exchanged.correlation:.2f}); swap the column names."
            )
            return
    if not _is_clear(response):
        return
    size = abs(response.slope)
    said = f"the ball's acceleration is {response.slope:.3g} g α, where a rolling ball has 0.4 to 0.8 g α"
    if not _plausible(size):
        slip = next((text for factor, text in UNIT_SLIPS if _plausible(size / factor)), None)
        yield f"{said}: {slip or 'check the units of all columns and the gain of the sensors'}."
    if response.slope < 0:
        yield (
            f"{said}: the sign of the angle or of the position is reversed. A positive angle must lower the +s end; "
            "negate one of the two columns."
        )


def _is_clear(response: TiltResponse) -> bool:
    return abs(response.correlation) >= CLEAR_CORRELATION and response.evidence >= CLEAR_EVIDENCE


def _plausible(slope: float) -> bool:
    return PLAUSIBLE_SLOPE[0] <= slope <= PLAUSIBLE_SLOPE[1]


def _longest_known_run(suspect: Suspect) -> tuple[float, FloatArray, FloatArray] | None:
    """Step, angle and position on an even grid, over the longest stretch without a gap in time or position."""
    known = np.flatnonzero(np.isfinite(suspect.position) & ~suspect.outlier)
    if len(known) < 2:
        return None
    step = float(np.median(np.diff(suspect.time)))
    breaks = np.flatnonzero(np.diff(suspect.time[known]) > 5 * step) + 1
    part = max(np.split(known, breaks), key=len)
    grid = np.arange(suspect.time[part[0]], suspect.time[part[-1]] + 0.5 * step, step)
    angle = np.interp(grid, suspect.time, suspect.angle)
    return step, angle, np.interp(grid, suspect.time[part], suspect.position[part])


def _implausible_magnitudes(suspect: Suspect) -> Iterator[str]:
    step = float(np.median(np.diff(suspect.time)))
    if step > LARGEST_STEP:
        yield (
            f"samples are {step:.3g} s apart: if these are milliseconds or microseconds, name the column time_ms or "
            "time_us."
        )
    angle = float(np.max(np.abs(suspect.angle)))
    if angle > LARGEST_ANGLE:
        yield (
            f"the angle reaches {angle:.3g} rad ({math.degrees(angle):.0f}°): if it is in degrees, name its column "
            "beam_angle_deg."
        )
    sound = _sound_positions(suspect)
    if len(sound) and np.max(np.abs(sound)) > LARGEST_POSITION:
        yield (
            f"the position reaches {np.max(np.abs(sound)):.3g} m: if it is in millimetres or centimetres, "
            "name its column ball_position_mm or ball_position_cm."
        )


def _off_the_beam(suspect: Suspect) -> Iterator[str]:
    sound = _sound_positions(suspect)
    if suspect.length is None or not len(sound):
        return
    if np.ptp(sound) > suspect.length or np.max(np.abs(sound)) > suspect.length:
        yield (
            f"the ball's positions, {np.min(sound):.3g} to {np.max(sound):.3g} m, do not fit on a beam of "
            f"{suspect.length:.3g} m; check length_m and the position's unit and origin."
        )


def _sound_positions(suspect: Suspect) -> FloatArray:
    return suspect.position[np.isfinite(suspect.position) & ~suspect.outlier]


def _constant(suspect: Suspect) -> Iterator[str]:
    if np.ptp(suspect.angle) == 0.0:
        yield "the angle never changes; check that its sensor was connected."
    sound = _sound_positions(suspect)
    if len(sound) > 1 and np.ptp(sound) == 0.0:
        yield "the position never changes; check that its sensor was connected."


def _quantisation(suspect: Suspect) -> Iterator[str]:
    for name, unit, values, declared in (
        ("angle", "rad", suspect.angle, suspect.angle_resolution),
        ("position", "m", suspect.position, suspect.position_resolution),
    ):
        if declared is None or len(np.unique(values[np.isfinite(values)])) < FEWEST_LEVELS:
            continue
        seen = inferred_resolution(values)
        if seen is None:
            continue
        if seen > declared * RESOLUTION_TOLERANCE:
            yield (
                f"the {name} changes in steps of {seen:.4g} {unit}, coarser than the declared {declared:.4g} {unit}; "
                f"correct {name}_resolution_{unit} or record with more digits."
            )
        elif seen < declared / RESOLUTION_TOLERANCE:
            yield (
                f"the {name} changes in steps of {seen:.4g} {unit}, finer than the declared {declared:.4g} {unit}; "
                f"correct {name}_resolution_{unit}."
            )
