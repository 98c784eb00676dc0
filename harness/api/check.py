"""Checks whether a case is fit for use: what is odd in it, and which effects it could show at which size."""

from __future__ import annotations

import math
from contextlib import AbstractContextManager, nullcontext
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from harness.api.case import Case, case_of, input_files
from harness.api.diagnosis import input_hashes
from harness.api.outputs import sealed_json, write_columns
from harness.api.progress import shown
from harness.api.writing import all_or_nothing, hashes_of
from harness.failures import Failures
from harness.formatting import length, number
from harness.progress import Progress, Stage
from harness.provenance import versions
from harness.recording import Case as CheckedCase
from harness.recording.findings import STOPPING
from harness.recording.own_files import NEXT_EXPERIMENT
from harness.report.tables import Summarised, Summary
from harness.threads import one_blas_thread

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

    from harness.identify.design.detection import Detection
    from harness.identify.design.excitation import OperatingEnvelope
    from harness.identify.design.proposal import Proposal
    from harness.identify.validation.at_rest import AgainstRest
    from harness.report.check.content import Subject

FILE, REPORT = "check.json", "check.html"
_FEWEST = 20  # positions that a recording needs, as for a diagnosis


@dataclass(frozen=True, repr=False)
class Check(Summarised):
    """What `check` found.

    Attributes:
        case: what was checked; `case.findings` is what is odd in it.
        reasons: why it is not fit for use; empty if it is.
        detection: detection limits; `None` where an input is not worth computing them.
        proposal: the motion to record instead; `None` if every effect shows or none would help.
        envelope: ranges of the motions that were tried for it.
        ahead: errors of the declared model over 1 s, against those of a ball at rest; `None` where an input is not
            worth computing them or too short.
    """

    case: Case
    reasons: tuple[str, ...]
    detection: Detection | None = None
    proposal: Proposal | None = None
    envelope: OperatingEnvelope | None = None
    ahead: AgainstRest | None = None

    @property
    def fit(self) -> bool:
        """Whether the recordings are fit for use."""
        return not self.reasons

    @property
    def sentence(self) -> str:
        """The answer."""
        if self.detection is None:
            return "Not fit for use."
        limits = self.detection.limits
        now = sum(one.shows(one.limit) for one in limits)
        later = sum(one.seen for one in limits)
        more = f", {later} once what the declared model lacks is explained" if later > now else ""
        told = f"{now} of {len(limits)} effects would show at their typical size{more}."
        return f"{'Fit for use' if self.fit else 'Not fit for use'}: {told}{self._worse_than_rest}"

    @property
    def _worse_than_rest(self) -> str:
        """That the declared model predicts worse than a ball at rest; empty if it does not."""
        if self.ahead is None or not self.ahead.worse:
            return ""
        model, rest = length(self.ahead.model), length(self.ahead.at_rest)
        return (
            f" But over 1 s the declared model predicts worse than a ball at rest would: RMS error {model}, of a ball "
            f"that stays where it is {rest}. Do not use the model as it is; `harness diagnose` looks for what it lacks."
        )

    @property
    def next_sentence(self) -> str:
        """What to record instead; empty if every effect shows."""
        if self.detection is None or all(one.seen for one in self.detection.limits):
            return ""
        if self.proposal is None:
            return (
                f"No motion that was tried would show more{_within(self.envelope)}: let the beam turn further or "
                "faster, or the ball roll farther."
            )
        from harness.identify.design.proposal import sentence

        return sentence(self.proposal)

    @property
    def effects(self) -> pd.DataFrame:
        """One row an effect: `effect`, `parameter`, `unit`, `limit`, `limit_explained`, `typical` (distances from
        `neutral`, in the unit), `shows` and `shows_explained` (at the typical size), `alike` and `told_apart_from`."""
        import pandas as pd

        return pd.DataFrame(self._rows())

    def _rows(self) -> list[dict[str, Any]]:
        return [
            {
                "effect": one.effect,
                "parameter": one.parameter,
                "unit": one.unit,
                "neutral": one.neutral,
                "limit": one.limit,
                "limit_explained": one.explained,
                "typical": one.typical,
                "shows_below_limit": one.inverse,
                "shows": one.shows(one.limit),
                "shows_explained": one.seen,
                "alike": dict(one.alike),
                "told_apart_from": one.apart,
            }
            for one in (self.detection.limits if self.detection else ())
        ]

    def summary(self) -> Summary:
        """The answer, reasons, findings and the effects."""
        from harness.report.check.effects import alike_table, hidden_text, limits_table

        lines = [self.sentence, *self.reasons]
        if self.case.simulated:
            lines.append("The recordings are simulated.")
        lines += [str(one) for one in self.case.findings]
        if self.detection is not None and self.detection.hidden:
            lines.append(hidden_text(self.detection))
        lines += [self.next_sentence] if self.next_sentence else []
        limits = self.detection.limits if self.detection else ()
        alike = alike_table(limits)
        tables = ([limits_table(limits)] if limits else []) + ([alike] if alike else [])
        return Summary(f"Check of {self.case.path}", lines, tables)

    def plot(self) -> Figure:
        """Detection limit of every effect in its typical sizes; of a worthless input, its first recording."""
        from harness.report.check.limits import drawn

        return self.case.plot() if self.detection is None else drawn(self.detection.limits)

    def record(self) -> dict[str, Any]:
        """Content of check.json, without its seal; numbers that are not finite become null."""
        return {
            "schema": 1,
            "case": str(self.case.path),
            "simulated": self.case.simulated,
            "fit": self.fit,
            "sentence": self.sentence,
            "reasons": list(self.reasons),
            "findings": [{**asdict(one), "stops": one.stops} for one in self.case.findings],
            "effects": self._rows(),
            "hidden": list(self.detection.hidden) if self.detection else [],
            "error_over_1_s": asdict(self.ahead) if self.ahead else None,
            "next_experiment": self.next_sentence or None,
            "inputs": {"hashes": input_hashes(self.case), "versions": versions()},
        }

    def save(self, folder: str | Path, *, force: bool = False) -> Path:
        """Write check.json, check.html and, if a motion is proposed, next_experiment.csv; all of them or none.

        Args:
            folder: to write into.
            force: replace files that this did not write, or that have been changed since, too.

        Returns:
            The folder.

        Raises:
            InputError: the folder cannot be written, or a file is in the way.
        """
        folder = Path(folder)
        with _writing(self.case, folder, force) as scratch:
            self._write(scratch)
        return folder

    def _write(self, scratch: Path) -> None:
        """Write all files."""
        from harness.report.check import render_check

        if self.proposal is not None:
            write_columns(self.proposal.table(), scratch / NEXT_EXPERIMENT)
        failures = Failures()
        (scratch / REPORT).write_text(render_check(self._subject(), failures), encoding="utf-8")
        told = {"failures": [str(one) for one in failures.all], "files": hashes_of(scratch)}
        (scratch / FILE).write_text(sealed_json(self.record() | told), encoding="utf-8")

    def _subject(self) -> Subject:
        from harness.report.check.content import Subject

        return Subject(
            self.case, self.sentence, self.reasons, self.detection, self.proposal, self.next_sentence, self.ahead
        )


@one_blas_thread()
def check(
    case: CheckedCase | str | Path,
    *,
    out: str | Path | None = None,
    force: bool = False,
    progress: bool | Progress = False,
) -> Check:
    """Check whether a case is fit for use, and which effects it could show at which size; nothing is searched for.

    Args:
        case: as of `load_case`, or its path.
        out: folder to write into, as `Check.save` does; what cannot be written is refused before anything is computed.
        force: replace files there that no check wrote, or that have been changed since, too.
        progress: show a bar on stderr, or a function to be told.

    Raises:
        InputError: the case cannot be read, its rig not be completed, or the folder not be written.
    """
    with shown(progress) as tell:
        tell("reading the recordings", share=0.0)
        read = case_of(case)
        with nullcontext() if out is None else _writing(read, Path(out), force) as scratch:
            made = _checked(read, tell)
            if scratch is not None:
                made._write(scratch)
    return made


def _writing(case: CheckedCase, folder: Path, force: bool) -> AbstractContextManager[Path]:
    """What all files of a check are written into; `next_experiment.csv`, which not each has, is looked at last."""
    inputs = input_files(case)
    return all_or_nothing(folder, record=FILE, names=(FILE, REPORT), inputs=inputs, force=force, supersede=True)


def _checked(read: Case, tell: Progress) -> Check:
    """The check of a case that was read."""
    reasons = _worthless(read)
    if reasons:
        return Check(read, reasons)
    from harness.identify.design.choose import choose_to_detect
    from harness.identify.design.detection import detection_limits
    from harness.identify.design.excitation import envelope_of
    from harness.identify.pose import problem_of
    from harness.identify.rig_completion import NotRolling, contradicted
    from harness.identify.validation.at_rest import against_rest

    tell("drives and rig", share=0.1)
    try:
        problem = problem_of(read)
    except NotRolling as error:
        return Check(read, (f"{error}.",))
    if (warning := contradicted(read.rig, problem.rig)) is not None:
        read = replace(read, findings=(*read.findings, warning))
    found = detection_limits(problem, Stage(tell, 0.2, 0.75, 3.0))
    tell("errors over 1 s", share=0.75)
    ahead = against_rest(problem, found.base)
    unseen = [one.effect for one in found.limits if not one.seen]
    share = problem.settings.unseen_share
    if len(unseen) > share * len(found.limits):
        reasons = (
            f"Too little to go by: {len(unseen)} of {len(found.limits)} effects would not show at their typical "
            "size, so that finding none would mean nothing. Record longer, at a higher rate, or with more motion.",
        )
    proposal, envelope = None, envelope_of(problem, read.rig.length)
    if unseen:
        tell("what to record instead", share=0.8)
        proposal = choose_to_detect(problem, found.base, unseen, length=read.rig.length)
    return Check(read, reasons, found, proposal, envelope, ahead)


def _within(envelope: OperatingEnvelope | None) -> str:
    """In which ranges, in words: those of the recordings, with a fifth more for the beam."""
    if envelope is None:
        return ""
    angle, rate = math.degrees(envelope.angle), math.degrees(envelope.rate)
    low, high = 1e3 * envelope.low, 1e3 * envelope.high
    return (
        f" within an angle of ±{number(angle)}° at up to {number(rate)} °/s and with the ball between {number(low)} "
        f"and {number(high)} mm"
    )


def _worthless(case: Case) -> tuple[str, ...]:
    """Why no use can be made of the input as it is."""
    stopping = [one for one in case.findings_on(case.identify) if one.stops]
    if stopping:
        return tuple(f"{one.where}: {STOPPING[one.code]}; correct the input [{one.code}]." for one in stopping)
    most = max((int(case.recordings[name].usable.sum()) for name in case.identify), default=0)
    if most < _FEWEST:
        return (f"Too few positions: the best recording has {most} that can be used, {_FEWEST} are the fewest.",)
    return ()
