"""Plausibility checks of a valid recording: units, signs, exchanged columns, positions off the beam.

The main check uses physics (see `tilt_response`): the ball's acceleration is proportional to the tilt with a known
factor, so a wrong unit shows as a wrong factor. Plain magnitudes are checked only if this regression is inconclusive.
"""

import math
import re
from collections.abc import Collection, Iterator
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from analytic.motion import FloatArray
from harness.recording.known_rig import KnownRig, Sensors
from harness.recording.noise import contradicts
from harness.recording.rate import rate_error
from harness.recording.resolution import inferred_resolution
from harness.recording.tilt_response import TiltResponse, tilt_response

PLAUSIBLE_SLOPE = (0.2, 1.5)  # K is 0.4 … 0.8; margin for friction, gain errors and noise, below any unit factor
USUAL_SLOPE = 0.6
EXCHANGED_SLOPE = (0.4, 0.8)  # K of a rolling ball, without margin
MIN_CORRELATION, MIN_T_VALUE = 0.8, 6.0  # of a conclusive regression
STANDARD_GRAVITY = 9.81  # if the rig's is unknown [m/s²]
MAX_ANGLE = 0.7  # 40°: beyond it balls leave their beams [rad]
UPRIGHT = math.pi / 2  # no beam holds a ball beyond [rad]
MAX_POSITION = 5.0  # [m]
MAX_STEP = 1.0  # [s]
RESOLUTION_TOLERANCE = 1.3  # data sheets round resolutions
MIN_LEVELS = 20  # fewer levels may be multiples of two steps by chance

UNIT_ERRORS = (
    (math.pi / 180, "angle-unit", "the angle seems to be in degrees, not radians; name its column beam_angle_deg"),
    (1e3, "position-unit", "the position seems to be in millimetres, not metres; name its column ball_position_mm"),
    (1e2, "position-unit", "the position seems to be in centimetres, not metres; name its column ball_position_cm"),
    (
        1.0 / 0.0254,
        "position-unit",
        "the position seems to be in inches, not metres; multiply it by 0.0254, there is no column in inches",
    ),
    (
        1e3 * math.pi / 180,
        "units",
        "the angle seems to be in degrees and the position in millimetres; name the columns beam_angle_deg and "
        "ball_position_mm",
    ),
    (1e-3, "units", "the position seems to be a thousand times too small, or the angle in milliradians; check them"),
    (1e-6, "time-unit", "the time seems to be in milliseconds, not seconds; name its column time_ms"),
    (1e6, "time-unit", "the time seems to be in seconds, not milliseconds; name its column time_s"),
    (1e-12, "time-unit", "the time seems to be in microseconds, not seconds; name its column time_us"),
)


class Implausible(NamedTuple):
    """What is implausible: a code as of `DataFinding`, and observation and remedy in words."""

    code: str
    text: str


@dataclass(frozen=True)
class Signals:
    """The signals that are checked, in SI units according to the column names; arrays of shape (n,).

    Attributes:
        time: strictly increasing [s].
        angle: α, free of NaN [rad].
        position: s, NaN if unknown [m].
        outlier: true where the position is a spike.
        rig: what is known of it.
        units: columns as they are named in advice, such as `beam_angle_deg`, which the recording has.
        sensors: what is declared of them.
        filled: true where the angle was blank and is interpolated; empty if nowhere.
    """

    time: FloatArray
    angle: FloatArray
    position: FloatArray
    outlier: NDArray[np.bool_]
    rig: KnownRig = field(default_factory=KnownRig)
    units: Collection[str] = ()
    sensors: Sensors = field(default_factory=Sensors)
    filled: NDArray[np.bool_] = field(default_factory=lambda: np.zeros(0, dtype=np.bool_))

    @property
    def gravity(self) -> float:
        """g [m/s²]."""
        return self.rig.gravity or STANDARD_GRAVITY

    @property
    def positions(self) -> FloatArray:
        """Known positions that are no spikes [m]."""
        return self.position[np.isfinite(self.position) & ~self.outlier]


def implausible(signals: Signals) -> list[Implausible]:
    """Warnings, each with observation and remedy; empty for a plausible recording."""
    wrapped = list(_wrapped(signals))
    if wrapped:
        return wrapped
    physics = list(_against_physics(signals))
    plain = [] if physics else list(_implausible_magnitudes(signals))
    outside = [] if physics or plain else list(_off_the_beam(signals))
    return [*physics, *plain, *outside, *_quantisation(signals), *_noise(signals)]


def _against_physics(signals: Signals) -> Iterator[Implausible]:
    run = longest_known_run(signals)
    if run is None:
        return
    step, angle, position = run
    response = tilt_response(step, angle, position, gravity=signals.gravity)
    if response is None:
        return
    if is_conclusive(response) and plausible_slope(response.slope):
        if rate_error(response, signals.rig) is not None:
            late = tilt_response(step, angle, position, gravity=signals.gravity, delayed=True)
            factor = rate_error(late, signals.rig) if late else None
            if late and factor is not None:
                yield Implausible("rate", _rate_text(late.slope, factor))
        return
    # A short swing may fit either assignment; a ball's travel in metres exceeds the beam's swing in radians.
    if np.max(np.abs(angle)) > np.max(np.abs(position)):
        exchanged = tilt_response(step, position, angle, gravity=signals.gravity)
        if (
            exchanged is not None
            and exchanged.t_value > response.t_value
            and is_conclusive(exchanged)
            and EXCHANGED_SLOPE[0] <= exchanged.slope <= EXCHANGED_SLOPE[1]
        ):
            yield Implausible(
                "swapped-columns",
                "the angle and the position seem to be exchanged: the acceleration of the angle column follows "
                f"the position column as a ball follows the tilt (correlation {exchanged.correlation:.2f}); "
                "swap the column names.",
            )
            return
    if not is_conclusive(response):
        return
    size = abs(response.slope)
    observed = f"the ball's acceleration is {response.slope:.3g} g α, where a rolling ball has 0.4 to 0.8 g α"
    if not plausible_slope(size):
        unknown = "check the units of all columns and the gain of the sensors"
        if size < PLAUSIBLE_SLOPE[0]:
            unknown += ", and that the angle is the beam's: a servo's, before a linkage, is larger (harness import "
            unknown += "--linkage)"
        code, cause = _unit_error(size, signals.units) or ("units", unknown)
        yield Implausible(code, f"{observed}: {cause}.")
    if response.slope < 0:
        yield Implausible(
            "angle-sign",
            f"{observed}: the sign of the angle or of the position is reversed. A positive angle must lower the "
            "+s end; negate one of the two columns.",
        )


def _rate_text(slope: float, factor: float) -> str:
    length = f"{factor:.2f} times too long" if factor > 1.0 else f"{1.0 / factor:.2f} times too short"
    return (
        f"the ball's acceleration is {slope:.3g} g α, {1.0 / factor**2:.2f} times that of this rig: the recorded times "
        f"seem {length}; check the sampling rate. A sensor whose gain is wrong by as much would look the same."
    )


def _unit_error(size: float, units: Collection[str]) -> tuple[str, str] | None:
    """Code and words of the unit that explains a slope best; a unit that a column has already explains nothing."""
    possible = [
        (abs(math.log(size / factor / USUAL_SLOPE)), code, text)
        for factor, code, text in UNIT_ERRORS
        if plausible_slope(size / factor) and not any(re.search(rf"\b{unit}\b", text) for unit in units)
    ]
    return min(possible)[1:] if possible else None


def _wrapped(signals: Signals) -> Iterator[Implausible]:
    """An angle that jumps by a turn, or lies a turn away from a beam's."""
    turn = 2.0 * math.pi
    across = np.abs(np.abs(np.diff(signals.angle)) - turn) < MAX_ANGLE
    away = np.all(np.abs(np.abs(signals.angle) - turn) < MAX_ANGLE)
    if across.any() or away:
        yield Implausible(
            "wrapped-angle",
            f"the angle {'jumps by' if across.any() else 'lies'} a whole turn{'' if across.any() else ' away'}: it is "
            "wrapped at 360° (2π); subtract a turn from the values above half a turn.",
        )


def is_conclusive(response: TiltResponse) -> bool:
    """Whether the acceleration follows the tilt clearly enough for any conclusion."""
    return abs(response.correlation) >= MIN_CORRELATION and response.t_value >= MIN_T_VALUE


def plausible_slope(slope: float) -> bool:
    """Whether a ball may have this acceleration over g α [1]."""
    return PLAUSIBLE_SLOPE[0] <= slope <= PLAUSIBLE_SLOPE[1]


def longest_known_run(signals: Signals) -> tuple[float, FloatArray, FloatArray] | None:
    """Step, angle and position on an even grid over the longest interval without a gap in time or position."""
    known = np.flatnonzero(np.isfinite(signals.position) & ~signals.outlier)
    if len(known) < 2:
        return None
    step = float(np.median(np.diff(signals.time)))
    between = np.diff(signals.time[known])  # positions may come more slowly than angles
    breaks = np.flatnonzero(between > 5 * float(np.median(between))) + 1
    part = max(np.split(known, breaks), key=len)
    grid = np.arange(signals.time[part[0]], signals.time[part[-1]] + 0.5 * step, step)
    angle = np.interp(grid, signals.time, signals.angle)
    return step, angle, np.interp(grid, signals.time[part], signals.position[part])


def _implausible_magnitudes(signals: Signals) -> Iterator[Implausible]:
    step = float(np.median(np.diff(signals.time)))
    if step > MAX_STEP:
        yield Implausible(
            "time-unit",
            f"samples are {step:.3g} s apart: if these are milliseconds or microseconds, name the column time_ms or "
            "time_us.",
        )
    angle = float(np.max(np.abs(signals.angle)))
    if angle > MAX_ANGLE:
        named = "beam_angle_deg" in signals.units
        advice = "check the sensor's scale and zero" if named else "if it is in degrees, name its column beam_angle_deg"
        text = f"the angle reaches {angle:.3g} rad ({math.degrees(angle):.0f}°): {advice}."
        low, high = math.degrees(np.min(signals.angle)), math.degrees(np.max(signals.angle))
        if math.radians(high - low) < MAX_ANGLE and abs(low + high) > high - low:
            text = (
                f"all angles lie from {low:.3g}° to {high:.3g}°: the sensor's zero is not where the beam is level; "
                "subtract the angle that it reads there."
            )
        yield Implausible("angle-unit" if angle > UPRIGHT else "large-angle", text)
    positions = signals.positions
    if len(positions) and np.max(np.abs(positions)) > MAX_POSITION:
        yield Implausible(
            "position-unit",
            f"the position reaches {np.max(np.abs(positions)):.3g} m: if it is in millimetres or centimetres, "
            "name its column ball_position_mm or ball_position_cm.",
        )


def _off_the_beam(signals: Signals) -> Iterator[Implausible]:
    positions, length = signals.positions, signals.rig.length
    if length is None or not len(positions):
        return
    if np.ptp(positions) > length or np.max(np.abs(positions)) > length:
        yield Implausible(
            "off-beam",
            f"the ball's positions, {np.min(positions):.3g} to {np.max(positions):.3g} m, do not fit on a beam of "
            f"{length:.3g} m; check length_m and the position's unit and origin.",
        )


def constant(angle: FloatArray, positions: FloatArray) -> Iterator[Implausible]:
    """Warnings of a channel that never changes in a file.

    Args:
        angle: α, shape (n,) [rad].
        positions: known ones that are no spikes, shape (m,) [m].
    """
    if np.ptp(angle) == 0.0:
        yield Implausible("constant-angle", "the angle never changes; check that its sensor was connected.")
    if len(positions) > 1 and np.ptp(positions) == 0.0:
        yield Implausible("constant-position", "the position never changes; check that its sensor was connected.")


def _quantisation(signals: Signals) -> Iterator[Implausible]:
    read = signals.angle[~signals.filled] if len(signals.filled) else signals.angle  # the others are no multiples
    for name, unit, values, declared in (
        ("angle", "rad", read, signals.sensors.angle_resolution),
        ("position", "m", signals.position, signals.sensors.position_resolution),
    ):
        if declared is None or len(np.unique(values[np.isfinite(values)])) < MIN_LEVELS:
            continue
        seen = inferred_resolution(values)
        if seen is None or 1.0 / RESOLUTION_TOLERANCE <= seen / declared <= RESOLUTION_TOLERANCE:
            continue
        relation, remedy = ("coarser", " or record with more digits") if seen > declared else ("finer", "")
        yield Implausible(
            f"{name}-resolution",
            f"the {name} changes in steps of {seen:.4g} {unit}, {relation} than the declared {declared:.4g} {unit}; "
            f"correct {name}_resolution_{unit}{remedy}.",
        )


def _noise(signals: Signals) -> Iterator[Implausible]:
    known = np.isfinite(signals.position) & ~signals.outlier
    sensors = signals.sensors
    for name, unit, at, values, declared, resolution in (
        ("angle", "rad", slice(None), signals.angle, sensors.angle_noise, sensors.angle_resolution),
        ("position", "m", known, signals.position, sensors.position_noise, sensors.position_resolution),
    ):
        if declared is None or declared == 0.0:
            continue
        step = resolution or inferred_resolution(values) or 0.0
        ratio = contradicts(signals.time[at], values[at], declared, step, moves=name == "angle")
        if ratio:
            how = f"{ratio:.2g} times larger" if ratio > 1.0 else f"{1.0 / ratio:.2g} times smaller"
            yield Implausible(
                f"{name}-noise",
                f"the noise of the {name} is {how} than declared, with rounding: {declared:.3g} {unit}; "
                f"correct {name}_noise_{unit}.",
            )
