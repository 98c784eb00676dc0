"""Sections of a page that several commands write, each between marks of its own."""

from __future__ import annotations


def marks(name: str) -> tuple[str, str]:
    """With which a section begins and ends; a reader of the page does not see them."""
    return f"<!-- {name}: begin -->", f"<!-- {name}: end -->"


def put(name: str, text: str, page: str, *, title: str) -> str:
    """The page with this section in the place of the one before, or at its end.

    Args:
        name: of the section.
        page: may be empty.
        title: of a page that is begun.
    """
    begin, end = marks(name)
    marked = f"{begin}\n{text}\n{end}\n"
    if begin in page and end in page:
        before, _, rest = page.partition(begin)
        return before + marked + rest.partition(end)[2].lstrip("\n")
    return (page.rstrip("\n") + "\n\n" if page else f"# {title}\n\n") + marked


def apart(name: str, page: str) -> str:
    """The page with an empty line between this section and a heading that follows it."""
    _, end = marks(name)
    return page.replace(f"{end}\n#", f"{end}\n\n#")
