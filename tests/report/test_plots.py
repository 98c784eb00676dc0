"""Pictures: what is drawn where lines leave the frame, and how bands are thinned."""

import itertools

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from harness.comparison.horizons import Horizon
from harness.report.labels import label_exits, label_points
from harness.report.palette import LOOKS, look_of
from harness.report.plots import binned, joined, left_out, mark_exits, middle, thinning


def exits(values):
    """When a line with `values` once a second leaves a frame from −1 to 1, and the triangles' times."""
    axes = Figure().add_subplot()
    axes.set_ylim(-1.0, 1.0)
    first = mark_exits(axes, np.arange(len(values), dtype=float), np.array(values, dtype=float), look_of("cam"))
    return first, sorted(float(time) for line in axes.lines for time in line.get_xdata())


def test_a_line_within_the_frame_gets_no_triangle():
    """Mark nothing where a source stays in sight."""
    assert exits([0.0, 0.5, 1.0, -1.0]) == (None, [])


def test_leaving_is_marked_once_with_its_time():
    """Mark where a source leaves, not every sample outside, and mark it again when it leaves again."""
    assert exits([0.0, 2.0, 3.0, 0.0, -2.0, -3.0]) == ((1.0, True), [1.0, 4.0])


def test_a_gap_outside_is_no_return():
    """Do not mark a source anew after stamps without a measurement."""
    assert exits([0.0, 2.0, np.nan, 2.0]) == ((1.0, True), [1.0])


def test_infinity_leaves_the_frame():
    """Mark a source that ran away to infinity."""
    assert exits([0.0, np.inf]) == ((1.0, True), [1.0])


def test_runs_are_joined_with_gaps():
    """Draw no line from the end of one run to the start of the next."""
    runs = Horizon(1.0, np.array([0, 2]), np.array([1, 3]))
    time, values = joined(np.arange(4.0), np.array([1.0, 2.0, 3.0, 4.0]), runs)
    np.testing.assert_array_equal(time, [0, 1, np.nan, 2, 3, np.nan])
    np.testing.assert_array_equal(values, [1, 2, np.nan, 3, 4, np.nan])


def test_lines_pass_over_spikes():
    """Connect the neighbours of a stamp that is not to be drawn."""
    keep = np.array([True, False, True])
    run = Horizon(None, np.array([0]), np.array([2]))
    time, values = joined(np.arange(3.0), np.array([1.0, np.nan, 2.0]), run, keep)
    np.testing.assert_array_equal(values, [1, 2, np.nan])
    np.testing.assert_array_equal(time, [0, 2, np.nan])


def test_long_records_are_thinned():
    """Draw no more points than can be seen, and all of a short record."""
    assert thinning(500) == 1
    assert 200_000 / thinning(200_000) <= 800


def test_bins_hold_equally_many_samples():
    """Average y over x in bins of equally many samples."""
    x = np.linspace(0.0, 1.0, 1200)
    centre, mean, error = binned(x, 3.0 * x)
    np.testing.assert_allclose(mean, 3.0 * centre)
    assert len(centre) == 12
    assert np.all(error < 0.01)


def test_looks_differ():
    """Give every source a colour of its own, known or not."""
    colours = [look.colour for look in LOOKS.values()]
    assert len(set(colours)) == len(colours)
    assert look_of("new_engine") == look_of("new_engine")
    assert look_of("new_engine").colour not in colours


def test_readings_that_are_left_out_are_drawn_apart():
    """Draw every such reading as a mark of its own, with a legend entry; draw nothing where there is none."""
    axes = Figure().add_subplot()
    assert left_out(axes, np.empty((0, 2))) == []
    assert not axes.lines
    readings = np.column_stack((np.arange(5.0), np.linspace(0.3, 0.4, 5)))
    (entry,) = left_out(axes, readings)
    assert entry.get_label() == "left out of all fits"
    np.testing.assert_array_equal(np.column_stack(axes.lines[0].get_data()), readings)


def test_a_law_beyond_its_range_spoils_no_frame():
    """Frame what is finite, where a path left the range in which a law has values."""
    values = np.array([np.inf, np.nan, *range(100), -np.inf])
    assert middle(values, 1.0) == pytest.approx([0.99, 98.01])
    assert np.array_equal(middle(np.full(3, np.nan), 1.0), [0.0, 0.0])


@pytest.mark.parametrize(
    ("exits", "labels"),
    [
        ([(5.9, False), (9.0, False)], 2),
        ([(6.9, True), (8.2, True), (8.3, True)], 2),  # the last two share one, which goes to the left
        ([(1.0, True), (2.0, True), (3.5, True), (8.0, True)], 4),
    ],
)
def test_labels_of_exits_do_not_meet(exits: list[tuple[float, bool]], labels: int) -> None:
    """Stack labels that would cover each other, whichever way they go."""
    figure = Figure(figsize=(7.0, 2.5))
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    axes.set(xlim=(0.0, 10.0), ylim=(-1.0, 1.0))
    label_exits(axes, exits)
    figure.canvas.draw()
    boxes = [one.get_window_extent() for one in axes.texts]
    assert len(boxes) == labels
    assert not any(one.overlaps(other) for one, other in itertools.combinations(boxes, 2))


def test_labels_of_points_in_a_row_can_be_read() -> None:
    """Write each beside its point, covering no other label, no point and not the legend."""
    figure = Figure(figsize=(4.5, 3.6), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    points = [(0.008 * 1.4**number, 0.066 + 1e-5 * number) for number in range(8)]
    axes.plot(*zip(*points, strict=True), "o", markersize=4, label="MuJoCo")
    axes.set(xscale="log", ylim=(0.0, 0.08))
    axes.legend(loc="upper right")
    label_points(axes, points, [f"{number}e-3" for number in range(8)], ["#000000"] * 8)
    figure.canvas.draw()
    boxes = [one.get_window_extent() for one in axes.texts]
    assert len(boxes) == 8
    assert not any(one.overlaps(other) for one, other in itertools.combinations(boxes, 2))
    for place in axes.transData.transform(points):
        assert not any(box.contains(*place) for box in boxes)
    assert not any(box.overlaps(axes.get_legend().get_window_extent()) for box in boxes)
