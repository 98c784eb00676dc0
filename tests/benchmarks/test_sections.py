"""Sections of a page that several commands write."""

from __future__ import annotations

from benchmarks.sections import marks, put


def test_only_its_own_section_is_written() -> None:
    """Leave what others wrote into the page, and replace what was there before."""
    begin, end = marks("one")
    page = put("one", "first", "# Page\n\nabove\n", title="Page")
    assert page == f"# Page\n\nabove\n\n{begin}\nfirst\n{end}\n"
    again = put("one", "second", page + "\nbelow\n", title="Page")
    assert again == f"# Page\n\nabove\n\n{begin}\nsecond\n{end}\nbelow\n"


def test_a_page_is_begun_by_whoever_comes_first() -> None:
    """Write the title above the first section of an empty page."""
    assert put("one", "text", "", title="Page").startswith("# Page\n\n" + marks("one")[0])
