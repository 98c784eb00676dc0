"""Renders a report page from sections, with table of contents and embedded style; no external resources."""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache, partial

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup, escape

from harness.failures import Failed, Failures, Part, caught
from harness.formatting import length, number
from harness.parallel import side_by_side
from harness.report.assets import scripts, style_sheet


@dataclass(frozen=True)
class Section:
    """One part of a report.

    Attributes:
        anchor: its id on the page.
        title: its heading.
        short: its name in the table of contents.
        template: path below templates/.
        context: variables of the template.
        on_screen: whether the section is left out on paper.
    """

    anchor: str
    title: str
    short: str
    template: str
    context: Mapping[str, object] = field(default_factory=dict)
    on_screen: bool = False


@dataclass(frozen=True)
class Badge:
    """A highlighted label beside the page's title; `kind` is `warning`, `bad`, `good` or `plain`."""

    text: str
    kind: str = "plain"


_MARKS = re.compile(r"`([^`]+)`|\b(u|f|v|E|e|F)_(val|b|t|disp|vel|s|v|f)\b")


def typeset(text: str | Markup) -> Markup:
    """Plain text as HTML: `…` becomes code, u_val, f_b, E_disp … get subscripts. Markup is unchanged."""
    if isinstance(text, Markup):
        return text

    def mark(found: re.Match[str]) -> str:
        return f"<code>{found[1]}</code>" if found[1] is not None else f"{found[2]}<sub>{found[3]}</sub>"

    return Markup(_MARKS.sub(mark, str(escape(text))))


def capitalised(text: str) -> str:
    """Text with a capital at its beginning."""
    return text[:1].upper() + text[1:]


@lru_cache
def environment() -> Environment:
    """The template environment; undefined names are errors."""
    made = Environment(
        loader=PackageLoader("harness.report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    made.filters |= {"typeset": typeset, "number": number, "metres": length, "sentence": capitalised}
    return made


@dataclass(frozen=True)
class Body:
    """A section with the HTML of its template."""

    section: Section
    html: Markup


def body_of(section: Section) -> Body:
    """Render the section's template."""
    return Body(section, Markup(environment().get_template(section.template).render(section.context)))


def failed_body(name: str, failed: Failed) -> Body:
    """In place of a section that raised: what it raised."""
    title = name.replace("_", " ").capitalize()
    section = Section(f"failed-{name}", title, f"{title}: failed", "")
    return Body(section, Markup('<div class="alert bad"><p>{}</p></div>').format(str(failed)))


def bodies_of(
    made: Mapping[str, Callable[[], Section | None]], failures: Failures | None = None, jobs: int = 1
) -> list[Body]:
    """The sections that apply, in order; one that raises says so in its place.

    Args:
        made: makes each section, by its name; `None` where it does not apply.
        failures: collects the sections that raise; `None` lets them raise.
        jobs: processes to draw in (`harness.parallel`).
    """

    def body(make: Callable[[], Section | None]) -> Body | None:
        section = make()
        return None if section is None else body_of(section)

    def guarded(name: str, make: Callable[[], Section | None]) -> Body | Failed | None:
        return body(make) if failures is None else caught(Part.REPORT, f"section {name}", partial(body, make))

    bodies = []
    drawn = side_by_side([partial(guarded, *each) for each in made.items()], jobs)
    for name, one in zip(made, drawn, strict=True):
        if isinstance(one, Failed):
            if failures is not None:
                failures.add(one)
            bodies.append(failed_body(name, one))
        elif one is not None:
            bodies.append(one)
    return bodies


def render_page(
    title: str,
    sections: Sequence[Section | Body],
    *,
    subtitle: str = "",
    badges: Sequence[Badge] = (),
    failures: Sequence[Failed] = (),
) -> str:
    """The HTML text of a page.

    Args:
        title: of the page and its first heading.
        sections: in the order of the page, with unique anchors.
        subtitle: one line below the heading.
        badges: beside the heading.
        failures: shown at the top.

    Raises:
        ValueError: two sections share an anchor.
    """
    bodies = [one if isinstance(one, Body) else body_of(one) for one in sections]
    anchors = [one.section.anchor for one in bodies]
    if len(set(anchors)) < len(anchors):
        raise ValueError(f"two sections share an anchor: {', '.join(anchors)}")
    return (
        environment()
        .get_template("page.html")
        .render(
            title=title,
            subtitle=subtitle,
            badges=badges,
            style=Markup(style_sheet()),
            scripts=Markup(scripts(charts=any("chart-data" in one.html for one in bodies))),
            failures=[str(one) for one in failures],
            parts=[(one.section, one.html) for one in bodies],
        )
    )
