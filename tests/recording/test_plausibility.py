"""Units, signs and columns gone wrong are noticed by physics; sound recordings are left in peace."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from analytic.motion import FloatArray
from analytic.rig import Rig
from harness.recording import KnownRig, Sensors
from harness.recording.plausibility import Signals, constant, implausible
from harness.recording.tilt_response import tilt_response
from tests.recording.simulated import Cosines, simulated

SLOW_AND_SMALL = Cosines((0.004, 0.003), (0.4, 0.9))
FAST = Cosines((0.01, 0.005), (11.0, 19.0))  # α̈ moves the ball more than gravity does


def signals(*args: object, **options: object) -> Signals:
    """The signals of a simulated recording."""
    time, angle, position = simulated(*args, **options)
    return Signals(time, angle, position, np.zeros(len(time), bool))


@pytest.mark.parametrize("seed", [0, *(pytest.param(seed, marks=pytest.mark.slow) for seed in (1, 2))])
@pytest.mark.parametrize(
    ("motion", "rig", "options"),
    [
        (Cosines(), Rig(), {}),
        (Cosines(), Rig(), {"noise": 0.005}),
        (Cosines(), Rig(), {"noise": 0.0}),
        (Cosines(), Rig(), {"step": 0.1, "duration": 30.0}),
        (Cosines(), Rig(), {"step": 0.002, "duration": 4.0}),
        (Cosines(), Rig(), {"duration": 1.5}),
        (SLOW_AND_SMALL, Rig(), {"duration": 20.0}),
        (Cosines(), Rig(level_angle=0.005), {"duration": 8.0}),
        (Cosines(), Rig(rolling_radius=0.006), {}),
        (FAST, Rig(), {}),
        (FAST, Rig(eccentricity=-0.2), {}),
    ],
    ids=("plain", "noisy", "clean", "10 Hz", "500 Hz", "short", "slow", "level", "deep groove", "fast", "hanging"),
)
def test_sound_recordings(motion: Cosines, rig: Rig, options: dict[str, float], seed: int) -> None:
    """Warn of nothing in a plausible recording, however the beam and the ball move."""
    assert implausible(signals(motion, rig, seed=seed, **options)) == []


def test_a_zero_that_is_not_level_is_told() -> None:
    """Tell the range of angles about an upright zero, and to subtract what is read at level; not another unit."""
    good = signals(Cosines(), Rig(), seed=3)
    (found,) = implausible(replace(good, angle=good.angle + np.pi / 2.0))
    assert found.code == "angle-unit"
    assert "zero is not where the beam is level" in found.text
    low, high = np.degrees([np.min(good.angle), np.max(good.angle)]) + 90.0
    assert f"from {low:.3g}° to {high:.3g}°" in found.text


@pytest.mark.parametrize(("gain", "told"), [(9.0, True), (1.0 / 3.0, False)])
def test_an_angle_before_a_linkage_is_asked_for_where_it_is_too_large(gain: float, told: bool) -> None:
    """Think of a servo's angle where the ball follows too little, not where it follows too much."""
    good = signals(Cosines(), Rig(), seed=3)
    text = " ".join(one.text for one in implausible(replace(good, angle=gain * good.angle)))
    assert ("--linkage" in text) is told


SLIPS = {
    "degrees": (lambda t, a, s: (t, np.degrees(a), s), "in degrees"),
    "millimetres": (lambda t, a, s: (t, a, 1e3 * s), "in millimetres"),
    "centimetres": (lambda t, a, s: (t, a, 1e2 * s), "in centimetres"),
    "both": (lambda t, a, s: (t, np.degrees(a), 1e3 * s), "degrees and the position in millimetres"),
    "inches": (lambda t, a, s: (t, a, s / 0.0254), "in inches"),
    "milliseconds": (lambda t, a, s: (1e3 * t, a, s), "in milliseconds"),
    "microseconds": (lambda t, a, s: (1e6 * t, a, s), "in microseconds"),
    "seconds": (lambda t, a, s: (1e-3 * t, a, s), "in seconds, not milliseconds"),
    "sign of angle": (lambda t, a, s: (t, -a, s), "reversed"),
    "sign of position": (lambda t, a, s: (t, a, 0.6 - s), "reversed"),
    "exchanged": (lambda t, a, s: (t, s, a), "exchanged"),
}


@pytest.mark.parametrize("name", SLIPS)
@pytest.mark.parametrize("options", [{}, {"noise": 0.002}, {"step": 0.05}], ids=("plain", "noisy", "20 Hz"))
def test_slips_are_named(name: str, options: dict[str, float]) -> None:
    """Name the one wrong unit or sign, and nothing else."""
    change, words = SLIPS[name]
    sound = signals(**options)
    time, angle, position = change(sound.time, sound.angle, sound.position)
    ((_, text),) = implausible(replace(sound, time=time, angle=angle, position=position))
    assert words in text


def test_degrees_and_sign_together() -> None:
    """Name both errors if the angle is in degrees and reversed."""
    sound = signals()
    found = implausible(replace(sound, angle=-np.degrees(sound.angle)))
    assert len(found) == 2
    assert "degrees" in found[0].text
    assert "reversed" in found[1].text


@pytest.mark.parametrize("turns", [lambda a: a % (2 * np.pi), lambda a: a + 2 * np.pi], ids=("wrapped", "a turn away"))
def test_a_wrapped_angle_is_told_apart_from_a_unit(turns: Callable[[FloatArray], FloatArray]) -> None:
    """Say that the angle is wrapped, and not to name its column as it is named."""
    sound = signals()
    ((code, text),) = implausible(replace(sound, angle=turns(sound.angle), units=["beam_angle_deg"]))
    assert code == "wrapped-angle"
    assert "wrapped at 360°" in text


def test_a_unit_that_a_column_has_is_not_advised() -> None:
    """Do not advise to name a column as it is named already."""
    sound = signals()
    for change, unit in (
        ({"angle": np.degrees(sound.angle)}, "beam_angle_deg"),
        ({"position": 1e3 * sound.position}, "ball_position_mm"),
    ):
        ((_, text),) = implausible(replace(sound, **change, units=[unit]))
        assert unit not in text


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"angle": 40.0}, "if it is in degrees"),
        ({"position": 1000.0}, "if it is in millimetres"),
        ({"time": 1000.0}, "milliseconds"),
    ],
    ids=("degrees", "millimetres", "milliseconds"),
)
def test_magnitudes_speak_where_the_ball_rests(change: dict[str, float], words: str) -> None:
    """Check plain magnitudes if the ball rests and the regression is inconclusive."""
    time, angle, _ = simulated()
    position = 0.3 + np.random.default_rng(8).normal(0, 3e-4, len(time))
    values = {"time": time, "angle": angle, "position": position}
    values |= {name: factor * values[name] for name, factor in change.items()}
    ((_, text),) = implausible(Signals(**values, outlier=np.zeros(len(time), bool)))
    assert words in text


def test_ball_off_the_beam() -> None:
    """Compare positions with the beam's length where it is known."""
    sound = signals(start=0.2)
    assert implausible(replace(sound, rig=KnownRig(length=0.7))) == []
    ((_, text),) = implausible(replace(sound, rig=KnownRig(length=0.4)))
    assert "do not fit on a beam of 0.4 m" in text


def test_constant_channels() -> None:
    """Warn about a channel that never changes."""
    sound = signals()
    still = np.zeros_like(sound.angle)
    assert [one.code for one in constant(still, sound.position)] == ["constant-angle"]
    assert [one.code for one in constant(sound.angle, still + 0.3)] == ["constant-position"]
    assert not list(constant(sound.angle, sound.position))


def test_declared_resolution() -> None:
    """Compare inferred with declared resolutions, finer or coarser, with a margin for a data sheet's rounding."""
    sound = signals()
    assert implausible(replace(sound, sensors=Sensors(angle_resolution=1.6e-4, position_resolution=1e-4))) == []
    assert "coarser" in implausible(replace(sound, sensors=Sensors(angle_resolution=1e-5)))[0].text
    assert "finer" in implausible(replace(sound, sensors=Sensors(position_resolution=1e-3)))[0].text


def test_interpolated_angles_have_no_resolution() -> None:
    """Compare the declared step with the angles that were read, and not with those between them."""
    sound = signals()
    filled = np.arange(len(sound.time)) % 3 == 1
    between = np.interp(sound.time, sound.time[~filled], sound.angle[~filled])
    declared = Sensors(angle_resolution=1.6e-4)
    assert implausible(replace(sound, angle=between, sensors=declared, filled=filled)) == []


def test_unknown_positions_silence_physics() -> None:
    """Without positions, check only the magnitude of the angle."""
    sound = signals()
    unknown = np.full_like(sound.position, np.nan)
    assert implausible(replace(sound, position=unknown)) == []


def test_slope_is_that_of_a_rolling_ball() -> None:
    """Find K = 1/(1 + J/(m r²)) in clean data although α̈ acts too, within what sin α ≈ α and s α̇² leave out."""
    _, angle, position = simulated(noise=0.0)
    response = tilt_response(0.01, angle, position)
    assert response is not None
    # sin α misses α by at most α²/6 = 4e-4 at 0.05 rad; s α̇² adds to g α up to 0.5 m · (0.1 rad/s)² / (9.81 · 0.05),
    # 1 %, though mostly at twice the beam's frequencies, where it does not correlate.
    assert response.slope == pytest.approx(Rig().rolling_ratio, rel=1e-2)
