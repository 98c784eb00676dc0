"""Trials with imperfect records: what is planned, what counts as right, and how it is counted."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from pathlib import Path

import pytest

from benchmarks.calibration.imperfect import IMPERFECTIONS, NAMED_BY, SEVERAL, kinds, names_for
from benchmarks.calibration.pose import experiment_of, pose
from benchmarks.calibration.publish import publish
from benchmarks.calibration.rows import Named, Outcome, Row
from benchmarks.calibration.statistics import ALL
from benchmarks.calibration.tables import tables
from benchmarks.calibration.trials import RIG, Trial, plan
from harness.simulator import KINDS
from tests.benchmarks.made import SOURCE, named, row, trial

PLAN = plan(["imperfect"])


def of(imperfection: str, name: str = "none", number: int = 0) -> Trial:
    """A handmade trial with this imperfection."""
    return replace(trial("imperfect", name, number), imperfection=imperfection)


def test_every_imperfection_is_tried_with_and_without_an_effect() -> None:
    """Try each kind, and several at once, on the virtual rig as often without a hidden effect as with one."""
    tried = Counter((one.imperfection, bool(one.hidden)) for one in PLAN)
    assert tried == {(kind, some): 5 for kind in (*KINDS, SEVERAL) for some in (True, False)}
    assert {one.plant for one in PLAN} == {RIG}
    assert not any(one.spikes or one.unlisted for one in PLAN)


def test_no_trial_is_of_another_family() -> None:
    """Share no seed with the trials on which constants were chosen, and spoil none of those."""
    others = plan(["null", "confusion", "power"])
    assert not {one.seed for one in PLAN} & {one.seed for one in others}
    assert not any(one.imperfection for one in others)
    assert not any(experiment_of(one).imperfections for one in others[::50])


def test_the_hidden_effect_is_not_the_imperfection() -> None:
    """Hide no effect that would say what the imperfection does."""
    for one in PLAN:
        assert not set(one.hidden) & names_for(one.imperfection)


def test_imperfections_are_drawn_from_the_seed(tmp_path: Path) -> None:
    """Pose a trial with the kinds that it names: the case on disk is a perfect one's but for them."""
    one = next(one for one in PLAN if one.imperfection == "spikes" and not one.hidden)
    experiment = experiment_of(one)
    assert experiment.imperfections is not None
    assert experiment.imperfections.spiked > 0.0
    assert experiment.imperfections.sensor_lag == experiment.imperfections.servo_lag == 0.0
    several = experiment_of(next(one for one in PLAN if one.imperfection == SEVERAL))
    assert several.imperfections is not None
    problem = pose(one, tmp_path / "case")
    assert len(problem.recordings) == one.recordings


LATE = named("channel_delay", 0.02)
EARLY = named("channel_delay", -0.02)


@pytest.mark.parametrize("imperfection", IMPERFECTIONS)
def test_naming_the_imperfection_is_no_false_positive(imperfection: str) -> None:
    """Take a delay for right where the record is late, of positive size only, and for false everywhere else."""
    one = of(imperfection)
    late = "channel_delay" in {name for kind in kinds(imperfection, one.seed) for name in NAMED_BY.get(kind, ())}
    assert late or imperfection not in ("sensor_lag", "commanded_angle", "dropouts")
    assert row(one, LATE).outcome is (Outcome.RIGHT if late else Outcome.OTHER)
    assert row(one, LATE).says_imperfection is late
    assert row(one, EARLY).outcome is Outcome.OTHER
    assert row(one).outcome is Outcome.RIGHT
    assert row(one, named("track_bump")).outcome is Outcome.OTHER
    assert row(one, LATE, named("track_bump")).outcome is Outcome.OTHER


def test_a_wandering_zero_may_be_said_in_three_ways() -> None:
    """Take a level, a drift of it, or a force that depends on time for a wandering zero, and nothing else."""
    one = of("zero_drift")
    assert row(one, named("level_error")).outcome is Outcome.RIGHT
    assert row(one, named("level_drift")).outcome is Outcome.RIGHT
    assert row(one, spline_term="time").outcome is Outcome.RIGHT
    assert row(one, spline_term="position").outcome is Outcome.UNLISTED
    assert row(of("worn_track"), spline_term="position").outcome is Outcome.UNLISTED
    assert row(of("spikes"), spline_term="time").outcome is Outcome.UNLISTED


def test_a_hidden_effect_has_to_be_named() -> None:
    """Count an effect as recovered with or without the imperfection, and as missed where that alone is named."""
    one = of("sensor_lag", "viscous_damping")
    assert row(one, named("viscous_damping")).outcome is Outcome.RIGHT
    assert row(one, named("viscous_damping"), LATE).outcome is Outcome.RIGHT
    assert row(one, LATE).outcome is Outcome.NOTHING
    assert row(one, named("viscous_damping"), named("level_error")).outcome is Outcome.MORE
    rival = named("quadratic_drag", rivals=["viscous_damping"])
    assert row(one, rival, LATE).outcome is Outcome.PARTNER


def undecided(one: Trial, *found: Named) -> Row:
    """A result that says that nothing can be said."""
    return replace(row(one, *found), verdict="not_identifiable")


ROWS = [
    row(of("sensor_lag", number=0)),
    row(of("sensor_lag", number=1), LATE),
    row(of("sensor_lag", number=2), named("level_error")),
    undecided(of("sensor_lag", number=3)),
    row(of("spikes", number=0), LATE),
    row(of("spikes", "viscous_damping", number=1), named("viscous_damping", 1.1), named("track_bump")),
    undecided(of("spikes", "viscous_damping", number=2)),
    row(of("spikes", "viscous_damping", number=3)),
]


def test_tables_by_imperfection() -> None:
    """Count undecided ones apart: rates are of the decided; say what was named falsely with which imperfection."""
    made = tables(ROWS)
    null = made["imperfect_null"].set_index("imperfection")
    assert null.loc["sensor_lag", ["cases", "undecided", "said", "false"]].tolist() == [4, 1, 1, 1]
    assert null.loc["sensor_lag", "rate"] == pytest.approx(1 / 3)
    assert null.loc[ALL, ["cases", "undecided", "false"]].tolist() == [5, 1, 2]
    recovery = made["imperfect_recovery"].set_index("imperfection")
    assert recovery.loc["spikes", ["cases", "undecided", "right", "more", "nothing"]].tolist() == [3, 1, 0, 1, 1]
    assert made["imperfect_named"].to_dict("split")["data"] == [
        ["sensor_lag", "level_error", 1],
        ["spikes", "channel_delay", 1],
        ["spikes", "track_bump", 1],
    ]
    coverage = made["imperfect_coverage"].set_index("imperfection")
    assert coverage.loc[ALL, ["intervals", "covered"]].tolist() == [1, 1]


def test_the_tables_of_perfect_records_leave_them_out(tmp_path: Path) -> None:
    """Add tables of their own, and change no count of the others; say on which trials constants were chosen."""
    others = [
        row(trial("confusion", "viscous_damping", 0), named("viscous_damping", 1.1)),
        row(trial("null", "none", 0)),
    ]
    alone, together = tables(others), tables([*others, *ROWS])
    assert {name for name in together if not name.startswith("imperfect")} == set(alone)
    for name, table in alone.items():
        assert together[name].equals(table), name
    publish([*others, *ROWS], tmp_path, SOURCE)
    page = (tmp_path / "calibration.md").read_text(encoding="utf-8")
    assert "## Imperfect records: false positives" in page
    assert "`pair_penalty`" in page
    assert "On imperfect records, of other seeds, only the blocks of correlated scores" in " ".join(page.split())
