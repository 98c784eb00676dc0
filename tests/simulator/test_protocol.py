"""Experiments are repeatable, closed through the sensors only, and written as a case's CSV."""

from __future__ import annotations

import io
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from analytic.motion import State
from harness.simulator import (
    Controller,
    Laser,
    Plant,
    Protocol,
    Record,
    Run,
    Sensors,
    Servo,
    perform,
    record,
    recording_text,
    simulate,
)
from tests.simulator.motions import Sines

PLANT = Plant(rolling_resistance=0.003)
PROTOCOL = Protocol(0.36, ((0.5, 0.45), (3.0, 0.3)), 6.0)


def performed(seed: int = 7, *, protocol: Protocol = PROTOCOL, sensors: Sensors | None = None) -> tuple[Run, Record]:
    """The experiment on a plant with rolling resistance."""
    return perform(protocol, PLANT, Servo(), Controller(), sensors or Sensors(), seed)


def test_controller_brings_the_ball_to_its_targets() -> None:
    """Reach each target to the width in which resistance holds the ball."""
    run, _ = performed()
    # no integral part: the ball may rest where the commanded tilt is within ±c, gain · error <= c
    held = PLANT.rolling_resistance / Controller().gain
    for end, target in ((3.0, 0.45), (6.0, 0.3)):
        # 2 mm: where the laser's noise, seen through the filter, nudges a ball that rests
        assert run.position[np.searchsorted(run.time, end) - 1] == pytest.approx(target, abs=held + 2e-3)


def test_same_seed_same_recording() -> None:
    """Repeat an experiment to the bit with its seed, and another one with another seed."""
    (run, first), (again, second), (_, other) = performed(7), performed(7), performed(8)
    np.testing.assert_array_equal(first.position, second.position)
    np.testing.assert_array_equal(run.position, again.position)
    assert np.any(first.position != other.position)


def test_closed_loop_records_what_an_open_loop_replay_records() -> None:
    """Write down the same readings whether the controller looked at them or not."""
    run, closed = performed(7)
    replayed = simulate(PLANT, run.beam_motion, State(0.36, 0.0), 6.0)
    opened = record(replayed, Sensors(), 7)
    # the same steps and the same noise; the replayed α differs by its rounding only
    np.testing.assert_allclose(replayed.position, run.position, rtol=0.0, atol=1e-9)
    np.testing.assert_array_equal(opened.time, closed.time)
    np.testing.assert_array_equal(opened.angle, closed.angle)
    np.testing.assert_array_equal(opened.position, closed.position)


def test_controller_sees_only_the_laser() -> None:
    """Let the controller act on its last reading where the laser reads nothing, and record the gap."""
    blind_above = Sensors(laser=replace(Laser(), far=0.40))
    run, record = performed(sensors=blind_above)
    unread = np.isnan(record.position)
    np.testing.assert_array_equal(unread, run.position[::100] > 0.40)
    assert 0.05 < np.mean(unread) < 0.95
    assert np.all(np.isfinite(run.position))


def test_recording_ends_with_the_experiment() -> None:
    """Record from 0 to the end of the protocol, whether or not it is a whole number of sampling intervals."""
    run, record = performed(protocol=replace(PROTOCOL, duration=1.2345))
    assert run.time[-1] == pytest.approx(1.2345)
    assert record.time[-1] == pytest.approx(1.23)
    assert record.time.size == 124
    assert np.all(run.angle[-1] != 0.0)


def test_csv_reads_back_to_the_sensors_resolution() -> None:
    """Write times, counts and tenths of millimetres so that they read back, and a gap as a blank."""
    _, record = performed(sensors=Sensors(laser=replace(Laser(), far=0.40)))
    table = pd.read_csv(io.StringIO(recording_text(record)))
    assert list(table.columns) == ["time_s", "beam_angle_rad", "ball_position_m"]
    # half a unit of the last digit written
    np.testing.assert_allclose(table.time_s, record.time, atol=0.5e-4)
    np.testing.assert_allclose(table.beam_angle_rad, record.angle, atol=0.5e-7)
    np.testing.assert_allclose(table.ball_position_m, record.position, atol=1e-12)
    assert table.ball_position_m.isna().any()
    assert "-0.0000000" not in recording_text(record)


def test_sampling_has_to_fall_on_plant_steps() -> None:
    """Refuse a sampling rate that the plant's step does not divide."""
    with pytest.raises(ValueError, match="does not divide"):
        performed(sensors=Sensors(rate=300.0))
    with pytest.raises(ValueError, match="does not divide"):
        record(simulate(PLANT, Sines(), State(0.36, 0.0), 1.0), Sensors(rate=300.0), 1)
