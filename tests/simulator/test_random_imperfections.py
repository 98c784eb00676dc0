"""Rigs with drawn imperfections: only their record is spoilt, they say so, and they are the same with the same seed."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from harness.errors import InputError
from harness.recording import load_case
from harness.simulator import KINDS, Experiment, Imperfections, kinds_of, with_imperfections, write_case

SHORT = Experiment(seed=5, identify=1, predict=0, duration=6.0)


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_changes_the_record_and_loads(kind: str, tmp_path: Path) -> None:
    """Write a case that loads, is marked as simulated, tells its imperfections in the truth only."""
    experiment = with_imperfections(SHORT, [kind], seed=3)
    write_case(tmp_path / "case", experiment)
    case = load_case(tmp_path / "case")
    assert case.simulated
    told = json.loads((tmp_path / "case" / "truth.json").read_text(encoding="utf-8"))
    assert "spoilt on purpose" in told["origin"]
    assert told["imperfections"] == json.loads(json.dumps(experiment.imperfections.described()))
    assert told["sampling"]["rate"] == experiment.rate
    changed = told["imperfections"] != json.loads(json.dumps(Imperfections().described()))
    assert changed or told["sampling"]["rate"] != SHORT.rate
    rig = (tmp_path / "case" / "rig.toml").read_text(encoding="utf-8")
    assert not any(name in rig for name in (kind, *told["imperfections"]))


def test_the_ball_is_the_same_whatever_the_record() -> None:
    """Move ball and beam alike with any imperfection but a servo that lags."""
    ways = [
        one.carried_out(one.seeds[0])[0]
        for one in (with_imperfections(SHORT, [kind], seed=2) for kind in KINDS if kind != "commanded_angle")
    ]
    for way in ways[1:]:
        np.testing.assert_array_equal(way.position, ways[0].position)
        np.testing.assert_array_equal(way.angle, ways[0].angle)


def test_a_kind_is_drawn_alike_whichever_others_there_are() -> None:
    """Give a kind the same size alone and with all others; another size with another seed."""
    alone = with_imperfections(SHORT, ["sensor_lag"], seed=4).imperfections
    among = with_imperfections(SHORT, list(KINDS), seed=4).imperfections
    other = with_imperfections(SHORT, ["sensor_lag"], seed=5).imperfections
    assert alone.sensor_lag == among.sensor_lag != other.sensor_lag
    assert (alone.spiked, alone.drift, alone.servo_lag) == (0.0, 0.0, 0.0)


def test_kinds_are_drawn_where_none_is_asked_for() -> None:
    """Choose each kind about half of the time, at least one each time."""
    drawn = [kinds_of(seed) for seed in range(400)]
    assert min(map(len, drawn)) >= 1
    for kind in KINDS:
        # binomial of 400 at 1/2: ± four times 2.5 %
        assert sum(kind in one for one in drawn) / 400 == pytest.approx(0.5, abs=0.1)
    assert with_imperfections(SHORT, seed=1) == with_imperfections(SHORT, kinds_of(1), seed=1)


def test_sampling_is_from_10_to_500_a_second() -> None:
    """Draw every rate from 10 to 500 Hz, and record at it."""
    experiments = [with_imperfections(SHORT, ["sampling"], seed=seed) for seed in range(60)]
    assert {one.rate for one in experiments} == {10.0, 20.0, 50.0, 100.0, 200.0, 500.0}
    for rate in (10.0, 500.0):
        one = next(each for each in experiments if each.rate == rate)
        assert one.recordings()[0].record.time.size == 6 * rate + 1


def test_what_cannot_be_is_refused() -> None:
    """Name the kinds that there are; ask for a controller where a command is to be recorded."""
    with pytest.raises(InputError, match="Did you mean 'spikes'"):
        with_imperfections(SHORT, ["spike"], seed=1)
    with pytest.raises(InputError, match="close the loop"):
        Experiment(closed_loop=False, imperfections=Imperfections(servo_lag=0.1))
