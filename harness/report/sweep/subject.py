"""The data common to all sections of a sweep's report."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from harness.formatting import brief
from harness.sweeps.drawn_runs import DrawnRun
from harness.sweeps.plan import Plan
from harness.sweeps.results import Results


@dataclass(frozen=True)
class Subject:
    """A finished sweep.

    Attributes:
        plan: every run.
        results: of the rows.
        command: that repeats it; may be empty.
        runs: that are drawn one by one.
        good: number of runs that did not fail, of which these are some or all.
    """

    plan: Plan
    results: Results
    command: str
    runs: tuple[DrawnRun, ...] = ()
    good: int = 0

    @property
    def measured(self) -> str:
        """Adjective for the recordings: `measured`, `simulated` or `measured or simulated`."""
        if all(self.plan.simulated):
            return "simulated"
        return "measured or simulated" if any(self.plan.simulated) else "measured"

    @property
    def horizon(self) -> str:
        """How long the runs are, in words."""
        window = self.plan.spec.window
        return "one free run over each recording" if window is None else f"each run begins anew every {brief(window)} s"

    @property
    def subtitle(self) -> str:
        """Runs, failures, recordings, horizon."""
        count = len(self.plan.recordings)
        recordings = "one recording" if count == 1 else f"{count} recordings"
        failed = f", {self.results.failed} of them failed" if self.results.failed else ""
        return f"{self.results.runs} runs{failed}; {recordings}; {self.horizon}"

    def value(self, value: Any) -> str:
        """A factor's value in short."""
        if isinstance(value, bool | str):
            return str(value).lower() if isinstance(value, bool) else value
        return brief(float(value), 4)
