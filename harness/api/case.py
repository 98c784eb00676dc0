"""A case that shows itself: its recordings, what is known of the rig, findings."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from analytic.naming import did_you_mean
from harness.errors import InputError
from harness.formatting import number
from harness.recording import Case as CheckedCase
from harness.recording import case as cases
from harness.recording.known_rig import UNITS
from harness.report.tables import Summarised, Summary, Table, texts
from harness.threads import one_blas_thread

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Case(Summarised, CheckedCase):
    """A rig's recordings and what is known of it; attributes as of `harness.recording.Case`."""

    def summary(self) -> Summary:
        """Recordings, what is known, findings."""
        lines = [f"origin: {self.origin}"] if self.origin else []
        if self.declared:
            lines.append(f"declared effects: {', '.join(one.name for one in self.declared)}")
        tables = [self._recordings(), self._known()]
        if self.findings:
            rows = [(one.severity, one.where, one.text) for one in self.findings]
            tables.append(Table("Findings", texts("severity", "where", "finding"), rows))
        return Summary(f"Case {self.path}", lines, tables)

    def plot(self, recording: str | None = None) -> Figure:
        """Beam angle and ball position of a recording over time, with what is left out of all fits.

        Args:
            recording: which one; the first to identify from if none is named.

        Raises:
            InputError: the case has no such recording.
        """
        from harness.report.check.recordings import drawn

        name = self.identify[0] if recording is None else recording
        if name not in self.recordings:
            known = ", ".join(self.recordings)
            raise InputError(
                f"{self.path}: there is no recording {name!r}.{did_you_mean(name, self.recordings)} "
                f"Recordings are {known}."
            )
        figure = drawn(self.recordings[name])
        figure.axes[0].set_title(f"{name} (simulated)" if self.simulated else name)
        return figure

    def _recordings(self) -> Table:
        rows = []
        for name, one in self.recordings.items():
            use = " and ".join(use for use in ("identify", "predict") if name in getattr(self, use))
            length, rate = one.time[-1] - one.time[0], 1.0 / float(np.median(np.diff(one.time)))
            cells = (number(float(length)), str(len(one.time)), number(rate), str(int(one.known.sum())), use)
            rows.append((name, *cells))
        columns = [*texts("recording"), "length [s]", "samples", "rate [Hz]", "positions", *texts("used to")]
        return Table("Recordings", columns, rows)

    def _known(self) -> Table:
        rows = []
        for name, value in (*vars(self.rig).items(), *vars(self.sensors).items()):
            rows.append((name.replace("_", " "), "not known" if value is None else number(value, 4), UNITS[name]))
        return Table("What is known", [*texts("quantity"), "value", *texts("unit")], rows)


@one_blas_thread()
def load_case(path: str | Path = cases.BUNDLED) -> Case:
    """Read a case: a folder, its `rig.toml`, a single CSV recording of the paper's rig, or a built-in case.

    Args:
        path: of the case, or the name of a built-in one: `paper_protocol`, which is simulated and the default, or
            `open_ball_beam`, which was measured.

    Raises:
        InputError: anything in it cannot be used; nothing is returned in part.
    """
    return case_of(cases.load_case(path))


def case_of(given: CheckedCase | str | Path) -> Case:
    """A case that shows itself, of one that was read already or of a path."""
    if isinstance(given, Case):
        return given
    if isinstance(given, CheckedCase):
        return Case(**vars(given))
    return load_case(given)


def scene_files(case: CheckedCase) -> tuple[Path, ...]:
    """The files of the user's own scene, if the case has one."""
    return () if case.scene is None else case.scene.files


def input_files(case: CheckedCase) -> tuple[Path, ...]:
    """The files that a case was read from."""
    rig = case.path if case.path.name == cases.RIG_FILE else case.path / cases.RIG_FILE
    return (*(one.path for one in case.recordings.values()), *([rig] if case.sha256 else []), *scene_files(case))
