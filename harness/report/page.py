"""A report's page: sections in order, a table of contents, the style, and nothing that has to be loaded."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from importlib.resources import files

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup, escape

from harness.formatting import brief, fixed, length, number, percent


@dataclass(frozen=True)
class Section:
    """One part of a report.

    Attributes:
        anchor: its id on the page.
        title: its heading.
        short: its name in the table of contents.
        template: below templates/.
        context: what the template needs.
    """

    anchor: str
    title: str
    short: str
    template: str
    context: Mapping[str, object] = field(default_factory=dict)


@dataclass(frozen=True)
class Badge:
    """A word beside the page's title that must not be overlooked; `kind` is `warning`, `bad`, `good` or `plain`."""

    text: str
    kind: str = "plain"


_MARKS = re.compile(r"`([^`]+)`|\b(u|f|v|E|e|F)_(val|b|t|disp|vel|s|v|f)\b")


def typeset(text: str | Markup) -> Markup:
    """Plain text as HTML: `…` becomes code, u_val, f_b, E_disp … get their index below. Markup stays as it is."""
    if isinstance(text, Markup):
        return text

    def mark(found: re.Match[str]) -> str:
        if found[1] is not None:
            return f"<code>{found[1]}</code>"
        return f"{found[2]}<sub>{found[3]}</sub>"

    return Markup(_MARKS.sub(mark, str(escape(text))))


@lru_cache
def environment() -> Environment:
    """The templates; an undefined name in one of them is an error."""
    made = Environment(
        loader=PackageLoader("harness.report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    made.filters |= {
        "typeset": typeset,
        "brief": brief,
        "number": number,
        "fixed": fixed,
        "metres": length,
        "percent": percent,
    }
    made.filters["sentence"] = lambda text: text[:1].upper() + text[1:]
    return made


def render_page(
    title: str, sections: Sequence[Section], *, subtitle: str = "", badges: Sequence[Badge] = (), language: str = "en"
) -> str:
    """The HTML text of a page.

    Args:
        title: of the page and its first heading.
        sections: in the order of the page; anchors must differ.
        subtitle: one line below the heading.
        badges: beside the heading.
        language: of the texts.

    Raises:
        ValueError: two sections share an anchor.
    """
    anchors = [section.anchor for section in sections]
    if len(set(anchors)) < len(anchors):
        raise ValueError(f"two sections share an anchor: {', '.join(anchors)}")
    made = environment()
    bodies = [Markup(made.get_template(section.template).render(section.context)) for section in sections]
    return made.get_template("page.html").render(
        title=title,
        subtitle=subtitle,
        badges=badges,
        language=language,
        style=Markup((files("harness.report") / "style.css").read_text(encoding="utf-8")),
        parts=list(zip(sections, bodies, strict=True)),
    )
