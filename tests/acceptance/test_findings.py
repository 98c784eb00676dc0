"""What is wrong with the input is said wherever its result is read, and stops a diagnosis that it makes worthless."""

from __future__ import annotations

import csv
import json
from collections.abc import Callable
from pathlib import Path

import pytest

import harness as package
from harness.errors import WorthlessInput
from tests.acceptance.conftest import Harness
from tests.acceptance.short import write_short_case

Change = Callable[[dict[str, float]], dict[str, float]]


def _spoil(file: Path, change: Change) -> None:
    """Write a recording anew, each row changed."""
    with file.open(encoding="utf-8", newline="") as lines:
        rows = [change({name: float(value) for name, value in row.items()}) for row in csv.DictReader(lines)]
    with file.open("w", encoding="utf-8", newline="") as lines:
        writer = csv.DictWriter(lines, list(rows[0]))
        writer.writeheader()
        writer.writerows(rows)


def _negated(row: dict[str, float]) -> dict[str, float]:
    return row | {"beam_angle_rad": -row["beam_angle_rad"]}


STOPS: dict[str, Change] = {
    "angle-sign": _negated,
    "angle-unit": lambda row: row | {"beam_angle_rad": 57.29578 * row["beam_angle_rad"]},
    "position-unit": lambda row: row | {"ball_position_m": 1e3 * row["ball_position_m"]},
    "time-unit": lambda row: row | {"time_s": 1e3 * row["time_s"]},
    "swapped-columns": lambda row: (
        row | {"beam_angle_rad": row["ball_position_m"], "ball_position_m": row["beam_angle_rad"]}
    ),
}


@pytest.fixture
def case(tmp_path: Path) -> Path:
    """Two sound recordings."""
    return write_short_case(tmp_path / "case", duration=6.0)


@pytest.mark.parametrize("code", STOPS)
def test_worthless_input_stops_a_diagnosis(harness: Harness, case: Path, tmp_path: Path, code: str) -> None:
    """Exit with 1, name recording and finding, say what to do and how to insist, and write nothing."""
    name = sorted(case.glob("*.csv"))[0].name
    _spoil(case / name, STOPS[code])
    done = harness("diagnose", case, "--out", tmp_path / "out")
    assert done.code == 1
    assert f"{name}: " in done.err
    assert f"[{code}]" in done.err
    assert f"--accept {code}" in done.err
    assert not (tmp_path / "out").exists()


def test_a_further_recording_stops_too(harness: Harness, case: Path, tmp_path: Path) -> None:
    """Refuse errors on a further recording whose sign is reversed: they would say nothing of the model."""
    name = sorted(case.glob("*.csv"))[0].name
    (case / name).rename(tmp_path / "further.csv")
    (case / "rig.toml").write_text(
        (case / "rig.toml").read_text(encoding="utf-8").replace(f'"{name}", ', ""), encoding="utf-8"
    )
    _spoil(tmp_path / "further.csv", _negated)
    done = harness("diagnose", case, "--also", tmp_path / "further.csv", "--out", tmp_path / "out")
    assert done.code == 1
    assert "further.csv: " in done.err
    assert "[angle-sign]" in done.err


def test_a_code_that_does_not_exist_is_refused(harness: Harness, case: Path) -> None:
    """Exit with 2 and offer the codes that there are."""
    done = harness("diagnose", case, "--accept", "angle-sine")
    assert done.code == 2
    assert "Did you mean 'angle-sign'" in done.err


def test_python_gets_the_same_refusal(case: Path) -> None:
    """Raise from `harness.diagnose` as the command refuses."""
    _spoil(sorted(case.glob("*.csv"))[0], _negated)
    with pytest.raises(WorthlessInput, match="angle-sign") as raised:
        package.diagnose(case)
    assert raised.value.exit_code == 1


@pytest.mark.slow
def test_an_accepted_finding_stands_in_every_output(process: Harness, case: Path, tmp_path: Path) -> None:
    """Diagnose what was accepted, with the finding on the console, in diagnosis.json and at the report's top."""
    for file in case.glob("*.csv"):
        _spoil(file, _negated)
    done = process("diagnose", case, "--accept", "angle-sign", "--out", tmp_path / "out")
    assert done.code == 0, done.err
    assert "[angle-sign]" in done.out
    found = json.loads((tmp_path / "out" / "diagnosis.json").read_text(encoding="utf-8"))["findings"]
    assert {"severity", "where", "text", "code"} == set(found[0])
    assert sum(one["code"] == "angle-sign" for one in found) == 2
    page = (tmp_path / "out" / "diagnosis.html").read_text(encoding="utf-8")
    assert "sign of the angle" in page[: page.index('id="errors"')]
    assert "--accept angle-sign" in page
