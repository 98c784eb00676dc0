"""When one source is better than another beyond what a recording leaves open."""

import numpy as np

from harness.report.standing import separated

RUNS, SAMPLES = 8, 200
GENERATOR = np.random.default_rng(3)
NOISE = GENERATOR.normal(0.0, 1e-3, (RUNS, SAMPLES))


def runs(offset: float, u_val: float = 1e-3):
    """Errors of a perfect source, of one that is `offset` off, and u_val [m]."""
    return list(NOISE), list(NOISE + offset), list(np.full((RUNS, SAMPLES), u_val))


def test_equal_errors_are_not_separated():
    """Two sources of the same errors are never told apart."""
    assert not separated(*runs(0.0))


def test_far_errors_are_separated():
    """A source off by ten times u_val is worse beyond doubt.

    Its mean square exceeds the best's by d² = 100 u²; inputs explain at most 2·2·d·u/√8 = 14 u² of that.
    """
    assert separated(*runs(1e-2))


def test_inputs_can_explain_a_difference():
    """The same difference says nothing where inputs leave as much open: d² < 4·d·u/√8 for u = d."""
    assert not separated(*runs(1e-2, u_val=1e-2))


def test_one_lucky_run_separates_nothing():
    """A difference that one of several runs makes alone is scatter, however small u_val is."""
    best, other, u_val = runs(0.0, u_val=1e-6)
    other[0] = other[0] + 1e-2
    assert not separated(best, other, u_val)


def test_a_run_away_is_separated():
    """A source that is not finite anywhere is worse beyond doubt."""
    best, other, u_val = runs(0.0)
    other[3] = np.full(SAMPLES, np.inf)
    assert separated(best, other, u_val)


def test_the_order_within_one_run_must_survive_any_shift():
    """A single run separates only what no error of 2 u_val in measurement and inputs can turn round: d > 4 u."""
    best, u_val = [np.zeros(SAMPLES)], [np.full(SAMPLES, 1e-3)]
    assert not separated(best, [np.full(SAMPLES, 3.9e-3)], u_val)
    assert separated(best, [np.full(SAMPLES, 4.1e-3)], u_val)
