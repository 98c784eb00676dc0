"""The report's section on the next experiment, for a real proposal."""

from __future__ import annotations

import re
from types import SimpleNamespace

import numpy as np
import pytest

from harness.identify.design.excitation import LIBRARY, OperatingEnvelope
from harness.identify.design.proposal import NOTHING, Proposal, Separation
from harness.report.diagnosis.experiment import section
from harness.report.page import render_page

ROOM = OperatingEnvelope(low=0.2, high=0.45, angle=0.05, rate=0.3, acceleration=3.0, interval=0.02, pull=6.5)
APART = (Separation("rolling_radius", "position_gain", 0.8, 7.4, 2.4), Separation("level_error", "pull", 2.0, 9.1, 2.4))
SEEN = (Separation("position_lag", NOTHING, 0.0, 6.9, 3.7), Separation("contact_slip", NOTHING, 0.0, 0.1, 3.7))


def proposal(separations: tuple[Separation, ...]) -> Proposal:
    """A swing that would bring these separations."""
    time = ROOM.time
    tried = {LIBRARY[0].name: 7.4, LIBRARY[1].name: 3.2}
    angle = 0.03 * np.sin(time)
    return Proposal(LIBRARY[0], time, angle, 0.3 - 0.1 * np.sin(time), separations, 0.0023, tried, ROOM)


def page(made: Proposal | None) -> str | None:
    """The section alone, as HTML; `None` where there is none."""
    shown = section(SimpleNamespace(diagnosis=SimpleNamespace(next_experiment=made)))
    return shown and render_page("next", [shown])


def test_it_says_what_to_run_and_what_to_expect() -> None:
    """Lead with one sentence of the hardest pair, then a picture, and every pair with its σ in a table."""
    html = page(proposal(APART))
    answer = html[html.index('class="answer"') : html.index("<figure>")]
    assert "To distinguish rolling radius from position gain, run the profile “slow swing”" in answer
    assert "expected separation 7.4 σ (0.8 σ on the data at hand)" in answer
    table = html[html.index("Expected discrimination") :].split("</table>")[0]
    assert [re.findall(r">(\d\.\d)<", row) for row in table.split("<tr")[2:]] == [
        ["0.8", "7.4", "2.4"],
        ["2.0", "9.1", "2.4"],
    ]
    assert "next_experiment.csv" in html
    assert "2.3 mm after 16 s" in html


def test_it_says_which_effects_would_be_seen() -> None:
    """Say of each effect of typical size whether it would be seen."""
    html = page(proposal(SEEN))
    assert "it shows 1 of 2 (position lag at 6.9 σ)" in html
    table = html[html.index("Expected detection of effects") :].split("</table>")[0]
    assert re.search(r"position_lag.*yes", table)
    assert re.search(r"contact_slip.*no", table)


def test_the_chosen_profile_stands_out() -> None:
    """List every profile that was tried, the best first, and set the chosen one apart."""
    table = page(proposal(APART)).split("All profiles within the operating envelope")[1]
    assert re.findall(r'<tr class="(\w*)"', table)[:2] == ["best", ""]
    assert table.index(LIBRARY[0].name) < table.index(LIBRARY[1].name)


@pytest.mark.parametrize("made", [proposal(APART), proposal(SEEN)])
def test_the_picture_is_drawn_once_and_described(made: Proposal) -> None:
    """Draw angle and position in one picture, with words for those who do not see it."""
    html = page(made)
    assert html.count("<img") == 1
    assert 'alt="Beam angle of the profile slow swing and the ball' in html


def test_no_proposal_has_no_section() -> None:
    """Leave the section out where there is nothing to propose."""
    assert page(None) is None
