"""Tables of rows made by hand: every count is known."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import pytest

from benchmarks.calibration.publish import publish
from benchmarks.calibration.rows import Outcome, Row
from benchmarks.calibration.statistics import ALL, rate
from benchmarks.calibration.tables import tables
from benchmarks.calibration.targets import targets
from benchmarks.calibration.trials import plan
from tests.benchmarks.made import SOURCE, committed, named, row, trial

DAMPED = [
    row(trial("confusion", "viscous_damping", 0), named("viscous_damping", 1.1)),
    row(trial("confusion", "viscous_damping", 1), named("viscous_damping", 1.6, reach=0.3)),
    row(trial("confusion", "viscous_damping", 2), named("quadratic_drag", rivals=["viscous_damping", "level_error"])),
    row(trial("confusion", "viscous_damping", 3), named("quadratic_drag", rivals=["level_error"])),
    row(trial("confusion", "viscous_damping", 4), named("viscous_damping", 0.8), named("level_error")),
    row(trial("confusion", "viscous_damping", 5)),
    row(trial("confusion", "viscous_damping", 6), spline_term="velocity"),
]
OUTCOMES = ["right", "right", "partner", "other", "more", "nothing", "unlisted"]
NULL = [
    *(row(trial("null", "none", number)) for number in range(9)),
    row(trial("null", "none", 9, plant="mujoco"), named("channel_delay")),
]
PAIR = "rolling_resistance + level_error"
PAIRED = [
    row(trial("confusion", PAIR, 0), named("rolling_resistance"), named("level_error", 2.0)),
    row(trial("confusion", PAIR, 1), named("rolling_resistance"), named("track_curvature", rivals=["level_error"])),
    row(trial("confusion", PAIR, 2), named("rolling_resistance")),
]


def test_outcomes() -> None:
    """Judge each result against the truth in one way only; a rival counts only if the result names what acts."""
    assert [str(one.outcome) for one in DAMPED] == OUTCOMES
    assert [one.outcome for one in NULL] == [Outcome.RIGHT] * 9 + [Outcome.OTHER]
    assert [one.outcome for one in PAIRED] == [Outcome.RIGHT, Outcome.PARTNER, Outcome.OTHER]


def test_a_structure_is_right_by_what_it_depends_on_most() -> None:
    """Count an unlisted effect as right only by a spline term with its main regressor."""
    bare = trial("confusion", "none", 0)
    gust = Row(trial=bare.__class__(**{**vars(bare), "unlisted": {"gust": {"force": 0.01}}}), source="", verdict="")
    outcomes = {
        regressor: Row(trial=gust.trial, source="", verdict="unlisted", depends_on=regressor).outcome
        for regressor in ("time", "position")
    }
    assert outcomes == {"time": Outcome.RIGHT, "position": Outcome.OTHER}
    assert gust.outcome is Outcome.NOTHING
    assert Row(trial=gust.trial, source="", verdict="effect", named=(named("level_error"),)).outcome is Outcome.OTHER


def test_confusion_and_recovery() -> None:
    """Put every trial into one cell of the confusion, and count a declared partner as told."""
    made = tables(DAMPED)
    (line,) = made["confusion_middle"].to_dict("records")
    counts = {key: value for key, value in line.items() if value and key != "acts"}
    assert line["acts"] == "viscous_damping"
    assert counts == {"viscous_damping": 2, "quadratic_drag": 2, "several": 1, "spline term": 1, "nothing": 1}
    recovery = made["recovery"].set_index(["effect", "size"])
    for effect in ("viscous_damping", ALL):
        one = recovery.loc[(effect, "middle")]
        assert one["cases"] == 7
        assert one["rate"] == pytest.approx(3 / 7)
    assert "confusion_small" not in made
    assert "null" not in made


def test_false_positives_by_plant() -> None:
    """Count false positives where they happen."""
    null = tables(NULL)["null"].set_index("plant")
    assert null["false"].to_dict() == {"mujoco": 1, "virtual_rig": 0, ALL: 1}
    assert null["cases"].to_dict() == {"mujoco": 1, "virtual_rig": 9, ALL: 10}
    assert tables(NULL)["null_named"].to_dict("list") == {"named": ["channel_delay"], "cases": [1]}


def test_coverage_of_all_in_which_the_truth_was_named() -> None:
    """Judge intervals wherever all that acts was named, also with something besides, and nowhere else."""
    coverage = tables([*DAMPED, *PAIRED])["coverage"].set_index("effect")
    # Errors 0.1, 0.6 and −0.2 within 0.5, 0.3 and 0.5.
    damping = coverage.loc["viscous_damping"]
    assert (damping["intervals"], damping["covered"]) == (3, 2)
    assert damping["z_rms"] == pytest.approx(1.96 * math.sqrt((0.2**2 + 2.0**2 + 0.4**2) / 3))
    # Of the pairs only the first has both: its resistance is hit, its level error 1.0 off within 0.5.
    assert (coverage.loc["level_error", "intervals"], coverage.loc["level_error", "covered"]) == (1, 0)
    assert (coverage.loc[ALL, "intervals"], coverage.loc[ALL, "covered"]) == (5, 3)


def test_lopsided_intervals() -> None:
    """Measure an error by the interval's side on which the truth lies."""
    one = row(trial("confusion", "viscous_damping", 0), named("viscous_damping"))
    (found,) = one.named
    lopsided = found.__class__(found.name, {"p": (0.8, 0.7, 1.2)}, ())
    (interval,) = Row(trial=one.trial, source="", verdict="effect", named=(lopsided,)).intervals()
    assert interval.covers
    assert interval.z == pytest.approx(-1.96 * 0.2 / 0.4)


def test_wilson() -> None:
    """Give Wilson's interval: of 0 in n it ends at z²/(n + z²), and of half it is symmetrical about it."""
    z2 = 1.959963984540054**2
    assert rate(0, 200) == pytest.approx({"rate": 0.0, "low": 0.0, "high": z2 / (200 + z2)})
    half = rate(50, 100)
    assert half["low"] + half["high"] == pytest.approx(1.0)
    assert half["high"] - half["low"] == pytest.approx(math.sqrt(z2 / (100 + z2)))
    assert math.isnan(rate(0, 0)["rate"])


def test_power_against_standard_errors() -> None:
    """Give the rate at four and six standard errors, the change of the parameter that acted, and what is wrong."""
    four, six = (
        [one for one in plan(["power"], seeds=2, only=["angle_gain"]) if one.errors == errors] for errors in (4.0, 6.0)
    )
    acted = [{"angle_gain": {"gain": value}} for value in (1.002, 0.996)]
    rows = [
        replace(row(four[0]), acted=acted[0]),
        replace(row(four[1], named("angle_gain")), acted=acted[1]),
        replace(row(six[0], named("position_gain", rivals=["angle_gain"])), acted=acted[0]),
        replace(row(six[1], named("level_error")), acted=acted[1]),
    ]
    power = tables(rows)["power"]
    of_one = power[power["effect"] == "angle_gain"].set_index("standard_errors")
    assert of_one["rate"].to_dict() == {4.0: 0.5, 6.0: 0.5}
    assert of_one["nothing"].to_dict() == {4.0: 1, 6.0: 0}
    assert of_one["wrong"].to_dict() == {4.0: 0, 6.0: 1}
    assert of_one["median_change"].to_dict() == {4.0: pytest.approx(0.003), 6.0: pytest.approx(0.003)}
    assert power[power["effect"] == "all"]["cases"].to_list() == [2, 2]
    assert "coverage" not in tables(rows)  # of what chance lets be seen


def test_failures_are_shown(tmp_path: Path) -> None:
    """Count a diagnosis that ended with an error as not recovered, and say so on the page."""
    failed = Row(trial=trial("confusion", "level_error", 0), source=SOURCE, verdict="", error="InputError: no")
    publish([failed, DAMPED[0]], tmp_path, SOURCE)
    recovery = committed(tmp_path)["recovery"].set_index(["effect", "size"])
    assert recovery.loc[("level_error", "middle"), ["failed", "rate"]].tolist() == [1, 0.0]
    assert "1 ended with an error" in (tmp_path / "calibration.md").read_text(encoding="utf-8")


def test_published_tables_come_back(tmp_path: Path) -> None:
    """Write tables, picture and page, the same each time; read them back, and drop those of former rows."""
    rows = [*DAMPED, *PAIRED, *NULL]
    first = {path: path.read_bytes() for path in publish(rows, tmp_path, SOURCE)}
    assert {path: path.read_bytes() for path in publish(rows, tmp_path, SOURCE)} == first
    page = (tmp_path / "calibration.md").read_text(encoding="utf-8")
    assert "| 1 `viscous_damping` | **2** | 2 |" in page
    # 1 of 10: Wilson's (0.1 + z²/20 ± z √(0.009 + z²/400)) / (1 + z²/10) is 1.8 % to 40.4 %
    assert "| all | all | 10 | 0 | 1 | 10 % (2–40) |" in page
    assert set(committed(tmp_path)) == set(tables(rows))
    publish(NULL, tmp_path, SOURCE)
    assert set(committed(tmp_path)) == {"null", "null_named"}
    assert not (tmp_path / "calibration" / "confusion.png").exists()


def test_a_target_needs_its_cases() -> None:
    """Leave a target unmet that too few trials reach, or none."""
    false, recovered, covered = targets(tables(NULL[:9]))
    assert (false.cases, false.measured[0], false.met) == (9, 0.0, False)
    assert (recovered.cases, recovered.met) == (0, False)
    assert not covered.met
    many = [row(trial("null", "none", number)) for number in range(200)]
    assert targets(tables(many))[0].met
    assert not targets(tables([*many, *(NULL[9:] * 11)]))[0].met  # 11 of 211 is 5.2 %
