"""Borrowed arrays: the same numbers, no references counted, nothing freed or kept that should not be."""

from __future__ import annotations

import sys
from typing import NamedTuple

import numba
import numpy as np
import pytest

from analytic.borrowed import borrowed
from analytic.motion import FloatArray


class _Table(NamedTuple):
    """Two arrays, as the filter takes them together."""

    steps: FloatArray
    rows: FloatArray


def _sum(table: _Table, p: FloatArray) -> float:
    table, p = borrowed(table), borrowed(p)
    total = 0.0
    for i in range(len(table.steps)):
        row = table.rows[i]
        total += table.steps[i] * (row[0] * p[0] + row[1] * p[1])
    return float(total)


TABLE, P = _Table(np.linspace(0.1, 0.4, 4), np.arange(8.0).reshape(4, 2)), np.array([2.0, -1.0])


def test_it_computes_the_same() -> None:
    """Give the same number in compiled code and in Python, from an array and a tuple of arrays."""
    assert numba.njit(_sum)(TABLE, P) == _sum(TABLE, P) == pytest.approx(float(TABLE.steps @ (TABLE.rows @ P)))


def test_it_names_no_owner() -> None:
    """Hand out the same memory without holding the array that owns it, as a plain view does."""
    before = sys.getrefcount(P)
    plain = numba.njit(lambda array: array[1:])(P)
    assert sys.getrefcount(P) > before
    del plain
    lent = numba.njit(lambda array: borrowed(array)[1:])(P)
    assert sys.getrefcount(P) == before
    assert np.shares_memory(lent, P)


def test_an_argument_is_neither_freed_nor_kept() -> None:
    """Leave as many references to the arguments as there were."""
    compiled = numba.njit(_sum)
    compiled(TABLE, P)
    before = [sys.getrefcount(one) for one in (*TABLE, P)]
    for _ in range(100):
        compiled(TABLE, P)
    assert [sys.getrefcount(one) for one in (*TABLE, P)] == before


@numba.njit(inline="never")
def _last_of(array: FloatArray) -> float:
    lent = borrowed(array)
    return float(lent[1:][-1])


@numba.njit
def _of_own_arrays(count: int) -> float:
    total = 0.0
    for i in range(count):
        own = np.full(8, float(i))
        total += _last_of(own) + own[0]
    return total


def test_an_array_of_the_caller_stays_whole() -> None:
    """Read an array that compiled code made, and lent, as it was made, after the loan too."""
    assert _of_own_arrays(1000) == 999.0 * 1000.0
