"""The data common to all sections of a tuning's report."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from analytic.motion import FloatArray
from harness.recording import Case
from harness.report.palette import Look, label_of, look_of
from harness.tuning.cam import CamErrors
from harness.tuning.tune import Tuned


@dataclass(frozen=True)
class Subject:
    """A tuning with the data of its report.

    Attributes:
        tuned: the result.
        cam: CAM on the same blocks; `None` if it is not known.
        case: the input.
        settings: text of the settings file; empty if nothing was tuned.
        command: that repeats the tuning; empty if it is not known.
    """

    tuned: Tuned
    cam: CamErrors | None
    case: Case
    settings: str = ""
    command: str = ""

    @cached_property
    def runs(self) -> tuple[list[FloatArray], list[FloatArray]]:
        """Positions of the free runs before and after in every window, shape (m,) each [m]."""
        tuned, before, after = self.tuned, self.tuned.selection.before, self.tuned.selection.found
        old, new = tuned.model.runs(tuned.windows, [(before.values, before.starts), (after.values, after.starts)])
        return old, new

    @property
    def engine(self) -> str:
        """The engine's displayed name."""
        return label_of(self.tuned.model.engine.name)

    @property
    def scene_file(self) -> str:
        """File of the user's scene that the engine runs; empty for the built-in one."""
        return self.tuned.model.engine.scene_file or ""

    @property
    def look(self) -> Look:
        """The engine's colour and line style."""
        return look_of(self.tuned.model.engine.name)

    @property
    def measured(self) -> str:
        """Adjective for the recordings: `measured` or `simulated`."""
        return "simulated" if self.case.simulated else "measured"
