"""Numbers as they are printed."""

import math

import pytest

from harness.formatting import aligned, brief, fixed, length, measured, number, percent, plus_minus


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (math.nan, "—"),
        (math.inf, "∞"),
        (-math.inf, "−∞"),
        (0.0, "0"),
        (1992.4, "1992"),
        (12345.6, "12\u202f346"),
        (-0.16, "−0.160"),
        (9.996, "10.0"),
        (4.948e-6, "4.95·10⁻⁶"),
    ],
)
def test_three_digits(value, text):
    """Print three digits, a true minus sign, and signs for what is not a number."""
    assert number(value) == text


def test_no_negative_zero():
    """Print what rounds to zero without a sign."""
    assert fixed(-0.0004, 2) == "0.00"


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (1.858, "1.86 m"),
        (0.0181, "18.1 mm"),
        (17e-6, "17.0 µm"),
        (3e-13, "< 1 nm"),
        (0.0, "0 m"),
        (math.nan, "—"),
        (math.inf, "∞ m"),
    ],
)
def test_lengths_choose_their_unit(value, text):
    """Print a length in the unit that leaves one to three digits before the point."""
    assert length(value) == text


def test_deviation_sets_the_decimals():
    """Print a deviation with two digits and the value with as many decimals."""
    assert plus_minus(37.853, 8.123) == "37.9 ± 8.1"
    assert plus_minus(0.1234567, 0.00045) == "0.12346 ± 0.00045"


@pytest.mark.parametrize(
    ("value", "reach", "text"),
    [
        (0.0041234, 0.000234, "0.00412 ± 0.00023"),
        (0.0041234, 0.000361, "0.0041 ± 0.0004"),
        (0.0041234, 0.00098, "0.0041 ± 0.0010"),
        (12.0, 0.95, "12.0 ± 1.0"),
        (-0.14321, 0.0021, "−0.1432 ± 0.0021"),
        (1234.0, 87.0, "1230 ± 90"),
        (0.0, 0.002, "0.0000 ± 0.0020"),
        (37.85, math.nan, "37.9"),
        (37.85, 0.0, "37.9"),
    ],
)
def test_a_reach_keeps_one_or_two_digits(value, reach, text):
    """Cut value and reach at the same place: two digits of the reach up to 354, one up to 949, then two of 1000."""
    assert measured(value, reach) == text


def test_no_deviation_is_no_zero():
    """Print a value alone where its deviation is not known or not finite."""
    assert plus_minus(37.85, math.nan) == plus_minus(37.85, math.inf) == "37.9"


def test_columns_share_decimals():
    """Give all numbers of a column the same decimals and keep what is not a number."""
    assert aligned([7.95, 33.31, math.nan]) == ["7.95", "33.31", "—"]
    assert aligned([175.0, 1992.4]) == ["175", "1992"]


def test_round_figures_lose_their_zeros():
    """Print lengths of windows as a person writes them."""
    assert [brief(5.0), brief(0.5), brief(1000.0), brief(1e-6)] == ["5", "0.5", "1000", "1·10⁻⁶"]


def test_shares():
    """Print shares of one in percent."""
    assert [percent(0.95), percent(0.012), percent(math.nan)] == ["95 %", "1.2 %", "—"]
