"""Charts as data of the page: common abscissa, gaps, thinning."""

import base64

import numpy as np

from harness.report.chart import MAX_ROWS, Chart, Panel, Trace, merged, thinned, thinning_note
from harness.report.palette import Look

LOOK = Look("line", "#000000")


def test_abscissas_are_united():
    """Give every trace a row for each stamp of any, without a sample where it has none."""
    x, ((one,), (two,)) = merged([(np.array([0.0, 2.0]), [np.array([1.0, 3.0])]), (np.array([1.0]), [np.array([5.0])])])
    np.testing.assert_array_equal(x, [0, 1, 2])
    np.testing.assert_array_equal(one, [1, -np.inf, 3])
    np.testing.assert_array_equal(two, [-np.inf, 5, -np.inf])


def test_adjoining_windows_stay_apart():
    """Keep the end of a window, the gap and the start of the next one at their common stamp, in this order."""
    trace = Trace("cam", LOOK, [0.0, 1.0, np.nan, 1.0, 2.0], [0.0, 1.0, np.nan, 5.0, 6.0])
    x, ((values,), _) = merged([(trace.abscissa, trace.columns), (np.arange(3.0), [np.zeros(3)])])
    np.testing.assert_array_equal(x, [0, 1, 1, 1, 2])
    np.testing.assert_array_equal(values, [0, 1, np.nan, 5, 6])


def test_infinity_is_a_gap():
    """Draw nothing where a source ran away to infinity."""
    _, ((values,),) = merged([(np.arange(3.0), [np.array([0.0, np.inf, -np.inf])])])
    np.testing.assert_array_equal(values, [0, np.nan, np.nan])


def test_thinning_keeps_extremes_and_gaps():
    """Keep single spikes of every column and the edges of gaps when long data are thinned."""
    rng = np.random.default_rng(0)
    columns = [rng.normal(size=50_000) for _ in range(3)]
    columns[1][12_345], columns[2][40_000] = 99.0, -99.0
    columns[0][20_000:21_000] = np.nan
    kept = thinned(columns, MAX_ROWS)
    assert len(kept) <= MAX_ROWS
    assert len(kept) > 0.9 * MAX_ROWS
    assert {0, 12_345, 19_999, 20_000, 20_999, 21_000, 40_000, 49_999} <= set(kept.tolist())


def test_thinning_is_told():
    """Say in the caption how many samples are drawn, and nothing where all are."""
    for samples, told in ((100, False), (10_000, True)):
        trace = Trace("a", LOOK, np.arange(samples), np.sin(np.arange(samples)))
        chart = Chart("a", [Panel("y", "m", [trace])])
        assert ("of 10000 samples" in thinning_note([chart])) is told
        assert ("of 20000 samples" in thinning_note([chart, chart])) is told


def test_points_keep_what_they_are():
    """Sort points by their abscissa with their notes and bars; tell the order in which a line joins them."""
    trace = Trace("a", LOOK, [3.0, 1.0, 2.0], [30.0, 10.0, 20.0], notes=["c", "a", "b"], spread=[0.3, np.nan, 0.2])
    chart = Chart("a", [Panel("y", "m", [trace, Trace("b", LOOK, [0.5, 2.5], [5.0, 25.0])])])
    data = chart.data()
    (first, _) = data["panels"][0]["series"]
    assert [data["notes"][at] for at in first["notes"]] == ["a", "b", "c"]
    assert first["order"] == [2, 0, 1]  # the line begins at the third point from the left
    for name, expected in (
        ("values", [-np.inf, 10, 20, -np.inf, 30]),
        ("spread", [-np.inf, np.nan, 0.2, -np.inf, 0.3]),
    ):
        packed = np.frombuffer(base64.b64decode(first[name]), "<f4")
        np.testing.assert_array_equal(packed, np.array(expected, "<f4"))


def test_points_are_not_thinned():
    """Keep every point of a chart of points, however many."""
    rows = MAX_ROWS + 1
    trace = Trace("a", LOOK, np.arange(rows), np.arange(rows), notes=["same"] * rows)
    chart = Chart("a", [Panel("y", "m", [trace])])
    assert chart.data()["rows"] == rows
    assert thinning_note([chart]) == ""
