"""Of columns that are called alike, those that may be different quantities: no flags, and none twice in other units."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from analytic.motion import FloatArray
from harness.importing.signals import Group, Signal, is_known, unit_of
from harness.importing.words import UNITS, Role, factor_of

_FLAG = 2  # values: a column that takes no more says whether something is so, as `pos_valid` does
_ROUNDED = 2e-3  # of the RMS: columns that differ by less are rounded differently, and no different quantities


def distinct(role: Role, signals: Sequence[tuple[Group, Signal]]) -> list[tuple[Group, Signal]]:
    """Those of several columns called so that may be the quantity.

    One in pixels is left aside where one is in a unit of the quantity. Of columns with the same values in several
    units, or times from several zeros, one is kept: one that says its unit before one that does not, and times that
    begin near zero before those since 1970. Blank ones stay.
    """
    measured = [one for one in signals if not is_known(one[1]) or len(np.unique(known_values(one[1]))) > _FLAG]
    measured = measured or list(signals)
    if any(factor_of(role, unit_of(signal)[0]) for _, signal in measured):
        measured = [one for one in measured if not (unit := unit_of(one[1])[0]) or factor_of(role, unit)]
    kept: list[tuple[Group, Signal]] = []
    for one in sorted(measured, key=lambda one: _preference(role, one[1])):
        if not any(_same(role, one[1], other[1]) for other in kept):
            kept.append(one)
    return [one for one in signals if one in kept]


def known_values(signal: Signal) -> FloatArray:
    """The values that are known, shape (m,)."""
    return signal.values[np.isfinite(signal.values)]


def _preference(role: Role, signal: Signal) -> tuple[bool, float]:
    known = known_values(signal)
    begins = float(abs(known[0])) if role == "time" and len(known) else 0.0
    return not unit_of(signal)[0], begins


def _factors(role: Role, signal: Signal) -> set[float]:
    """Factors to SI that a signal's readings may have: that of its unit, or of all where it says none."""
    unit, _ = unit_of(signal)
    factor = factor_of(role, unit) if unit else None
    return set(UNITS[role].values()) if factor is None else {factor}


def _same(role: Role, one: Signal, other: Signal) -> bool:
    """Whether two columns hold the same values in the same or different units, times from any zero."""
    if one.values.shape != other.values.shape:
        return False
    both = np.isfinite(one.values) & np.isfinite(other.values)
    a, b = one.values[both], other.values[both]
    if role == "time":
        a, b = np.diff(a), np.diff(b)
    size, power = float(np.linalg.norm(a)), float(b @ b)
    if size == 0.0 or power == 0.0 or np.ptp(one.values[both]) == 0.0:
        return False
    gain = float(a @ b) / power
    by_units = any(
        abs(gain * of_a / of_b - 1.0) < _ROUNDED for of_a in _factors(role, one) for of_b in _factors(role, other)
    )
    return by_units and float(np.linalg.norm(a - gain * b)) < _ROUNDED * size
