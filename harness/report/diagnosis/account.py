"""What every section of the diagnosis report is made from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

from harness.comparison.setting import ball_of
from harness.formatting import brief
from harness.identify.diagnosis import Diagnosis
from harness.identify.problem.problem import Record
from harness.identify.validation.residual_acceleration import Trace, trace
from harness.recording import Case
from harness.report.palette import Look
from harness.signals.ball_state import BallEstimate

MODEL = Look("the model as declared", "#0072B2", (5.0, 2.0), 1.6, 5)
FOUND = Look("with what was found", "#D55E00", None, 1.6, 6)


@dataclass(frozen=True)
class Account:
    """A diagnosis with what belongs to its report.

    Attributes:
        diagnosis: everything found.
        record: as written to diagnosis.json.
        case: what was handed in.
        command: what repeats it.
        replay: what replays its ledger; both empty if not known.
    """

    diagnosis: Diagnosis
    record: Mapping[str, object]
    case: Case
    command: str
    replay: str = ""

    @property
    def simulated(self) -> bool:
        """Whether the recordings are simulated, not measured."""
        return (self.case.origin or "").lower().startswith("simulated")

    @property
    def measured(self) -> str:
        """What the recordings are to be called."""
        return "simulated recording" if self.simulated else "recorded"

    @property
    def case_name(self) -> str:
        """Name of the case for headings."""
        path = self.case.path.resolve()
        return path.parent.name if path.name == "rig.toml" else path.stem

    @property
    def subtitle(self) -> str:
        """Recordings, readings, origin."""
        records = self.diagnosis.problem.records
        spans = ", ".join(f"{one.name} ({brief(float(one.time[-1] - one.time[0]))} s)" for one in records)
        parts = [spans, f"{self.diagnosis.problem.readings} positions"]
        return "; ".join([*parts, f"origin: {self.case.origin}"] if self.case.origin else parts)

    @property
    def changed(self) -> bool:
        """Whether anything was found that acts."""
        return bool(self.diagnosis.effects) or self.diagnosis.found.hypothesis.shape is not None

    @property
    def shown(self) -> Record:
        """The recording that pictures show: the first."""
        return self.diagnosis.problem.records[0]

    @cached_property
    def traces(self) -> tuple[Trace, ...]:
        """What is missing in each recording."""
        problem, found = self.diagnosis.problem, self.diagnosis.found
        return tuple(trace(problem, found, one, self.ball(one)) for one in problem.records)

    def ball(self, record: Record) -> BallEstimate:
        """The ball's state in one of the recordings, as measured."""
        return ball_of(self.case, self.case.recordings[record.name], record.drive, self.diagnosis.problem.rig)

    @cached_property
    def force(self) -> float:
        """Force on the ball that gives it an acceleration of one, m (1 + J/(m r²)) [N per m/s²]."""
        rig = self.diagnosis.problem.rig
        return rig.mass / rig.rolling_ratio
