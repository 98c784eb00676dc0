"""Tolerances: limits a user sets on sources, metrics and horizons, and whether a study keeps them.

`tolerances_for` finds the limits of a case, `check` holds a study to them, `render_table` shows the outcome; the pytest
plugin and `harness run --check` do the same through these.
"""

from harness.tolerances.check import Checked, check
from harness.tolerances.file import read_tolerances, tolerances_for
from harness.tolerances.limits import Limit, Tolerances
from harness.tolerances.table import render_table

__all__ = ["Checked", "Limit", "Tolerances", "check", "read_tolerances", "render_table", "tolerances_for"]
