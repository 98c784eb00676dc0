"""Tables of what the recordings can show: detection limits, and effects that look alike."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.figure import Figure

from harness.formatting import fixed, number
from harness.identify.design.detection import ALIKE, Detection, Limit
from harness.report.check.content import Content, Subject
from harness.report.page import Section
from harness.report.palette import INK
from harness.report.plots import drawing, plain_log, style
from harness.report.tables import Column, Row, Table, texts

_KINDS = (("as recorded", "o", "#D55E00"), ("once the rest is explained", "D", "#0072B2"))
BEYOND = "no size"
AS_RECORDED = "the expected gain reaches the threshold of the diagnosis, while the model lacks what it lacks now"
SEARCHED = (
    "Of effects with a place or a shape, a bump of the track most of all, the strength alone is counted, at a typical "
    "shape in the middle of the track: the search has to find these, too, so that such limits are lower bounds."
)
EXPLAINED = "the same once everything else that is missing has been found"


def section(subject: Subject) -> Section | None:
    """Detection limits; `None` where they were not computed."""
    found = subject.detection
    if found is None:
        return None
    text = (
        "The size at which an effect is expected to lower the BIC by what `harness diagnose` asks for: in simulated "
        "trials it was found in a third of the cases at this size, and nearly always at twice the size. Sizes are "
        "distances from the value at which the effect does nothing. The second number holds once all that the "
        "declared model lacks is explained: effects that act hide others until they are found."
    )
    alike = alike_table(found.limits)
    notes = [SEARCHED]
    notes += [hidden_text(found)] if found.hidden else []
    if found.used < len(subject.case.identify):
        notes.append(f"Computed from {found.used} of {len(subject.case.identify)} recordings: information adds up.")
    tables = (limits_table(found.limits), *([alike] if alike else []))
    content = Content(texts=(text,), tables=tables, notes=tuple(notes))
    return content.section("effects", "What these recordings can show", "Effects")


def hidden_text(found: Detection) -> str:
    """Which effects cannot show whatever their size, and why."""
    return (
        f"Not shown at any size: {', '.join(found.hidden)}. The estimates of what rig.toml leaves open take these in; "
        "state the quantities that it lacks."
    )


def limit_text(one: Limit, limit: float) -> str:
    """A limit in words: a number, `below` it for an effect of small values, or that no size shows."""
    if limit == 0.0 or math.isinf(limit):
        return BEYOND
    return f"below {number(limit)}" if one.inverse else number(limit)


def shown(one: Limit) -> str:
    """Whether the effect shows at its typical size: `yes`, `later` (once the rest is explained), or `no`."""
    if one.shows(one.limit):
        return "yes"
    return "later" if one.seen else "no"


def limits_table(limits: tuple[Limit, ...]) -> Table:
    """Every effect with its limits and typical size."""
    rows = [
        Row(
            (
                f"`{one.effect}`",
                one.parameter,
                limit_text(one, one.limit),
                limit_text(one, one.explained),
                number(one.typical),
                one.unit,
                shown(one),
            ),
            "" if one.seen else "failed",
        )
        for one in limits
    ]
    columns = [
        *texts("effect", "parameter"),
        Column("detection limit", hint=AS_RECORDED),
        Column("rest explained", hint=EXPLAINED),
        Column("typical size"),
        *texts("unit", "shows"),
    ]
    return Table(
        "Detection limits; shows at its typical size: yes, later (once the rest is explained), no", columns, rows
    )


@style()
def drawn(limits: tuple[Limit, ...]) -> Figure:
    """Detection limits in typical sizes of their effects, on a logarithmic axis; what is left of 1 shows."""
    told = [(one.effect, [_share(one, limit) for limit in (one.limit, one.explained)]) for one in limits]
    told.sort(key=lambda each: min(each[1]))
    figure = drawing(0.9 + 0.19 * len(told))
    axes = figure.add_subplot()
    shares = np.array([values for _, values in told]).reshape(-1, 2)
    for column, (label, marker, colour) in enumerate(_KINDS):
        finite = np.isfinite(shares[:, column])
        axes.plot(shares[finite, column], np.flatnonzero(finite), marker, color=colour, markersize=5, label=label)
    axes.axvline(1.0, color=INK, linewidth=1.0)
    plain_log(axes, "x")
    axes.set_yticks(range(len(told)), [name.replace("_", " ") for name, _ in told])
    axes.set_xlabel("detection limit in typical sizes of the effect [1]; to the left of 1 it shows")
    figure.legend(loc="outside upper left", ncols=2)
    return figure


def _share(one: Limit, limit: float) -> float:
    """A limit over the typical size, the other way round for an effect of small values; infinite for no size."""
    if limit == 0.0 or math.isinf(limit):
        return math.inf
    return one.typical / limit if one.inverse else limit / one.typical


def alike_table(limits: tuple[Limit, ...]) -> Table | None:
    """Effects whose signatures correlate; `None` without any."""
    rows = [
        (
            f"`{one.effect}`",
            ", ".join(f"{name} ({fixed(value, 3)})" for name, value in one.alike),
            "not at any size" if math.isinf(one.apart) or one.apart == 0.0 else limit_text(one, one.apart),
            one.unit,
        )
        for one in limits
        if one.alike
    ]
    if not rows:
        return None
    columns = [*texts("effect", "looks like (correlation)"), "told apart from", *texts("unit")]
    return Table(f"Effects that look alike (correlation of their signatures above {ALIKE:g})", columns, rows)
