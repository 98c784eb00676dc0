"""Tolerances: user-defined limits on metrics of sources and horizons, and their check.

`tolerances_for` finds the limits of a case, `check` compares a study with them, `render_table` prints the outcome. The
pytest plugin and `harness run --check` use these functions.
"""

from harness.tolerances.check import Checked, check, render_table
from harness.tolerances.file import read_tolerances, tolerances_for
from harness.tolerances.limits import Limit, Tolerances

__all__ = ["Checked", "Limit", "Tolerances", "check", "read_tolerances", "render_table", "tolerances_for"]
