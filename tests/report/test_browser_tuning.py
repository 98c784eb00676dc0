"""The tuning report in a browser: its controls, its values compared with recordings and held-out errors."""

from __future__ import annotations

import re

import numpy as np
import pytest
from selenium.webdriver import ActionChains

from harness.api.tuning import Tuning
from harness.engines.catalogue import engine_of
from harness.failures import Failures
from harness.identify.pose import problem_of
from harness.identify.problem.windows import AHEAD, KNOWN
from harness.numerics import rms
from harness.recording import load_case
from harness.report.tuning import render_tuning
from harness.simulator import Experiment, write_case
from harness.tuning.tune import tune
from tests.report import browser
from tests.report.any_page import AnyPage, drawn

pytestmark = pytest.mark.slow
FLOAT32 = 2.0**-23  # relative rounding of positions in the page
# Two recordings of 8.5 s: each has a block of three windows, and one of a single window, which is drawn whole.
RIG = Experiment(
    hidden={"contact_slip": {"friction_coefficient": 0.0085}, "level_error": {"angle": 0.002}},
    duration=8.5, rate=25.0, counts=4096, identify=2, predict=0, seed=501,
)  # fmt: skip
HELD = "#errors figure:nth-of-type(1) .live"


@pytest.fixture(scope="module")
def tuning(tmp_path_factory):
    """MuJoCo tuned to a ball that slips on a beam that is not level."""
    folder = tmp_path_factory.mktemp("tuned") / "rig"
    write_case(folder, RIG)
    case = load_case(folder)
    return Tuning(case, tune(problem_of(case), engine_of("mujoco"), {"time_step": 2e-3}, ["friction"]))


@pytest.fixture(scope="module")
def page(tuning, tmp_path_factory):
    """The report as a file."""
    failures = Failures()
    path = tmp_path_factory.mktemp("page") / "tuning.html"
    path.write_text(render_tuning(tuning._subject(), failures), encoding="utf-8")
    assert failures.all == ()
    return path


class TestPage(AnyPage):
    """What holds of every report."""

    folder = "tune"


@pytest.mark.parametrize("number", [0, 1])
def test_recordings_are_drawn_as_they_are(driver, tuning, number):
    """Draw every reading of each recording at its stamp."""
    recording = tuning.case.recordings[tuning.case.identify[number]]
    time, position = drawn(driver, f"held-out-{number}", 0, "recorded")
    np.testing.assert_allclose(time, recording.time, rtol=0, atol=1e-12)
    np.testing.assert_allclose(position, recording.position, rtol=FLOAT32)


@pytest.mark.parametrize("which", ["before", "after"])
def test_drawn_predictions_have_the_errors_that_are_told(driver, tuning, which):
    """Draw what was predicted: over the block of a single window its RMS error is the one in tuning.json."""
    told = tuning.content()["held_out"][f"{which}_m"]
    assert len(told) == 4
    for number in (0, 1):
        recording = tuning.case.recordings[tuning.case.identify[number]]
        time, position = drawn(driver, f"held-out-{number}", 0, which)
        begin = recording.time[0] + 3.0 + KNOWN  # blocks begin every 3 s
        assert time[0] == pytest.approx(begin - AHEAD, abs=0.04)
        last = time >= begin - 1e-9
        assert time[last][-1] < begin + AHEAD
        error = position[last] - np.interp(time[last], recording.time, recording.position)
        # At 25 Hz a cell of 40 ms has one reading, so that nothing was averaged.
        assert rms(error) == pytest.approx(told[2 * number + 1], rel=1e-5)
        _, below = drawn(driver, f"held-out-{number}", 1, which)
        np.testing.assert_allclose(below[last], 1e3 * error, rtol=FLOAT32, atol=1e-3)  # 1e-3 mm: position's rounding


def test_the_replay_shows_each_recording_and_its_runs(driver, tuning):
    """Choose each run in turn: balls are where its chart has them, the beam tilts as this recording's angle says."""
    selection = next(one for one in driver.find_elements("css selector", ".replay select") if "held-out" in one.text)
    assert len(selection.find_elements("css selector", "option")) == 3
    for choice, chart in enumerate(("held-out-0", "held-out-1", "free-runs")):
        browser.choose(driver, selection, choice)
        time, position = drawn(driver, chart, 0, "after")
        row = len(time) // 3
        driver.execute_script("report.replays[0].clock.set(arguments[0])", float(time[row]))
        ball = driver.find_element("css selector", ".stage circle[data-key=after]")
        assert float(ball.get_attribute("data-position")) == pytest.approx(position[row], rel=FLOAT32)
        drive = tuning.tuned.model.problem.recordings[choice % 2].drive
        beam = driver.find_element("css selector", ".stage .beam").get_attribute("transform")
        angle = np.degrees(np.interp(time[row], drive.time, drive.states[:, 0]))
        assert float(re.search(r"rotate\((.*)\)", beam)[1]) == pytest.approx(angle, rel=1e-5, abs=1e-5)
    driver.execute_script("report.replays[0].choose(0); report.replays[0].clock.set(0.5)")
    ball = driver.find_element("css selector", ".stage circle[data-key=after]")
    assert ball.get_attribute("hidden") is not None  # nothing is predicted in the first 2 s


def test_plots_of_one_recording_are_linked(driver):
    """Zoom and set the instant in one plot: those of the same recording follow, those of the other do not."""
    browser.button(driver, HELD, "Zoom in").click()
    over = driver.find_element("css selector", f"{HELD} .u-over")
    driver.execute_script("arguments[0].scrollIntoView({block: 'center'})", over)
    ActionChains(driver).move_to_element(over).click().perform()
    spans, now = driver.execute_script(
        "const all = ['held-out-0', 'free-runs', 'held-out-1'].map((id) => report.charts.get(id));"
        "return [all.map((one) => one.plots.map((plot) => [plot.scales.x.min, plot.scales.x.max])),"
        " all.map((one) => one.clock.now)]"
    )
    assert spans[0][0][1] - spans[0][0][0] == pytest.approx(8.5 / 2, abs=0.05)
    assert all(span == pytest.approx(spans[0][0]) for one in spans[:2] for span in one)
    assert spans[2][0][1] - spans[2][0][0] == pytest.approx(8.5, abs=0.05)
    assert now[0] == now[1] == pytest.approx(sum(spans[0][0]) / 2, abs=0.02)
    assert now[2] != now[0]
    assert float(driver.find_element("css selector", "input.time").get_attribute("value")) == pytest.approx(now[0])


def test_values_are_shown_with_units(driver):
    """Show position and error of each run where the mouse is."""
    over = driver.find_element("css selector", f"{HELD} .u-over")
    driver.execute_script("arguments[0].scrollIntoView({block: 'center'})", over)
    ActionChains(driver).move_to_element(over).perform()
    time = float(re.search(r"time ([\d.]+) s", driver.find_element("css selector", f"{HELD} .at").text)[1])
    box = driver.find_element("css selector", f"{HELD} input[data-key=after]")
    position, error = box.find_element("xpath", "../following-sibling::span").text.replace("−", "-").split(", ")
    at, values = drawn(driver, "held-out-0", 0, "after")
    # The time has four digits (0.5 ms), and no ball is faster than 1 m/s here.
    assert float(position.removesuffix(" m")) == pytest.approx(np.interp(time, at, values), abs=1e-3)
    at, values = drawn(driver, "held-out-0", 1, "after")
    assert float(error.removesuffix(" mm")) == pytest.approx(np.interp(time, at, values), abs=1.0)


def test_a_run_is_switched_off_everywhere(driver):
    """Hide the runs before tuning in all plots and in the replay with one switch, and show them again."""
    state = (
        "return [...report.charts.values()].flatMap((one) => one.plots.flatMap((plot) => "
        "plot.series.filter((line) => line.key === 'before').map((line) => line.show)))"
    )
    driver.find_element("css selector", f"{HELD} input[data-key=before]").click()
    assert driver.execute_script(state) == [False] * 6
    other = driver.find_element("css selector", ".replay input[data-key=before]")
    assert not other.is_selected()
    other.click()
    assert driver.execute_script(state) == [True] * 6
