"""The report of a check in a browser: recordings as they are, with what is odd in them, and the proposed motion."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from harness.api.check import REPORT
from tests.api.test_check import unseen  # noqa: F401  (a fixture)
from tests.report import browser
from tests.report.any_page import AnyPage, drawn, scope_of

pytestmark = pytest.mark.slow
FLOAT32 = 2.0**-23  # relative rounding of numbers in the page
ODD = "recording-0"


@pytest.fixture(scope="module")
def checked(unseen):  # noqa: F811
    """A check of two recordings, of which the first has a spike and a stretch that is left out."""
    name = unseen.case.identify[0]
    recording = unseen.case.recordings[name]
    spike, aside = np.zeros((2, len(recording.time)), dtype=bool)
    spike[40] = True
    aside[60:80] = True
    odd = replace(recording, outlier=spike, set_aside=aside)
    return replace(unseen, case=replace(unseen.case, recordings=unseen.case.recordings | {name: odd}))


@pytest.fixture(scope="module")
def page(checked, tmp_path_factory):
    """The report as a file."""
    folder = tmp_path_factory.mktemp("checked")
    checked.save(folder)
    return folder / REPORT


class TestPage(AnyPage):
    """What holds of every report."""

    folder = "check"


def test_no_plot_is_a_still_picture(driver):
    """Have an interactive plot in place of every picture: detection limits, two recordings and the proposed motion."""
    assert len(driver.find_elements("css selector", "main figure")) == 4
    assert len(driver.find_elements("css selector", "main figure.is-live")) == 4


def test_recordings_are_drawn_as_they_are(driver, checked):
    """Draw angle and position of every stamp of each recording, but for spikes and what is left out."""
    for number, name in enumerate(checked.case.identify):
        one = checked.case.recordings[name]
        time, angle = drawn(driver, f"recording-{number}", 0, "angle")
        np.testing.assert_allclose(time, one.time, rtol=0, atol=1e-12)
        np.testing.assert_allclose(angle, np.degrees(one.angle), rtol=FLOAT32, atol=1e-9)
        good = one.usable & ~one.outlier
        time, position = drawn(driver, f"recording-{number}", 1, "position")
        np.testing.assert_allclose(time, one.time[good], rtol=0, atol=1e-12)
        np.testing.assert_allclose(position, one.position[good], rtol=FLOAT32, atol=1e-9)


def test_what_is_odd_is_drawn_apart(driver, checked):
    """Draw the spike and the readings left out as dots of their own, and shade the stretch."""
    one = checked.case.recordings[checked.case.identify[0]]
    for key, mask in (("outlier", one.outlier), ("left_out", one.set_aside)):
        time, position = drawn(driver, ODD, 1, key)
        np.testing.assert_allclose(time, one.time[mask], rtol=0, atol=1e-12)
        np.testing.assert_allclose(position, one.position[mask], rtol=FLOAT32)
    marks = driver.execute_script("return report.charts.get(arguments[0]).data.marks", ODD)
    assert [(mark["begin"], mark["end"]) for mark in marks] == [(one.time[59], one.time[80])]


def test_limits_are_those_of_the_table(driver, checked):
    """Draw every limit that a size reaches in typical sizes, the lowest on top, and tell it with its unit."""
    for key, kind in (("as recorded", "limit"), ("once the rest is explained", "explained")):
        shares, rows = drawn(driver, "detection-limits", 0, key)
        both = [(getattr(one, kind), one.typical, one.inverse) for one in checked.detection.limits]
        known = [
            typical / limit if turned else limit / typical for limit, typical, turned in both if 0 < limit < np.inf
        ]
        np.testing.assert_allclose(np.sort(shares), np.sort(known))
        assert len(set(rows)) == len(rows)
    shares, rows = drawn(driver, "detection-limits", 0, "once the rest is explained")
    assert (np.diff(shares[np.argsort(-rows)]) >= 0.0).all()
    scope = scope_of("detection-limits")
    browser.button(driver, scope, "Next point").click()
    said = driver.find_element("css selector", f"{scope} .picked").text
    assert re.fullmatch(r"as recorded, [a-z ]+ \S+( \S+)*: detection limit in typical sizes of the effect \S+", said), (
        said
    )


def test_the_proposed_motion_is_that_of_the_table(driver, checked):
    """Draw beam angle and expected position of the proposal."""
    proposal = checked.proposal
    time, angle = drawn(driver, "next-experiment", 0, "beam angle")
    np.testing.assert_allclose(time, proposal.time, rtol=0, atol=1e-12)
    np.testing.assert_allclose(angle, np.degrees(proposal.angle), rtol=FLOAT32, atol=1e-9)
    _, position = drawn(driver, "next-experiment", 1, "expected position")
    np.testing.assert_allclose(position, proposal.reading, rtol=FLOAT32)
