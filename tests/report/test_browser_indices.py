"""Sobol' indices in a browser: rows with names, points that say what the table says."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from harness.report.page import render_page
from harness.report.sweep.indices import section
from harness.sweeps.indices import Index, Indices
from harness.sweeps.results import MEASURED
from tests.report import browser
from tests.report.any_page import AnyPage, plot_of, shown

pytestmark = pytest.mark.slow
FACTORS = (
    Index("effects.presliding_hysteresis.coefficient", 0.71, 0.09, 0.78, 0.1),
    Index("effects.level_error.angle", 0.18, 0.06, 0.27, 0.08),
    Index("mujoco.friction", -0.01, 0.03, 0.02, 0.02),
)
ANCHOR = "indices-0"


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    """The section alone, of made-up indices."""
    indices = (Indices("mujoco", MEASURED, {}, FACTORS, 64), Indices("cam", MEASURED, {}, FACTORS[:2], 64))
    made = section(SimpleNamespace(results=SimpleNamespace(indices=indices), measured="measured"))
    path = tmp_path_factory.mktemp("page") / "indices.html"
    path.write_text(render_page("indices", [made]), encoding="utf-8")
    return path


class TestPage(AnyPage):
    """What holds of every report."""

    folder = "indices"


def test_every_index_is_told_with_its_interval(driver):
    """Go through all points: factor, order, share of the variance and half of the interval are the given ones."""
    scope = f"[data-chart='{ANCHOR}']"
    button = browser.button(driver, scope, "Next point")
    told = []
    for _ in range(2 * len(FACTORS)):
        button.click()
        told.append(driver.find_element("css selector", f"{scope} .picked").text.replace("−", "-"))
    for one in FACTORS:
        first = f"first order: alone, {one.factor}: share of the error's variance {one.first:g} ± {one.first_half:g}"
        total = f"total: with others, {one.factor}: share of the error's variance {one.total:g} ± {one.total_half:g}"
        assert told.count(first) == told.count(total) == 1


def test_intervals_are_in_sight(driver):
    """Show at first every interval to its ends, and 0."""
    low, high = shown(driver, ANCHOR)
    assert low < min(one.first - one.first_half for one in FACTORS) < 0.0
    assert high > max(one.total + one.total_half for one in FACTORS)


def test_points_lie_below_the_names_of_their_rows(driver):
    """Draw the rows from top to bottom as the table has them, in each the total below the first order."""
    plot_of(driver, ANCHOR)
    rows = driver.execute_script(
        "const chart = report.charts.get(arguments[0]); const [first, total] = chart.data.panels[0].series;"
        "return [first, total].map((one) => one.rows.map((row, at) => "
        "[one.notes[at], chart.plots[0].valToPos(one.y[row], 'y')]))",
        ANCHOR,
    )
    (first, total) = (dict(one) for one in rows)
    names = [one.factor for one in FACTORS]
    places = [place[name] for name in names for place in (first, total)]
    assert places == sorted(places)
    assert sorted(first) == sorted(total) == sorted(names)
