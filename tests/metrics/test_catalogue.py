"""The catalogue and the record agree, and a user finds a metric by the name that comes to mind."""

from dataclasses import fields

import pytest

from harness.errors import InputError
from harness.metrics import METRICS, Better, Score, find_metric

UNIT_SUFFIX = {"m": "_m", "mm": "_mm", "m s": "_m_s", "m/s": "_m_s", "ms": "_ms", "%": "_percent", "1": ""}


def test_every_column_is_described():
    """Describe every column that is not a label or a count."""
    labels = {"source", "horizon", "windows", "samples", "duration_s", "iso18571_rank", "tolerance_m"}
    assert {field.name for field in fields(Score)} - labels == set(METRICS)


@pytest.mark.parametrize("metric", METRICS.values(), ids=METRICS)
def test_names_carry_their_unit(metric):
    """End a column's name in its unit, and describe it."""
    assert metric.name.endswith(UNIT_SUFFIX[metric.unit])
    assert metric.description


def test_no_alias_means_two_things():
    """Give every name and alias to one metric only, upper and lower case being the same."""
    names = [key.lower() for metric in METRICS.values() for key in (metric.name, *metric.aliases)]
    assert len(names) == len(set(names))


@pytest.mark.parametrize(
    ("typed", "name"),
    [
        ("rms", "rms_error_mm"),
        ("E_disp", "e_disp_m_s"),
        ("e_vel", "e_vel_m"),
        ("M", "sprague_geers_magnitude"),
        ("iso18571", "iso18571_rating"),
        (" Lag ", "lag_ms"),
        ("fit_percent", "fit_percent"),
    ],
)
def test_short_names_are_understood(typed, name):
    """Accept what a user would type."""
    assert find_metric(typed).name == name


def test_misspelt_metric_gets_a_hint():
    """Name the nearest metric, or all of them."""
    with pytest.raises(InputError, match=r"'rms_eror'. Did you mean 'rms_error_mm'"):
        find_metric("rms_eror")
    with pytest.raises(InputError, match=r"Known are max_error_m, "):
        find_metric("zzzzzz")


@pytest.mark.parametrize(
    ("name", "good", "bad", "limit"),
    [("rms_error_mm", 4.9, 5.1, 5.0), ("fit_percent", 91.0, 89.0, 90.0), ("lag_ms", -9.0, -11.0, 10.0)],
)
def test_limits_are_read_in_the_direction_of_the_metric(name, good, bad, limit):
    """Read a limit as at most, at least, or at most in magnitude; not a number never meets it."""
    metric = METRICS[name]
    assert metric.meets(good, limit)
    assert not metric.meets(bad, limit)
    assert not metric.meets(float("nan"), limit)


def test_directions():
    """Want larger fits, ratings and shares within, lags and magnitudes near zero, and everything else small."""
    larger = {name for name, metric in METRICS.items() if metric.better is Better.LARGER}
    near_zero = {name for name, metric in METRICS.items() if metric.better is Better.NEAR_ZERO}
    assert larger == {"fit_percent", "fraction_within_uncertainty"} | {n for n in METRICS if n.startswith("iso18571_")}
    assert near_zero == {"lag_ms", "sprague_geers_magnitude"}
