"""Reports: one self-contained HTML file each, that opens offline and prints.

`render_page` makes a page of any `Section`s; `render_comparison` makes the one of `harness run` from a `Study`. A
section is one module with one template; the order of a report's sections stands in its registry.
"""

from harness.report.comparison import render_comparison
from harness.report.page import Badge, Section, render_page

__all__ = ["Badge", "Section", "render_comparison", "render_page"]
