"""Results as a notebook shows them: a result in short and one picture of it, as HTML that loads nothing."""

from __future__ import annotations

import base64
import inspect
import io
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

from harness.failures import Failed, Part, caught
from harness.report.page import environment
from harness.report.plots import style

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from harness.report.tables import Summary

_RESOLUTION = 100  # [dots/in]; at the figures' 9 in, 900 dots
_WIDTH = 760  # at which it is shown [px]; narrower where the notebook is


@dataclass(frozen=True)
class _Image:
    """A figure as part of the page: its data URL, what it shows, and the width at which it is shown [px]."""

    source: str
    caption: str
    width: int = _WIDTH


def notebook_html(summary: Summary, plot: Callable[[], Figure] | None = None) -> str:
    """The HTML of a result: title, sentences, picture, tables.

    Args:
        summary: of the result; all of its texts are escaped.
        plot: draws the picture, which the first line of its docstring describes; `None` for no picture. If it raises,
            the message takes the picture's place: sentences and numbers are worth showing without it.
    """
    drawn = None if plot is None else caught(Part.REPORT, "picture", partial(_image, plot))
    failed = isinstance(drawn, Failed)
    return (
        environment()
        .get_template("summary.html")
        .render(
            title=summary.title,
            lines=[*summary.lines, str(drawn)] if failed else summary.lines,
            image=None if failed else drawn,
            tables=summary.tables,
        )
    )


@style()
def _image(plot: Callable[[], Figure]) -> _Image:
    buffer = io.BytesIO()
    plot().savefig(buffer, format="png", dpi=_RESOLUTION, metadata={"Software": None})
    source = "data:image/png;base64," + base64.b64encode(buffer.getvalue()).decode("ascii")
    return _Image(source, (inspect.getdoc(plot) or "").partition("\n")[0])
