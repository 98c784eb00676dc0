"""Dates and clock times in the ways of loggers and spreadsheets."""

from __future__ import annotations

from datetime import datetime, timedelta

import numpy as np
import pytest

from harness.importing.stamps import is_stamp, seconds

STEPS = 0.25 * np.arange(40)
MIDNIGHT = datetime(2024, 3, 5, 23, 59, 55)
NOON = datetime(2024, 3, 5, 11, 59, 55)


def written(form: str, begin: datetime) -> list[str]:
    """Stamps of 10 s."""
    return [(begin + timedelta(seconds=float(step))).strftime(form) for step in STEPS]


@pytest.mark.parametrize(
    "form",
    [
        "%Y-%m-%d %H:%M:%S.%f",
        "%Y-%m-%dT%H:%M:%S.%fZ",
        "%Y-%m-%d %H:%M:%S.%f+01:00",
        "%Y/%m/%d %H:%M:%S.%f",
        "%d.%m.%Y %H:%M:%S,%f",
        "%d.%m.%y %H:%M:%S,%f",
        "%d/%m/%Y %H:%M:%S.%f",
        "%m/%d/%Y %H:%M:%S.%f",
        "%m/%d/%Y %I:%M:%S.%f %p",
        "%I:%M:%S.%f %p",
        "%H:%M:%S.%f",
        "%M:%S.%f",
    ],
)
@pytest.mark.parametrize("begin", [MIDNIGHT, NOON])
def test_stamps_count_from_the_first(form: str, begin: datetime) -> None:
    """Read every form, also over midnight and noon, whichever of day and month comes first."""
    if form == "%M:%S.%f":
        begin = begin.replace(minute=3)
    np.testing.assert_allclose(seconds(written(form, begin)), STEPS, atol=1e-6)


def test_milliseconds_behind_a_colon() -> None:
    """Read them with and without leading zeros, and no frames of a video."""
    whole = [f"00:00:{int(step):02d}:{round(1000 * (step % 1)):03d}" for step in STEPS]
    bare = [f"00:00:{int(step):02d}:{round(1000 * (step % 1))}" for step in STEPS]
    np.testing.assert_allclose(seconds(whole), STEPS, atol=1e-9)
    np.testing.assert_allclose(seconds(bare), STEPS, atol=1e-9)
    assert seconds(["00:00:01:12", "00:00:01:24"]) is None


def test_two_numbers_are_minutes_and_seconds() -> None:
    """Read no hours where a clock has two numbers, but behind a date."""
    np.testing.assert_array_equal(seconds(["59:58", "59:59", "60:00"]), [0.0, 1.0, 2.0])
    np.testing.assert_array_equal(seconds(["2024-03-05 10:58", "2024-03-05 11:00"]), [0.0, 120.0])


def test_blank_stamps_are_not_known() -> None:
    """Leave a blank where no stamp is."""
    np.testing.assert_array_equal(seconds(["10:00:00", "", "10:00:02"]), [0.0, np.nan, 2.0])


@pytest.mark.parametrize("cell", ["12:60:00", "1:2", "ratio 1:20", "2024-03-05", "12"])
def test_what_is_no_stamp(cell: str) -> None:
    """Take nothing else for one."""
    assert not is_stamp(cell)


def test_dates_that_do_not_exist() -> None:
    """Tell nothing from the 30th of February."""
    assert seconds(["2024-02-30 10:00:00", "2024-02-30 10:00:01"]) is None
