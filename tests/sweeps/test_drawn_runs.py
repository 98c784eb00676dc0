"""Which runs of a sweep are drawn one by one, and over what."""

from __future__ import annotations

from pathlib import Path

import pandas as pd
import pytest

from harness.report.sweep import render_sweep
from harness.sweeps import Plan
from harness.sweeps.drawn_runs import MOST_RUNS, drawn_runs, logarithmic, numeric_factors
from harness.sweeps.results import results_of
from tests.sweeps.made import planned

SPEC = """sources = ["mujoco", "cam"]
time_step = [4e-3, 1e-4]
[mujoco]
friction = { low = 0.1, high = 1.0, scale = "log", levels = 600 }
cone = ["elliptic", "pyramidal"]
[rig]
level_angle_rad = [0.0, 0.001]
mass_kg = 0.07
"""
RANGES = (
    ("mass_kg", 0.05, 0.09), ("rolling_radius_m", 0.011, 0.012), ("inertia_kg_m2", 4e-6, 5e-6),
    ("eccentricity_m", 0.03, 0.04), ("gravity_m_s2", 9.7, 9.9), ("level_angle_rad", -0.004, 0.004),
)  # fmt: skip


@pytest.fixture(scope="module")
def plan(tmp_path_factory: pytest.TempPathFactory) -> Plan:
    """Of thousands of runs, which need not be carried out."""
    return planned(tmp_path_factory.mktemp("sweep"), SPEC)


@pytest.fixture(scope="module")
def rows(plan: Plan, tmp_path_factory: pytest.TempPathFactory):
    """Rows as if they had been: every seventh failed, run 1000 fits best of MuJoCo's."""
    file = tmp_path_factory.mktemp("rows") / "runs.parquet"
    table_of(plan).to_parquet(file)
    return file


def table_of(plan: Plan) -> pd.DataFrame:
    """Rows that no run was carried out for."""
    runs = [plan.run(number) for number in range(len(plan))]
    table = pd.DataFrame(
        {
            "run": [one.number for one in runs],
            "source": [one.source for one in runs],
            "point": [one.point for one in runs],
            "motion_s": 2.0,
            "cpu_s": [0.5 + one.number for one in runs],
            "failure": [None if one.number % 7 else "slipped" for one in runs],
            "message": [None if one.number % 7 else "it slipped" for one in runs],
            "error_measured_rms_m": [1e-3 if one.number == 1000 else 1.0 + one.number for one in runs],
            "error_cam_max_m": [1e-6 * one.number for one in runs],
            "time_step": [one.values.get("time_step") for one in runs],
        }
    )
    table.loc[table["failure"].notna(), ["error_measured_rms_m", "error_cam_max_m"]] = None
    return table


def test_an_even_choice_with_the_best_fits_is_drawn(plan: Plan, rows) -> None:
    """Draw few of very many runs, none that failed, the best one of each source among them, with their values."""
    runs, good = drawn_runs(plan, results_of(plan, rows), rows)
    assert good == sum(number % 7 > 0 for number in range(len(plan)))
    assert MOST_RUNS // 2 < len(runs) <= MOST_RUNS + 2
    assert [one.number for one in runs] == sorted({one.number for one in runs})
    assert all(one.number % 7 for one in runs)
    assert {one.number for one in runs if one.best and one.source == "mujoco"} == {1000}
    for one in runs:
        planned_run = plan.run(one.number)
        assert one.source == planned_run.source
        assert one.values == {key: planned_run.values[key] for key in one.values}
        assert "rig.mass_kg" not in one.values  # the same in all runs
        assert one.seconds == (0.5 + one.number) / 2.0
        assert one.error_cam == 1e-6 * one.number


def test_numbers_that_vary_are_axes(plan: Plan) -> None:
    """Take varied numbers, not words or what is the same in all runs; logarithmic where sampled so or over decades."""
    assert set(numeric_factors(plan)) == {"time_step", "mujoco.friction", "rig.level_angle_rad"}
    assert logarithmic(plan, "mujoco.friction")
    assert logarithmic(plan, "time_step")
    assert not logarithmic(plan, "rig.level_angle_rad")  # 0 is among them


@pytest.mark.slow
def test_a_page_of_many_factors_stays_below_5_mb(tmp_path: Path) -> None:
    """Draw 800 runs over eight quantities with long names into one page that can be sent by mail."""
    varied = "\n".join(f"{name} = {{ low = {low}, high = {high} }}" for name, low, high in RANGES)
    effects = "[effects.rolling_resistance]\ncoefficient = { low = 0.0, high = 0.002 }\n"
    effects += "[effects.contact_slip]\nfriction_coefficient = { low = 0.1, high = 0.2 }"
    spec = f'sources = ["cam", "mujoco"]\ndesign = "latin_hypercube"\nsize = 1000\n[rig]\n{varied}\n{effects}\n'
    plan = planned(tmp_path, spec)
    rows = tmp_path / "runs.parquet"
    table_of(plan).to_parquet(rows)
    page = render_sweep(plan, results_of(plan, rows), rows)
    assert page.count('class="chart-data"') >= 8
    assert len(page.encode()) < 5e6
