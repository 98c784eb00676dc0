"""The picture of detection limits: order, and what it says of effects that cannot be seen."""

from __future__ import annotations

import math

from harness.identify.design.detection import Limit
from harness.report.check.limits import drawn, picture_of


def limit(effect: str, as_recorded: float, explained: float, *, inverse: bool = False) -> Limit:
    """A limit of an effect of the typical size 2 s."""
    return Limit(effect, "size", "s", 0.0, inverse, as_recorded, explained, 2.0)


LIMITS = (
    limit("never", math.inf, math.inf),
    limit("angle_lag", 4.0, 1.0),
    limit("large_alone", 20.0, 8.0),
    limit("contact_slip", 0.0, 4.0, inverse=True),
    limit("hidden_now", math.inf, 0.5),
)


def test_effects_are_in_the_order_of_their_limits() -> None:
    """List first what shows at the smallest share of its typical size, and say of the rest what cannot be seen."""
    assert [one.get_text() for one in drawn(LIMITS).axes[0].get_yticklabels()] == [
        "hidden now (as recorded at no size)",
        "angle lag",
        "contact slip (as recorded at no size)",
        "large alone (not at its typical size)",
        "never (at no size)",
    ]


def test_screen_and_paper_have_the_same_limits() -> None:
    """Have the same limits in typical sizes as points of the chart and of the still picture, on logarithmic axes."""
    made = picture_of(LIMITS)
    assert made is not None
    assert made.chart is not None
    assert made.chart.log_x
    axes = drawn(LIMITS).axes[0]
    assert axes.get_xscale() == "log"
    assert "[1]" in axes.get_xlabel()
    for trace, still, shares in zip(
        made.chart.panels[0].traces, axes.lines, ([2.0, 10.0], [0.25, 0.5, 0.5, 4.0]), strict=False
    ):
        assert list(trace.x) == list(still.get_xdata()) == shares
    assert made.chart.panels[0].traces[0].notes[0] == "angle lag 4.00 s"


def test_there_is_no_picture_of_nothing() -> None:
    """Draw nothing where no size of any effect shows."""
    assert picture_of(LIMITS[:1]) is None


def test_an_effect_that_grows_as_its_parameter_falls_is_told_so() -> None:
    """Ask for a smaller friction, not for a larger one, where the ball slips only at less than the typical value."""
    made = picture_of(LIMITS)
    assert made is not None
    assert "times larger" not in made.caption
    assert (
        "The contact slip grows as its `size` falls: to the right of the line it shows only if that is as many times "
        "smaller than the typical one."
    ) in made.caption
    without = picture_of([one for one in LIMITS if not one.inverse])
    assert without is not None
    assert "grows as" not in without.caption
