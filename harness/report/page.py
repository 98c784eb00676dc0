"""Renders a report page from sections, with table of contents and embedded style; no external resources."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from importlib.resources import files

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup, escape

from harness.formatting import length, number


@dataclass(frozen=True)
class Section:
    """One part of a report.

    Attributes:
        anchor: its id on the page.
        title: its heading.
        short: its name in the table of contents.
        template: path below templates/.
        context: variables of the template.
    """

    anchor: str
    title: str
    short: str
    template: str
    context: Mapping[str, object] = field(default_factory=dict)


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


def render_page(title: str, sections: Sequence[Section], *, subtitle: str = "", badges: Sequence[Badge] = ()) -> str:
    """The HTML text of a page.

    Args:
        title: of the page and its first heading.
        sections: in the order of the page, with unique anchors.
        subtitle: one line below the heading.
        badges: beside the heading.

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
        style=Markup((files("harness.report") / "style.css").read_text(encoding="utf-8")),
        parts=list(zip(sections, bodies, strict=True)),
    )
