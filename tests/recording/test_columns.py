"""Columns are found by name in any order and any known unit, and converted to SI."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from harness.recording import load_recording
from harness.recording.columns import QUANTITIES, QuantityName, find_columns
from tests.recording.simulated import contract_columns, csv_text

SI: dict[QuantityName, np.ndarray] = {
    "time": contract_columns()["time_s"],
    "angle": contract_columns()["beam_angle_rad"],
    "position": contract_columns()["ball_position_m"],
    "velocity": np.gradient(contract_columns()["ball_position_m"], 0.01),
}
SPELLINGS = (
    lambda name, unit: f"{name}_{unit}",
    lambda name, unit: f"{name} [{unit.replace('_', '/')}]",
    lambda name, unit: f"  {name.replace('_', ' ').title()} ({unit})",
    lambda name, unit: f"{name.upper()}_{unit.upper()}",
)


@st.composite
def headers(draw: st.DrawFn) -> list[tuple[QuantityName, str, float]]:
    """Quantities in any order, each with a header and the factor of its unit."""
    order = draw(st.permutations(list(QUANTITIES)))
    chosen = []
    for name in order:
        quantity = QUANTITIES[name]
        unit = draw(st.sampled_from(sorted(quantity.units)))
        word = draw(st.sampled_from((quantity.name, *quantity.others)))
        chosen.append((name, draw(st.sampled_from(SPELLINGS))(word, unit), quantity.units[unit]))
    return chosen


@pytest.mark.slow
@given(headers())
@settings(max_examples=30, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_any_order_unit_and_spelling(tmp_path: Path, chosen: list[tuple[QuantityName, str, float]]) -> None:
    """Give back SI values whatever the order, unit and spelling of the columns."""
    path = tmp_path / "rec.csv"
    path.write_text(csv_text({header: SI[name] / factor for name, header, factor in chosen}), encoding="utf-8")
    recording = load_recording(path)
    for name, values in SI.items():
        # One division and one multiplication, each rounded by at most half an ulp (1.1e-16).
        np.testing.assert_allclose(getattr(recording, name), values, rtol=3e-16, atol=0)


@pytest.mark.parametrize(
    ("header", "name", "factor"),
    [
        ("t", "time", 1.0),
        ("Timestamp", "time", 1.0),
        ("time_min", "time", 60.0),
        ("Time [µs]", "time", 1e-6),
        ("α", "angle", 1.0),
        ("alpha (°)", "angle", np.pi / 180),
        ("s", "position", 1.0),
        ("X_mm", "position", 1e-3),
        ("v [mm/s]", "velocity", 1e-3),
        ("s_dot", "velocity", 1.0),
    ],
)
def test_short_names(header: str, name: QuantityName, factor: float) -> None:
    """Accept common aliases of the column names."""
    sound = {"time": "time_s", "angle": "beam_angle_rad"}
    row = [header, *(column for quantity, column in sound.items() if quantity != name)]
    columns, _ = find_columns(Path("rec.csv"), row, 1)
    assert columns[name].index == 0
    assert columns[name].factor == pytest.approx(factor, rel=1e-15)


def test_contract_name_wins() -> None:
    """Prefer the standard column name to an alias, and note the unused column."""
    columns, findings = find_columns(Path("rec.csv"), ["time_s", "beam_angle_deg", "beam_angle_rad", "x"], 1)
    assert columns["angle"].index == 2
    assert any("not used: 'beam_angle_deg'" in finding.text for finding in findings)


def test_missing_unit_is_said() -> None:
    """Read a column without a unit as SI, and note it."""
    _, findings = find_columns(Path("rec.csv"), ["t", "alpha_rad", "s_m"], 1)
    assert [finding.where for finding in findings] == ["rec.csv, row 1, column 't'"]
    assert "time_s" in findings[0].text


def test_an_angle_without_a_unit_is_a_warning() -> None:
    """Warn where the unit of the angle is assumed, as degrees are as usual."""
    _, (finding,) = find_columns(Path("rec.csv"), ["time_s", "angle", "ball_position_m"], 1)
    assert (finding.severity, finding.code) == ("warning", "no-unit")
    assert "read as beam_angle_rad" in finding.text


def test_an_unknown_position_column_is_named() -> None:
    """Name the unused columns, one of which may hold the positions, and say how it is to be called."""
    _, (finding,) = find_columns(Path("rec.csv"), ["time_s", "beam_angle_rad", "Distance (cm)"], 1)
    assert "'Distance (cm)'" in finding.text
    assert "ball_position_m" in finding.text


def test_sound_header_has_no_findings() -> None:
    """Note nothing about the standard header."""
    _, findings = find_columns(Path("rec.csv"), ["time_s", "beam_angle_rad", "ball_position_m"], 1)
    assert findings == []
