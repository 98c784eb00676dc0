"""Interactive charts: lines and bands as data of the page, thinned without losing the extremes of any line.

A chart stands beside the still picture of the same data (`harness.report.plots.Picture`), which it replaces on screen
where scripts run. The script that draws it is `assets/chart.js`.
"""

import base64
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.motion import FloatArray
from harness.report.palette import Look

MAX_ROWS = 4000  # of a chart if it is not told otherwise; more are thinned
_SKIP = -np.inf  # in the page's data: this line has no sample here and passes over; NaN: it has a gap


@dataclass(frozen=True)
class Trace:
    """One line or cloud of dots.

    Attributes:
        key: what the switches of a page go by; traces of one key are switched together.
        look: label, colour, line style.
        x: abscissa, ascending, shape (n,); NaN in a gap between runs, where the one before it holds.
        y: ordinate, shape (n,); what is not finite is a gap.
        dots: whether samples are drawn as dots without a line.
        low: lower edge of a band whose upper edge is `y`, shape (n,); `None` for a line.
        notes: what each sample is, for readers, n texts: the samples are then marked as points, and the one nearest to
            the mouse is told. Their abscissas are finite and in any order; a line joins them in the order given. Empty
            for a line whose samples are nothing by themselves.
        spread: half-length of each point's error bar, shape (n,); NaN for none. `None` for points without. The bar is
            along the ordinate, or in a panel of rows along the abscissa.
    """

    key: str
    look: Look
    x: ArrayLike
    y: ArrayLike
    dots: bool = False
    low: ArrayLike | None = None
    notes: Sequence[str] = ()
    spread: ArrayLike | None = None

    @cached_property
    def order(self) -> NDArray[np.intp]:
        """Samples in the order of the abscissa, shape (n,)."""
        x = np.asarray(self.x, dtype=np.float64)
        return np.argsort(x, kind="stable") if self.notes else np.arange(len(x))

    @property
    def abscissa(self) -> FloatArray:
        """`x` in ascending order and without NaN, shape (n,)."""
        x = np.asarray(self.x, dtype=np.float64)[self.order]
        return x[np.maximum.accumulate(np.where(np.isnan(x), 0, np.arange(len(x))))]

    @property
    def columns(self) -> list[FloatArray]:
        """The ordinates in the same order: one; two of a band; with the half-lengths of error bars."""
        given = [one for one in (self.y, self.low, self.spread) if one is not None]
        return [np.asarray(one, dtype=np.float64)[self.order] for one in given]


@dataclass(frozen=True)
class Panel:
    """One pair of axes.

    Attributes:
        label, unit: of the ordinate.
        traces: drawn in this order.
        frame: limits that the ordinate never leaves; `None` for those of the data.
        log: whether the ordinate is logarithmic; what is not positive is left out.
        zero: whether the line at 0 is drawn; across rows whose abscissa is logarithmic that at 1.
        title: above the axes; may be empty.
        rows: names of rows, from top to bottom, where the ordinate is no quantity: row k is around −k. Label and unit
            are then those of no axis, and `zero` is across the rows.
        row_height: of each on screen [px].
    """

    label: str
    unit: str
    traces: Sequence[Trace]
    frame: tuple[float, float] | None = None
    log: bool = False
    zero: bool = False
    title: str = ""
    rows: Sequence[str] = ()
    row_height: int = 56


@dataclass(frozen=True)
class Mark:
    """An instant or a span of time that is marked in charts and in the replay.

    Attributes:
        kind: `failure`, `window`, `heldout`, `identify` or `left_out`: its colour.
        label: what it is, for readers.
        begin, end: in the recording's time [s]; equal for an instant.
    """

    kind: str
    label: str
    begin: float
    end: float


@dataclass(frozen=True)
class Chart:
    """Panels above each other on one abscissa.

    Attributes:
        anchor: unique on the page.
        panels: from top to bottom.
        x_label, x_unit: of the abscissa.
        clock: charts of the same clock are linked: they show the same span of time, and a replay of that clock moves
            their cursor. Empty for an abscissa that is no time.
        log_x: whether the abscissa is logarithmic.
        marks: instants and spans that are marked.
        most: rows; more are thinned.
    """

    anchor: str
    panels: Sequence[Panel]
    x_label: str = "time"
    x_unit: str = "s"
    clock: str = ""
    log_x: bool = False
    marks: Sequence[Mark] = field(default=())
    most: int = MAX_ROWS

    @cached_property
    def _table(self) -> tuple[FloatArray, list[list[FloatArray]], NDArray[np.intp]]:
        """Common abscissa, ordinates of each trace, and the rows that are kept."""
        traces = [trace for panel in self.panels for trace in panel.traces]
        x, columns = merged([(one.abscissa, one.columns) for one in traces])
        if self.pointed:  # every one of them can be asked for
            return x, columns, np.arange(len(x))
        return x, columns, thinned([column for each in columns for column in each], self.most)

    @property
    def pointed(self) -> bool:
        """Whether it has points that tell what they are; these are not thinned."""
        return any(trace.notes for panel in self.panels for trace in panel.traces)

    @property
    def samples(self) -> tuple[int, int]:
        """How many are drawn, and of how many."""
        x, _, kept = self._table
        return len(kept), len(x)

    def data(self) -> dict[str, Any]:
        """What the script draws, for `json.dumps`: numbers as base64 of little-endian floats."""
        x, columns, kept = self._table
        rows = len(x)
        packed = iter([[pack(column[kept]) for column in each] for each in columns])
        panels = []
        notes: dict[str, int] = {}  # each once: panels often draw the same samples
        for panel in self.panels:
            series = [_series(trace, next(packed), notes) for trace in panel.traces]
            panels.append(
                {
                    "label": panel.label, "unit": panel.unit, "title": panel.title, "log": panel.log,
                    "zero": panel.zero, "frame": panel.frame, "series": series, "names": list(panel.rows),
                    "tall": panel.row_height,
                }
            )  # fmt: skip
        return {
            "id": self.anchor, "label": self.x_label, "unit": self.x_unit, "clock": self.clock, "log": self.log_x,
            "x": pack(x[kept], "<f8"), "panels": panels, "rows": len(kept), "of": rows,
            "notes": list(notes),
            "marks": [vars(one) for one in self.marks],
        }  # fmt: skip


def thinning_note(charts: Sequence[Chart]) -> str:
    """A sentence for the common caption of charts if data of theirs are thinned, else empty."""
    counts = np.array([one.samples for one in charts])
    drawn, given = counts[counts[:, 0] < counts[:, 1]].sum(axis=0)
    if drawn == given:
        return ""
    return (
        f" Drawn are {drawn} of {given} samples: the smallest and the largest value of every line in each "
        "of many equal spans; values between them are interpolated."
    )


def _series(trace: Trace, values: Sequence[str], notes: dict[str, int]) -> dict[str, Any]:
    look, rest = trace.look, list(values)
    return {
        "key": trace.key, "label": look.label, "colour": look.colour, "dash": look.dash, "width": look.width,
        "dots": trace.dots, "values": rest.pop(0), "low": rest.pop(0) if trace.low is not None else None,
        "spread": rest.pop(0) if trace.spread is not None else None,
        "notes": [notes.setdefault(trace.notes[at], len(notes)) for at in trace.order] if trace.notes else [],
        "order": np.argsort(trace.order).tolist() if trace.notes else [],
    }  # fmt: skip


def pack(values: ArrayLike, kind: str = "<f4") -> str:
    """Numbers as base64 of little-endian floats, by default of four bytes."""
    with np.errstate(over="ignore"):
        packed = np.asarray(values).astype(kind)
    return base64.b64encode(packed.tobytes()).decode("ascii")


def merged(traces: Sequence[tuple[FloatArray, list[FloatArray]]]) -> tuple[FloatArray, list[list[FloatArray]]]:
    """Traces with abscissas of their own on the union of these.

    A stamp that occurs several times within a trace, as between two windows, stays as often and in the same order.

    Args:
        traces: ascending abscissa, shape (n,), and ordinates, shape (n,) each.

    Returns:
        the union, shape (m,), and the ordinates on it, shape (m,) each: −∞ where a trace has no sample, NaN where it
        has a gap.
    """
    keys = []
    for x, _ in traces:
        fresh = np.concatenate(([True], x[1:] != x[:-1])) if len(x) else np.zeros(0, dtype=np.bool_)
        at = np.arange(len(x))
        keys.append(np.column_stack((x, at - np.maximum.accumulate(np.where(fresh, at, 0)))))
    union, rows = np.unique(np.concatenate(keys), axis=0, return_inverse=True)
    begins = np.cumsum([0, *(len(x) for x, _ in traces)])
    columns = []
    for begin, (x, ordinates) in zip(begins, traces, strict=False):
        own = rows.ravel()[begin : begin + len(x)]
        each = []
        for values in ordinates:
            column = np.full(len(union), _SKIP)
            column[own] = np.where(np.isfinite(values), values, np.nan)
            each.append(column)
        columns.append(each)
    return np.asarray(union[:, 0], dtype=np.float64), columns


def thinned(columns: Sequence[FloatArray], most: int) -> NDArray[np.intp]:
    """Rows to keep of columns that are too long: in each of many equal spans the extremes of every column.

    The edges of gaps and the first and the last row are kept. As many spans are taken as `most` rows allow.

    Args:
        columns: shape (n,) each, NaN at gaps, −∞ without a sample.
        most: rows.

    Returns:
        ascending row numbers.
    """
    rows = len(columns[0])
    if rows <= most:
        return np.arange(rows)
    always = np.unique(np.concatenate([np.array([0, rows - 1]), *map(_gap_edges, columns)]))
    if len(always) > most // 2:  # so many gaps that nothing else would be left
        always = np.array([0, rows - 1])
    few, many = 1, most
    while few < many:  # the most spans whose rows still fit
        spans = (few + many + 1) // 2
        if len(_extremes(columns, always, spans)) <= most:
            few = spans
        else:
            many = spans - 1
    return _extremes(columns, always, few)


def _gap_edges(column: FloatArray) -> NDArray[np.intp]:
    """Rows on both sides of where a gap begins or ends."""
    present = np.flatnonzero(column != _SKIP)
    change = np.flatnonzero(np.diff(np.isnan(column[present])))
    return np.concatenate((present[change], present[change + 1]))


def _extremes(columns: Sequence[FloatArray], always: NDArray[np.intp], spans: int) -> NDArray[np.intp]:
    begins = np.unique(np.linspace(0, len(columns[0]), spans + 1).astype(np.intp)[:-1])
    span = np.searchsorted(begins, np.arange(len(columns[0])), side="right")
    found = [always]
    for column in columns:
        known = np.flatnonzero(np.isfinite(column))
        order = known[np.lexsort((column[known], span[known]))]
        edge = np.flatnonzero(np.diff(span[order]))
        found += [order[np.concatenate(([0], edge + 1))], order[np.append(edge, len(order) - 1)]] if len(order) else []
    return np.unique(np.concatenate(found))
