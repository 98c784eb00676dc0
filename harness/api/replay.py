"""Replay: check that the ledger of a diagnosis is reproduced from the same inputs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from harness.api.case import case_of
from harness.api.diagnosis import input_hashes
from harness.api.effects import Given, beside_catalogue, files_of
from harness.api.progress import shown
from harness.api.saved import LoadedDiagnosis, load_diagnosis
from harness.errors import InputError
from harness.progress import Progress

if TYPE_CHECKING:
    from harness.identify.selection.replay import Mismatch
    from harness.recording import Case as CheckedCase

_SHOWN = 12  # digits of a hash in a message


@dataclass(frozen=True)
class Replayed:
    """What a replay found.

    Attributes:
        origin: of the diagnosis.
        attempts: number of decisions that were replayed.
        fits: number of fits that were replayed.
        mismatches: what differs.
        largest: difference of a deviance.
        other_versions: software that is not what it was, `then → now` by name.
    """

    origin: Path
    attempts: int
    fits: int
    mismatches: tuple[Mismatch, ...]
    largest: float
    other_versions: Mapping[str, str]

    @property
    def reproduced(self) -> bool:
        """Whether everything came out again."""
        return not self.mismatches


def replay(
    diagnosis: LoadedDiagnosis | str | Path,
    case: CheckedCase | str | Path,
    *,
    refit: bool = False,
    effects: Sequence[Given] = (),
    progress: bool | Progress = False,
) -> Replayed:
    """Replay the ledger of a diagnosis: check that its hashes, deviances and decisions are reproduced.

    Args:
        diagnosis: or its diagnosis.json, or the folder that this is in.
        case: what it was made from.
        refit: fit every hypothesis on from its numbers, and decide by what comes out.
        effects: effects of your own that it was made with, as Python files or as `Effect` objects.
        progress: show a bar on stderr, or a function to be told.

    Raises:
        InputError: the diagnosis cannot be used, or the case is not the one that it was made from.
    """
    kept = diagnosis if isinstance(diagnosis, LoadedDiagnosis) else load_diagnosis(diagnosis)
    record = kept.record
    with beside_catalogue(effects), shown(progress) as tell:
        case = case_of(case)
        tell("drives and rig", share=0.0)
        from harness.identify.pose import problem_of
        from harness.identify.selection.replay import replay as again
        from harness.provenance import versions

        try:
            sources = record.problem.inputs
            _same_inputs(sources.hashes, input_hashes(case, files_of(effects)), case.path, kept.origin)
            problem = problem_of(case, record.problem.recordings)
            done = again(record, problem, refit=refit, progress=tell)
        except (LookupError, ValueError) as error:
            raise InputError(f"{kept.origin}: its ledger cannot be read ({error!r}); diagnose anew") from error
        now = versions()
        other = {
            name: f"{then} → {now.get(name, 'absent')}"
            for name, then in sources.versions.items()
            if now.get(name) != then
        }
    return Replayed(kept.origin, **vars(done), other_versions=other)


def _same_inputs(recorded: Mapping[str, str], now: Mapping[str, str], case: Path, file: Path) -> None:
    for name, hashed in recorded.items():
        if name not in now:
            raise InputError(
                f"{case}: {name}, from which {file} was made, is not in this case; name the right one, and a "
                "file of effects with --effects"
            )
        if now[name] != hashed:
            raise InputError(
                f"{case}: {name} has changed since {file} was made (SHA-256 {now[name][:_SHOWN]}…, recorded "
                f"{hashed[:_SHOWN]}…); restore it, or diagnose anew"
            )
    added = [name for name in now if name not in recorded]
    if added:
        raise InputError(f"{case}: {added[0]} was not there when {file} was made; take it out, or diagnose anew")
