"""The comparison report in a browser: every control is used, values and balls are compared with trajectories.csv."""

from __future__ import annotations

import re

import numpy as np
import pytest
from selenium.webdriver import ActionChains, Keys

from harness.api.outputs import trajectories
from harness.report.comparison import render_comparison
from harness.report.palette import label_of
from tests.report import browser
from tests.report.any_page import AnyPage
from tests.report.test_comparison import MANIFEST, result  # noqa: F401  (a fixture)

pytestmark = pytest.mark.slow
FLOAT32 = 2.0**-23  # relative rounding of positions in the page
MICROMETRE = 1e-6  # rounding of trajectories.csv


@pytest.fixture(scope="module")
def page(result, tmp_path_factory):  # noqa: F811
    """The report as a file."""
    path = tmp_path_factory.mktemp("page") / "report.html"
    path.write_text(render_comparison(result, MANIFEST), encoding="utf-8")
    return path


class TestPage(AnyPage):
    """What holds of every report."""

    folder = "run"


@pytest.fixture
def clock(driver):
    """Sets the page's instant, or asks for it and for the span shown."""

    def ask(what: str):
        return driver.execute_script(f"return report.clock('recording').{what}")

    return ask


FIRST = "#answer figure .live"
# Where the line of the instant is in a plot and how wide that is [px], after the browser has drawn twice.
LINE = """
  const [figure, done] = arguments;
  requestAnimationFrame(() => requestAnimationFrame(() => {
    const head = figure.querySelector(".playhead");
    const at = new DOMMatrix(getComputedStyle(head).transform).m41;
    done([head.hidden, at, head.parentElement.clientWidth]);
  }));
"""


def test_the_line_of_the_instant_stands_where_it_is(driver, clock):
    """Keep it at its time when another span is shown, and hide it when it is not in that."""
    clock("set(4.2)")
    figure = driver.find_element("css selector", FIRST)
    for span in ((3.0, 6.0), (4.0, 5.0)):
        clock(f"show{span}")
        begin, end = clock("shown")
        hidden, at, width = driver.execute_async_script(LINE, figure)
        assert not hidden
        assert at == pytest.approx((4.2 - begin) / (end - begin) * width, abs=1.0)
    clock("show(4.5, 5.5)")
    assert driver.execute_async_script(LINE, figure)[0]


def test_balls_are_where_the_trajectories_are(driver, result):  # noqa: F811
    """Place every ball of the whole run at its position in trajectories.csv, at stamps all over the recording."""
    table = trajectories(result)
    runs = [one for one in driver.find_elements("css selector", ".replay select") if "whole" in one.text]
    if runs:
        driver.execute_script("arguments[0].value = 1; arguments[0].dispatchEvent(new Event('change'))", runs[0])
    whole = result.setting.horizons[0]
    compared = 0
    for row in np.linspace(whole.first[0] + 1, whole.last[0], 7).astype(int):
        driver.execute_script("report.clock('recording').set(arguments[0])", float(table["time_s"][row]))
        balls = driver.execute_script(
            "return [...document.querySelectorAll('.stage circle[data-key]')]"
            ".filter((one) => !one.hasAttribute('hidden')).map((one) => [one.dataset.key,"
            " Number(one.dataset.position), Number(one.getAttribute('cx')) / report.replays[0].scale])"
        )
        for key, position, drawn in balls:
            if key == "measured" and not result.setting.ball.trusted[row]:
                continue  # an outlier: the ball is between its neighbours
            expected = table[f"{key}_m"][row]
            assert position == pytest.approx(expected, rel=FLOAT32, abs=MICROMETRE), (key, row)
            assert drawn == pytest.approx(position, abs=1e-12)
            compared += 1
    assert compared >= 7 * 3


def test_the_beam_tilts_as_recorded(driver, result):  # noqa: F811
    """Turn the beam by the recorded angle, clockwise for a positive one, which lowers the +s end."""
    drive = result.setting.drive
    for row in (100, 350):
        driver.execute_script("report.clock('recording').set(arguments[0])", float(drive.time[row]))
        transform = driver.find_element("css selector", ".stage .beam").get_attribute("transform")
        turned = float(re.search(r"rotate\((.*)\)", transform)[1])
        assert turned == pytest.approx(np.degrees(drive.states[row, 0]), rel=FLOAT32, abs=1e-6)


def test_it_plays_pauses_and_steps(driver, clock):
    """Play with the button and the space key, step with buttons and arrows, jump to both ends."""
    replay = driver.find_element("css selector", ".replay")
    browser.button(driver, ".replay", "▶ Play").click()
    begin = clock("now")
    browser.settle(driver)
    browser.button(driver, ".replay", "❚❚ Pause").click()
    assert clock("now") > begin
    held = clock("now")
    browser.button(driver, ".replay", "One step forward").click()
    assert clock("now") == pytest.approx(held + 0.02)
    browser.button(driver, ".replay", "One step back").click()
    assert clock("now") == pytest.approx(held)
    driver.execute_script("arguments[0].focus()", replay)
    for key, expected in ((Keys.ARROW_RIGHT, held + 0.02), (Keys.END, clock("full")[1]), (Keys.HOME, clock("full")[0])):
        replay.send_keys(key)
        assert clock("now") == pytest.approx(expected)
    replay.send_keys(" ")
    assert "Pause" in driver.find_element("css selector", ".replay .play").text
    replay.send_keys(" ")
    assert "Play" in driver.find_element("css selector", ".replay .play").text


def test_slider_plots_and_replay_are_linked(driver, clock):
    """Move the line in every plot with the slider, and the slider with a click on a plot."""
    slider = driver.find_element("css selector", "input.time")
    driver.execute_script("arguments[0].value = 3; arguments[0].dispatchEvent(new Event('input'))", slider)
    heads = driver.execute_script(
        "return [...report.charts.values()].filter((one) => one.data.clock !== '').flatMap((one) => "
        "one.plots.map((plot, at) => "
        "[plot.posToVal(new DOMMatrix(getComputedStyle(one.heads[at]).transform).e, 'x'), one.heads[at].hidden]))"
    )
    assert len(heads) >= 6
    for at, hidden in heads:
        assert at == pytest.approx(3.0, abs=0.01)  # a pixel is 6 s / 900
        assert not hidden
    assert slider.get_attribute("aria-valuetext") == "3.00 seconds"
    over = driver.find_element("css selector", "#residuals .u-over")
    driver.execute_script("arguments[0].scrollIntoView({block: 'center'})", over)
    ActionChains(driver).move_to_element(over).click().perform()
    middle = sum(clock("full")) / 2
    assert clock("now") == pytest.approx(middle, abs=0.02)
    assert float(slider.get_attribute("value")) == pytest.approx(clock("now"))


def test_zoom_is_common_to_all_plots(driver, clock):
    """Zoom in one plot: all plots of time show the same span."""
    full = clock("full")
    browser.button(driver, FIRST, "Zoom in").click()
    assert np.diff(clock("shown"))[0] == pytest.approx(np.diff(full)[0] / 2)
    shown = driver.execute_script(
        "return [...report.charts.values()].filter((one) => one.data.clock !== '')"
        ".flatMap((one) => one.plots.map((plot) => "
        "[plot.scales.x.min, plot.scales.x.max]))"
    )
    assert len(shown) >= 6
    for span in shown:
        assert span == pytest.approx(clock("shown"))


def test_growth_of_errors_is_told_point_by_point(driver, result):  # noqa: F811
    """Tell the RMS error of every source and horizon, with its standard error, as the scores have them."""
    said = driver.find_element("css selector", "#horizons .picked")
    after = browser.button(driver, "#horizons", "Next point")
    driver.execute_script("arguments[0].scrollIntoView({block: 'center'})", after)
    told = {}
    while True:
        after.click()
        source, _, rest = said.text.partition(", ")
        horizon, value = re.match(r"(.*?)(?:, \d+ runs?)?: RMS error ([\d.]+) mm", rest).groups()
        if (source, horizon) in told:
            break
        told[source, horizon] = float(value)
    for source in ("cam", "pybullet"):
        for horizon in result.setting.horizons:
            expected = result.score_of(source, horizon).rms_error_mm
            assert told[label_of(source), horizon.name] == pytest.approx(expected, rel=6e-4)  # four digits
    names = {horizon.name for horizon in result.setting.horizons}
    assert {horizon for source, horizon in told if source == "stationary ball"} == names


def test_values_are_shown_on_hover(driver, result):  # noqa: F811
    """Show every source's value with its unit where the mouse is."""
    over = driver.find_element("css selector", f"{FIRST} .u-over")
    driver.execute_script("arguments[0].scrollIntoView({block: 'center'})", over)
    ActionChains(driver).move_to_element(over).perform()
    time = float(re.search(r"time ([\d.]+) s", driver.find_element("css selector", f"{FIRST} .at").text)[1])
    full = driver.execute_script("return report.clock('recording').full")
    assert time == pytest.approx(sum(full) / 2, abs=0.02)
    text = (
        driver.find_element("css selector", f"{FIRST} input[data-key=measured]")
        .find_element("xpath", "../following-sibling::span")
        .text
    )
    setting = result.setting
    seen = setting.ball.trusted  # a reading that is an outlier is passed over
    expected = np.interp(time, setting.time[seen], setting.recording.position[seen])
    value, unit = text.replace("−", "-").split()
    assert unit == "m"
    # Between two readings of σ = 0.3 mm the instant is known to 1 ms only, the value has four digits.
    assert float(value) == pytest.approx(expected, abs=2e-3)


def test_sources_are_switched_everywhere(driver):
    """Switch a source off in all plots and the replay with one switch, and on again with another."""
    state = (
        "return [...report.charts.values()].flatMap((one) => one.plots.flatMap((plot) => plot.series.filter((line) => "
        "line.key === 'cam').map((line) => line.show)))"
    )
    box = driver.find_element("css selector", f"{FIRST} input[data-key=cam]")
    box.click()
    assert set(driver.execute_script(state)) == {False}
    ball = driver.find_element("css selector", ".stage circle[data-key=cam]")
    assert ball.get_attribute("hidden") is not None
    other = driver.find_element("css selector", ".replay input[data-key=cam]")
    assert not other.is_selected()
    other.click()
    assert set(driver.execute_script(state)) == {True}
    assert ball.get_attribute("hidden") is None


def test_failures_are_marked(driver, clock):
    """List the broken engine's failure on the slider; its button leads to that instant."""
    driver.find_element("css selector", ".jumps summary").click()
    jump = driver.find_element("css selector", ".jump.failure")
    assert "broken failed" in jump.find_element("xpath", "..").text
    jump.click()
    assert f"{clock('now'):.1f}" in jump.text
    assert driver.find_elements("css selector", ".strip .mark.failure")


def test_selections_of_the_replay_work(driver):
    """Enlarge the tilt and change the speed."""
    tilt = next(one for one in driver.find_elements("css selector", ".replay select") if "larger" in one.text)
    speed = next(one for one in driver.find_elements("css selector", ".replay select") if "0.25" in one.text)
    driver.execute_script("report.clock('recording').set(2)")
    turned = "return Number(/rotate\\((.*)\\)/.exec(document.querySelector('.beam').getAttribute('transform'))[1])"
    plain = driver.execute_script(turned)
    for one, value in ((tilt, 5), (speed, 2)):
        driver.execute_script(f"arguments[0].value = {value}; arguments[0].dispatchEvent(new Event('change'))", one)
    assert driver.execute_script(turned) == pytest.approx(5 * plain)
    assert driver.execute_script("return report.replays[0].speed") == 2
