"""Style sheets and scripts that are written into every report: our own, and the plotting library uPlot beside them."""

from functools import cache
from importlib.resources import files

LIBRARY = "uplot/uPlot.iife.min.js"
LIBRARY_STYLE = "uplot/uPlot.min.css"
LICENCE = "uplot/LICENSE"
_FIRST = ("data.js", "clock.js", "theme.js")
_CHARTS = ("axes.js", "points.js", "rows.js", "chart.js", "replay.js")


@cache
def text(name: str) -> str:
    """An asset's text, by its path in this folder."""
    return (files(__name__) / name).read_text(encoding="utf-8")


def style_sheet() -> str:
    """All style of a page."""
    own = (files("harness.report") / "style.css").read_text(encoding="utf-8")
    return "\n".join((own, text(LIBRARY_STYLE), text("live.css")))


def scripts(*, charts: bool) -> str:
    """All scripts of a page; without `charts` only the switch between light and dark."""
    names = (*_FIRST, *_CHARTS) if charts else _FIRST
    library = (f"/*\n{text(LICENCE)}*/\n", text(LIBRARY)) if charts else ()
    return "\n".join((*library, *map(text, names)))
