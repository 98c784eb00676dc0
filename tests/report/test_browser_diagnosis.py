"""The diagnosis report in a browser: its plots and its replay show what was read and what was found."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from harness.api.assemble import diagnosis_record
from harness.api.diagnosis import input_hashes
from harness.identify.estimate.fit import fit
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.spline_term import Kind, Regressor, blank
from harness.identify.problem.windows import KNOWN
from harness.identify.selection.ledger import Rule
from harness.identify.selection.spline_terms import visited
from harness.identify.validation.baseline_comparison import BaselineComparison
from harness.identify.verdict import Verdict
from harness.report.diagnosis import render_diagnosis
from tests.report import browser
from tests.report.any_page import AnyPage, drawn, scope_of, shown
from tests.report.test_baselines import WORSE
from tests.report.test_diagnosis import case, diagnosis, line  # noqa: F401  (fixtures, but for the last)
from tests.report.test_next_experiment import APART, proposal

pytestmark = pytest.mark.slow
FLOAT32 = 2.0**-23  # relative rounding of numbers in the page
PROPOSAL = proposal(APART)


@pytest.fixture(scope="module")
def unlisted(diagnosis):  # noqa: F811
    """A diagnosis with every section: a spline term, baselines and a proposal beside what was found."""
    problem, base = diagnosis.problem, diagnosis.base
    term = blank(Kind(Regressor.POSITION), *visited(problem, Regressor.POSITION))
    found = fit(problem, Hypothesis((), term), process_noise=base.process_noise)
    ledger = (*diagnosis.ledger, line(Rule.SPLINE, (), found, base, kept=True))
    return replace(
        diagnosis, verdict=Verdict.UNLISTED, effects=(), found=found, ledger=ledger,
        baselines=BaselineComparison(WORSE), next_experiment=PROPOSAL,
    )  # fmt: skip


@pytest.fixture(scope="module")
def page(unlisted, case, tmp_path_factory):  # noqa: F811
    """The report as a file."""
    record = diagnosis_record(unlisted, case, 1.0, input_hashes(case))
    path = tmp_path_factory.mktemp("page") / "diagnosis.html"
    path.write_text(render_diagnosis(unlisted, record, case, command="harness diagnose rolling"), encoding="utf-8")
    return path


class TestPage(AnyPage):
    """What holds of every report."""

    folder = "diagnose"


def test_no_plot_is_a_still_picture(driver):
    """Have an interactive plot in place of every picture, of each section that has one."""
    assert len(driver.find_elements("css selector", "main figure")) == 6
    assert len(driver.find_elements("css selector", "main figure.is-live")) == 6


def test_the_recorded_ball_is_where_it_was_read(driver, unlisted):
    """Place the recorded ball of the replay at its reading, at stamps all over the recording."""
    recording = unlisted.problem.recordings[0]
    for row in np.flatnonzero(np.isfinite(recording.reading))[[3, 200, 600]]:
        driver.execute_script("report.replays[0].clock.set(arguments[0])", float(recording.time[row]))
        ball = driver.find_element("css selector", ".stage circle[data-key=recorded]")
        assert float(ball.get_attribute("data-position")) == pytest.approx(recording.reading[row], rel=FLOAT32)


def test_errors_over_the_horizon_are_those_of_the_table(driver, unlisted):
    """Tell the RMS error of each kind and horizon, before and after, at the length of what was predicted."""
    for kind, both in (("held out", unlisted.heldout), ("identification", unlisted.identify)):
        for when, errors in (("before", both.before), ("after", both.after)):
            lengths, values = drawn(driver, "growth", 0, f"{kind}, {when}")
            np.testing.assert_allclose(values, 1e3 * np.array(list(errors.rms.values())), rtol=FLOAT32)
            # The recordings last 8 s, so that their rest is longer than any window.
            assert lengths == pytest.approx([*(float(name.split()[0]) for name in list(errors.rms)[:-1]), 8.0 - KNOWN])
    scope = scope_of("growth")
    browser.button(driver, scope, "Next point").click()
    first = driver.find_element("css selector", f"{scope} .picked").text
    assert re.fullmatch(
        r"held out, before, windows of 1 s: RMS error [\d.]+ mm; prediction horizon 1 s", first
    ), first  # fmt: skip


def test_each_recording_has_its_residual(driver, unlisted):
    """Draw the residual acceleration of both recordings at all stamps, each at times of its own."""
    for number, recording in enumerate(unlisted.problem.recordings):
        time, residual = drawn(driver, f"residual-acceleration-{number}", 0, "residual")
        np.testing.assert_allclose(time, recording.time, rtol=0, atol=1e-12)
        assert np.ptp(residual) > 0.0
    browser.button(driver, scope_of("residual-acceleration-0"), "Zoom in").click()
    first, second = (np.diff(shown(driver, f"residual-acceleration-{number}"))[0] for number in (0, 1))
    assert first == pytest.approx(second / 2)
    assert np.diff(shown(driver, "before-after"))[0] == pytest.approx(first)  # the verdict shows the first recording


def test_the_proposed_motion_is_that_of_the_table(driver):
    """Draw beam angle and expected position as next_experiment.csv has them, within the limits of the envelope."""
    table = PROPOSAL.table()
    for panel, key, column, factor in (
        (0, "beam angle", "beam_angle_rad", np.degrees(1.0)),
        (1, "expected position", "ball_position_m", 1.0),
    ):
        time, values = drawn(driver, "next-experiment", panel, key)
        np.testing.assert_allclose(time, table["time_s"], rtol=0, atol=1e-12)
        np.testing.assert_allclose(values, factor * table[column], rtol=FLOAT32, atol=1e-9)
        _, limit = drawn(driver, "next-experiment", panel, f"limits of the {key.split()[-1]}")
        assert values.min() >= limit[0]


def test_nodes_of_the_spline_term_are_told(driver, unlisted):
    """Draw every node at its place; tell each with half of its interval."""
    spline = unlisted.found.terms.spline
    place, value = drawn(driver, "spline-term", 0, "nodes")
    np.testing.assert_allclose(place, spline.places, rtol=FLOAT32)
    np.testing.assert_allclose(value, 1e3 * unlisted.problem.rig.mass * np.array(spline.nodes), rtol=FLOAT32, atol=1e-9)
    scope = scope_of("spline-term")
    browser.button(driver, scope, "Previous point").click()  # the last of all points
    said = driver.find_element("css selector", f"{scope} .picked").text
    assert re.fullmatch(
        r"nodes, ± half of the 95 % interval: force on the ball \S+ mN ± \S+ mN; position \S+ m", said
    ), said  # fmt: skip
