"""The sweep report in a browser: points say what runs.parquet says, axes, switches, paper."""

from __future__ import annotations

import re

import numpy as np
import pytest
from selenium.webdriver import ActionChains

from harness import sweep
from tests.acceptance.short import write_short_case
from tests.report import browser
from tests.report.any_page import AnyPage

pytestmark = pytest.mark.slow
SPEC = """cases = ["rig"]
recordings = "all"
sources = ["mujoco", "pybullet", "cam"]
time_step = [4e-3, 2e-3]
[mujoco]
friction = [0.5, 0.02]
[effects.rolling_resistance]
coefficient = [0.0, 0.001, 0.002]
"""
WORK = "#work-precision .live"
ROUNDED = 6e-4  # relative: four digits
NUMBER = r"[−\d.]+(?:·10[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)?"


def number(text: str) -> float:
    """A number as the page writes it."""
    plain = text.translate(str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹−", "-0123456789-")).replace("·10", "e")
    return float(plain)


@pytest.fixture(scope="module")
def swept(tmp_path_factory):
    """A sweep over steps, friction and rolling resistance on two short recordings; its page is beside its rows."""
    folder = tmp_path_factory.mktemp("sweep")
    write_short_case(folder / "rig")
    (folder / "sweep.toml").write_text(SPEC, encoding="utf-8")
    return sweep(folder / "sweep.toml", out=folder / "out")


@pytest.fixture(scope="module")
def page(swept):
    """The report."""
    assert swept.report_failures == ()
    return swept.folder / "sweep.html"


class TestPage(AnyPage):
    """What holds of every report."""

    folder = "sweep"


def told(driver, scope: str) -> list[str]:
    """What each point says, by going through all of them with the button."""
    button, said = browser.button(driver, scope, "Next point"), f"{scope} .picked"
    driver.execute_script("arguments[0].scrollIntoView({block: 'center'})", button)
    found: list[str] = []
    while True:
        button.click()
        text = driver.find_element("css selector", said).text
        if found and text == found[0]:
            return found
        found.append(text)


def test_every_point_says_what_its_row_says(driver, swept):
    """Go through all points over the resistance: number, settings and both errors are those of runs.parquet."""
    rows = swept.runs.set_index("run")
    scope = "#runs figure:last-of-type .live"
    seen: dict[str, set[int]] = {"RMS error": set(), "difference from CAM": set()}
    for text in told(driver, scope):
        found = re.search(
            rf"run (\d+), rig: (\S+), time_step = (\S+),(?: mujoco\.friction = (\S+),)? "
            rf"effects\.rolling_resistance\.coefficient = ([^:,]+).*: (RMS error|difference from CAM) ({NUMBER}) m; "
            rf"effects\.rolling_resistance\.coefficient ({NUMBER})$",
            text,
        ) or re.search(
            rf"run (\d+), rig: (\S+),()() effects\.rolling_resistance\.coefficient = ([^:,]+).*: "
            rf"(RMS error) ({NUMBER}) m; effects\.rolling_resistance\.coefficient ({NUMBER})$",
            text,
        )
        assert found, text
        row = rows.loc[int(found[1])]
        assert found[2] == row["recording"]
        if found[3]:
            assert float(found[3]) == row["time_step"]
        if found[4]:
            assert float(found[4]) == row["mujoco.friction"]
        assert float(found[5]) == number(found[8]) == row["effects.rolling_resistance.coefficient"]
        column = "error_measured_rms_m" if found[6] == "RMS error" else "error_cam_max_m"
        assert number(found[7]) == pytest.approx(row[column], rel=ROUNDED)
        seen[found[6]].add(int(found[1]))
    assert seen["RMS error"] == set(rows.index)
    assert seen["difference from CAM"] == set(rows.index[rows["source"] != "cam"])


def test_medians_are_those_of_the_rows(driver, swept):
    """Tell the median time and errors of each engine and step size."""
    medians = [text for text in told(driver, WORK) if "medians" in text]
    rows = swept.runs
    assert len(medians) == 4 + 5  # engines and steps, then with CAM
    for text in medians:
        found = re.search(
            rf"^(\w+), medians, (?:time step ([\d.]+) s, )?median of (\d+) runs: (RMS error|difference from CAM) "
            rf"({NUMBER}) m; processor time per second of motion ({NUMBER}) s$",
            text,
        )
        assert found, text
        own = rows[rows["source"] == found[1].lower()]
        if found[2]:
            own = own[own["time_step"] == float(found[2])]
        assert int(found[3]) == len(own)
        column = "error_measured_rms_m" if found[4] == "RMS error" else "error_cam_max_m"
        assert number(found[5]) == pytest.approx(own[column].median(), rel=ROUNDED)
        assert number(found[6]) == pytest.approx((own["cpu_s"] / own["motion_s"]).median(), rel=ROUNDED)


def test_the_point_under_the_mouse_is_told(driver):
    """Move the mouse onto a point: it is ringed and told; far from all points nothing is."""
    over = driver.find_element("css selector", f"{WORK} .u-over")
    driver.execute_script("arguments[0].scrollIntoView({block: 'center'})", over)
    points = driver.execute_script(
        "const chart = report.charts.get('work-precision-chart'); const plot = chart.plots[0]; const points = [];"
        "for (const one of chart.data.panels[0].series) (one.rows ?? []).forEach((row, number) => {"
        "  if (one.y[row] === null) return;"
        "  const place = [plot.valToPos(chart.x[row], 'x'), plot.valToPos(one.y[row], 'y')];"
        "  points.push([one.key, ...place, `${one.label}, ${one.notes[number]}`]);"
        "});"
        "return points"
    )
    aim = next(np.array(place) for key, *place, _ in points if key == "pybullet")
    size = over.size
    across, down = np.round(aim - np.array([size["width"], size["height"]]) / 2).astype(int).tolist()
    ActionChains(driver).move_to_element_with_offset(over, across, down).perform()
    mouse = driver.execute_script(
        "const { left, top } = report.charts.get('work-precision-chart').plots[0].cursor; return [left, top]"
    )
    assert np.abs(mouse - aim).max() <= 1.5  # whole pixels of the page, from the middle of the plot
    # Measured times may put several points within those pixels: the nearest is told.
    _, left, top, label = min(points, key=lambda point: np.hypot(point[1] - mouse[0], point[2] - mouse[1]))
    said = driver.find_element("css selector", f"{WORK} .picked")
    assert said.text.startswith(label)
    ring = driver.find_element("css selector", f"{WORK} .ring:not([hidden])")
    place = driver.execute_script("return new DOMMatrix(getComputedStyle(arguments[0]).transform)", ring)
    assert (place["e"], place["f"]) == (pytest.approx(left, abs=0.01), pytest.approx(top, abs=0.01))
    key = next(point[0] for point in points if point[3] == label)
    box = driver.find_element("css selector", f"{WORK} input[data-key='{key}']")
    box.click()
    assert label not in driver.find_element("css selector", f"{WORK} .picked").text
    box.click()


def test_a_logarithmic_axis_is_zoomed_by_ratios(driver):
    """Zoom in: equal ratios have equal lengths. Its marks are 1, 2 and 5 of each decade, of many decades 1 alone."""
    span = "return report.charts.get('work-precision-chart').clock.shown"
    full = np.log(driver.execute_script(span))
    width = np.diff(full)[0]
    browser.button(driver, WORK, "Zoom in").click()
    half = np.log(driver.execute_script(span))
    np.testing.assert_allclose(half, [full[0] + width / 4, full[1] - width / 4], rtol=1e-9)
    marks = driver.execute_script("return report.axes.logarithmic(3e-4, 0.2)")
    assert marks == pytest.approx([1e-3, 1e-2, 1e-1])
    assert driver.execute_script("return report.axes.logarithmic(0.9, 21)") == pytest.approx([1, 2, 5, 10, 20])
    assert driver.execute_script("return report.axes.logarithmic(2.1, 2.9)") == pytest.approx([2.2, 2.4, 2.6, 2.8])


def test_a_source_is_switched_off_in_all_plots(driver):
    """Hide an engine's runs over every quantity with one switch; its points are passed over then."""
    scope = "#runs figure:last-of-type .live"
    driver.find_element("css selector", f"{scope} input[data-key=mujoco]").click()
    sources = {text.split(", ")[0] for text in told(driver, scope)}
    assert sources == {"best fit", "PyBullet", "CAM"}
    boxes = driver.find_elements("css selector", "#runs input[data-key=mujoco]")
    assert len(boxes) == 3
    assert not any(one.is_selected() for one in boxes)
    driver.execute_script("arguments[0].scrollIntoView({block: 'center'})", boxes[0])
    boxes[0].click()
    assert all(one.is_selected() for one in boxes)
