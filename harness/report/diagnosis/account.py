"""The data common to all sections of the diagnosis report."""

from dataclasses import dataclass
from functools import cached_property

from analytic.motion import FloatArray
from harness.formatting import brief
from harness.identify.diagnosis import Diagnosis
from harness.identify.problem.problem import PreparedRecording
from harness.identify.record import DiagnosisRecord
from harness.identify.validation.residual_acceleration import ResidualAcceleration, residual_acceleration
from harness.recording import Case
from harness.report.palette import Look
from harness.signals.ball_state import BallEstimate

MODEL = Look("declared model", "#0072B2", (5.0, 2.0), 1.6, 5)
FOUND = Look("with the effects found", "#D55E00", None, 1.6, 6)


@dataclass(frozen=True)
class Account:
    """A diagnosis with the data of its report.

    Attributes:
        diagnosis: the result.
        record: content of diagnosis.json.
        case: the input.
        command: to repeat the diagnosis; empty if unknown.
        replay: command to replay its ledger; empty if unknown.
    """

    diagnosis: Diagnosis
    record: DiagnosisRecord
    case: Case
    command: str
    replay: str = ""

    @property
    def measured(self) -> str:
        """Legend label of the recordings."""
        return "simulated recording" if self.case.simulated else "recorded"

    @property
    def subtitle(self) -> str:
        """Recordings, readings, origin."""
        records = self.diagnosis.problem.recordings
        spans = ", ".join(f"{one.name} ({brief(float(one.time[-1] - one.time[0]))} s)" for one in records)
        origin = [f"origin: {self.case.origin}"] if self.case.origin else []
        return "; ".join([spans, f"{self.diagnosis.problem.readings} positions", *origin])

    @property
    def changed(self) -> bool:
        """Whether anything was found that acts."""
        return bool(self.diagnosis.effects) or self.diagnosis.found.hypothesis.spline is not None

    @property
    def shown(self) -> PreparedRecording:
        """The recording shown in figures: the first, or the one of which most is left out."""
        return max(self.diagnosis.problem.recordings, key=lambda one: len(self.left_out(one)))

    def left_out(self, record: PreparedRecording) -> FloatArray:
        """Stamps [s] and positions [m] of the readings of a recording that are left out of all fits, shape (k, 2)."""
        return next(one.left_out for one in self.case.recordings.values() if one.name == record.name)

    @cached_property
    def residual_accelerations(self) -> tuple[ResidualAcceleration, ...]:
        """The residual acceleration of each recording."""
        problem, found = self.diagnosis.problem, self.diagnosis.found
        return tuple(residual_acceleration(problem, found, one, self.ball(one)) for one in problem.recordings)

    def ball(self, record: PreparedRecording) -> BallEstimate:
        """The smoothed state of the ball at the stamps of one recording of the problem."""
        observed = self.diagnosis.problem.observed(self.case.recordings[record.name], self.case.sensors)
        return observed.ball.at(observed.used.stamps)
