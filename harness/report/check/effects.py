"""What the recordings can show: detection limits as a picture and a table, and effects that look alike."""

from __future__ import annotations

import math

from harness.formatting import fixed, number
from harness.identify.design.detection import ALIKE, Detection, Limit
from harness.report.check.content import Content, Subject
from harness.report.check.limits import inverse_text, picture_of
from harness.report.check.wording import AS_RECORDED, EXPLAINED, limit_text
from harness.report.page import Section
from harness.report.tables import Column, Row, Table, texts

_LARGEST = "its limit is the largest value that shows, and twice the size is half the value"
SEARCHED = (
    "Of effects with a place or a shape, a bump of the track most of all, the strength alone is counted, at a typical "
    "shape in the middle of the track: the search has to find these, too, so that such limits are lower bounds."
)


def section(subject: Subject) -> Section | None:
    """Detection limits; `None` where they were not computed."""
    found = subject.detection
    if found is None:
        return None
    text = (
        "The size at which an effect is expected to lower the BIC by what `harness diagnose` asks for: in simulated "
        "trials it was found in a third of the cases at this size, and nearly always at twice the size. Sizes are "
        f"distances from the value at which the effect does nothing. {inverse_text(found.limits, _LARGEST)}"
        "The second number holds once all that the declared model lacks is explained: effects that act hide others "
        "until they are found."
    )
    alike = alike_table(found.limits)
    notes = [SEARCHED]
    notes += [hidden_text(found)] if found.hidden else []
    if found.used < len(subject.case.identify):
        notes.append(f"Computed from {found.used} of {len(subject.case.identify)} recordings: information adds up.")
    tables = (limits_table(found.limits), *([alike] if alike else []))
    made = picture_of(found.limits)
    content = Content(texts=(text,), pictures=() if made is None else (made,), tables=tables, notes=tuple(notes))
    return content.section("effects", "What these recordings can show", "Effects")


def hidden_text(found: Detection) -> str:
    """Which effects cannot show whatever their size, and why."""
    return (
        f"Not shown at any size: {', '.join(found.hidden)}. The estimates of what rig.toml leaves open take these in; "
        "state the quantities that it lacks."
    )


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
