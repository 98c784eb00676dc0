"""Prints the outcome of checks as a plain-text table."""

from __future__ import annotations

from collections.abc import Sequence

from harness.tolerances.check import Checked, percent

_HEAD = ("", "limit", "value", "margin")


def render_table(checks: Sequence[Checked]) -> str:
    """One line per limit with value and margin, then failures in words and the number of violated limits."""
    rows = [_HEAD, *(_row(one) for one in checks)]
    width = [max(len(row[i]) for row in rows) for i in range(len(_HEAD))]
    lines = [
        f"{row[0]:<{width[0]}}  {row[1]:<{width[1]}}  {row[2]:>{width[2]}}  {row[3]:>{width[3]}}".rstrip()
        for row in rows
    ]
    broken = [one for one in checks if not one.passed]
    verdict = f"{len(broken) or len(checks)} of {len(checks)} limits {'broken' if broken else 'kept'}"
    failures = dict.fromkeys(one.failure for one in checks if one.failure)
    return "\n".join([*lines, *failures, verdict])


def _row(one: Checked) -> tuple[str, str, str, str]:
    unit = "" if one.unit == "1" else f" {one.unit}"
    value = "none" if one.failure else f"{one.value:.4g}{unit}"
    return "kept" if one.passed else "BROKEN", one.name, value, percent(one.margin)
