"""What a log says in words, and when: what is recorded and what simulated, lift-offs, held-out windows, failures."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

from harness.comparison.setting import Setting
from harness.identify.model_file import observed_for
from harness.identify.problem.problem import PreparedRecording
from harness.identify.problem.windows import KNOWN, Block, blocks_of
from harness.identify.record import DiagnosisRecord
from harness.viewing.playback import Playback

Level = Literal["INFO", "WARN", "ERROR"]


@dataclass(frozen=True)
class Told:
    """One line of a log.

    Attributes:
        time: of the recording [s].
        text: what happens then.
        level: INFO, WARN (something ends or is missing) or ERROR (something failed).
    """

    time: float
    text: str
    level: Level = "INFO"


def told_of(setting: Setting, playback: Playback, record: DiagnosisRecord | None) -> tuple[Told, ...]:
    """All lines between the begin and the end of what is shown, by time.

    Args:
        setting: the recording.
        playback: the runs over it.
        record: the diagnosis whose effects act in the second run, if there is one.
    """
    lines = [*_of_runs(setting, playback), *_of_diagnosis(setting, playback.begin, record)]
    return tuple(sorted((one for one in lines if playback.begin <= one.time <= playback.end), key=lambda one: one.time))


def _of_runs(setting: Setting, playback: Playback) -> Iterator[Told]:
    yield Told(playback.begin, f"{setting.recording.name}: {playback.recorded_name} positions and beam angles")
    if dropped := int((setting.recording.known & ~setting.ball.trusted).sum()):
        text = f"{dropped} readings of the recording are outliers, which no ball is drawn at"
        yield Told(playback.begin, text, "WARN")
    for run in playback.runs:
        name, first = f"{playback.engine}, simulated, {run.name}", float(run.time[0])
        # What began before the part that is shown is told where this begins.
        yield Told(max(first, playback.begin), f"{name}: one free run from {first:.2f} s on")
        if run.lifted_off is not None:
            text = f"{name}: the ball lifts off the beam, and the run ends"
            yield Told(run.lifted_off, text, "WARN")


def _of_diagnosis(setting: Setting, begin: float, record: DiagnosisRecord | None) -> Iterator[Told]:
    if record is None:
        return
    yield Told(begin, f"diagnosis: {record.sentence}")
    for failure in record.failures:
        yield Told(begin, f"diagnosis: {failure}", "ERROR")
    compared = record.baselines
    if compared is None:
        yield Told(begin, "diagnosis: it held out no windows")
        return
    blocks = _blocks(setting, record)
    before, after = compared.errors_m.get("before", ()), compared.errors_m.get("after", ())
    if not len(blocks) == len(before) == len(after):
        text = "diagnosis: where its held-out windows are is not known, as it was not made from this case's recordings"
        yield Told(begin, text, "WARN")
        return
    for number, (block, *errors) in enumerate(zip(blocks, before, after, strict=True), 1):
        first, last = block.held_out[0], block.held_out[-1]
        if first.recording.name != setting.recording.name:
            continue
        since, until = first.begin + KNOWN, last.begin + float(last.time[-1])
        without, with_them = ("not known" if one is None else f"{1e3 * one:.1f} mm" for one in errors)
        yield Told(
            max(since, begin) if until > begin else since,
            f"held-out block {number} of {len(blocks)}: {since:.2f} s to {until:.2f} s, which the analytic model, "
            f"fitted without it, predicts with an RMS error of {without} without the effects and {with_them} with them",
        )


def _blocks(setting: Setting, record: DiagnosisRecord) -> Sequence[Block]:
    """The blocks that the diagnosis held out; none if its recordings are not those of the case."""
    case, names = setting.case, record.problem.recordings
    kept = record.problem.inputs.hashes
    if any(name not in case.recordings or kept.get(name) != case.recordings[name].sha256 for name in names):
        return ()
    observed = [observed_for(record.model, case.recordings[name], case.sensors) for name in names]
    return blocks_of([PreparedRecording.of(one) for one in observed])
