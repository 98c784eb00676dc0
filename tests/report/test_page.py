"""The page: what every report shares."""

import pytest
from markupsafe import Markup

from harness.report.page import Badge, Section, render_page, typeset
from harness.report.tables import Column, Row, Table

CHECKS = "comparison/checks.html"  # the plainest template: one table


def section(anchor: str, text: str = "cell") -> Section:
    """A section that holds one table."""
    return Section(
        anchor, "Title", "Short", CHECKS, {"table": Table("caption", [Column("head", "mm")], [Row((text,))])}
    )


def test_input_cannot_write_html():
    """Show markup from file names and cells as text."""
    page = render_page("<i>case</i>", [section("one", "<script>x</script>")], badges=[Badge("<b>")])
    assert "<script>x" not in page
    assert "<i>" not in page
    assert "&lt;script&gt;" in page


def test_anchors_must_differ():
    """Refuse two sections of one anchor: links would lead to the wrong one."""
    with pytest.raises(ValueError, match="share an anchor"):
        render_page("title", [section("one"), section("one")])


def test_symbols_are_typeset():
    """Set indices low and code in its type, and escape the rest."""
    assert typeset("E/u_val < 1, `harness run`") == "E/u<sub>val</sub> &lt; 1, <code>harness run</code>"
    assert typeset("a_file_val.csv") == "a_file_val.csv"
    assert typeset(Markup("<b>u_val</b>")) == "<b>u_val</b>"


def test_a_ragged_table_is_refused():
    """Refuse rows that do not fit the columns."""
    with pytest.raises(ValueError, match="2 cells in a table of 1 columns"):
        Table("caption", [Column("head")], [Row(("a", "b"))])
