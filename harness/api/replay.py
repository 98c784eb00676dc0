"""Replay: check that what a diagnosis says comes out again from the same inputs."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from harness.api.case import case_of
from harness.api.diagnosis import input_hashes
from harness.api.effects import Given, beside_catalogue, files_of
from harness.api.progress import shown
from harness.api.saved import LoadedDiagnosis, as_written
from harness.api.writing import sha256_of
from harness.errors import InputError
from harness.progress import Progress
from harness.recording.own_files import OWN_FILES
from harness.report.tables import Summarised, Summary, Table, texts
from harness.threads import one_blas_thread

if TYPE_CHECKING:
    from harness.api.case import Case
    from harness.identify.problem.problem import Problem
    from harness.identify.record import DiagnosisRecord
    from harness.identify.selection.replay import Mismatch
    from harness.identify.selection.search import Selection
    from harness.recording import Case as CheckedCase

_SHOWN = 12  # digits of a hash in a message
# Relative tolerances: other processors round otherwise, and fits to other readings end a little elsewhere then.
_EXACT, _REFITTED, _LEAST = 1e-6, 1e-3, 1e-12
_AFTER_FITS = ("errors", "baselines", "next_experiment")
# Replayed line by line, or told otherwise.
_APART = ("ledger", "fits", "found", "problem", "inputs", "failures", "wall_time_s", "files", "sealed")
_SPARED = {
    "engines": "errors of the engines (--engines runs them)",
    "also": "errors on further recordings, and findings about the input",
    "covariance": "standard errors of fits to free runs, on which the intervals rest",
    "predictions": "band, travel and held-out errors of the predictions of a model that was found to predict poorly",
    "failures": "parts that failed, on which what was left out rests",
}


@dataclass(frozen=True, repr=False)
class Replayed(Summarised):
    """What a replay found.

    Attributes:
        origin: of the diagnosis.
        attempts: number of decisions that were replayed.
        fits: number of fits that were replayed.
        mismatches: what differs.
        largest: difference of a deviance.
        other_versions: software that is not what it was, `then → now` by name.
        unverified: what was not computed anew.
    """

    origin: Path
    attempts: int
    fits: int
    mismatches: tuple[Mismatch, ...]
    largest: float
    other_versions: Mapping[str, str]
    unverified: tuple[str, ...] = ()

    @property
    def reproduced(self) -> bool:
        """Whether everything came out again."""
        return not self.mismatches

    @property
    def sentence(self) -> str:
        """The answer."""
        result = "nothing differs" if self.reproduced else f"{len(self.mismatches)} differ"
        return f"{self.attempts} decisions, {self.fits} fits replayed: {result}"

    def summary(self) -> Summary:
        """The answer, every difference, other versions and what was not verified."""
        lines = [f"{self.sentence}.", f"Largest difference of a deviance: {self.largest:.1g}"]
        lines += [f"not verified: {what}" for what in self.unverified]
        differences = [(one.where, one.what) for one in self.mismatches]
        changed = list(self.other_versions.items())
        tables = [Table("Differences", texts("where", "what"), differences)] if differences else []
        tables += [Table("Changed since", texts("software", "then → now"), changed)] if changed else []
        return Summary(f"Replay of {self.origin}", lines, tables)


@one_blas_thread()
def replay(
    diagnosis: LoadedDiagnosis | str | Path,
    case: CheckedCase | str | Path,
    *,
    refit: bool = False,
    engines: bool = False,
    effects: Sequence[Given] = (),
    progress: bool | Progress = False,
) -> Replayed:
    """Replay a diagnosis: check that its seal, hashes, deviances, decisions and all that it concludes come out again.

    Verdict, sentence, effects, spline term, model, prediction errors, baselines and the next experiment are computed
    anew from the result of the ledger, by the functions that made them, and every difference is listed.

    Args:
        diagnosis: or its diagnosis.json, or the folder that this is in.
        case: what it was made from.
        refit: fit every hypothesis on from its numbers, and decide by what comes out.
        engines: run the engines, too, and compare their errors.
        effects: effects of your own that it was made with, as Python files or as `Effect` objects.
        progress: show a bar on stderr, or a function to be told.

    Raises:
        InputError: the diagnosis cannot be used, or the case is not the one that it was made from.
    """
    kept = diagnosis if isinstance(diagnosis, LoadedDiagnosis) else as_written(diagnosis, effects=effects)
    record = kept.record
    with beside_catalogue(effects), shown(progress) as tell:
        case = case_of(case)
        tell("drives and rig", share=0.0)
        from harness.identify.pose import problem_of
        from harness.identify.selection.replay import replay as again
        from harness.provenance import versions

        try:
            sources = record.problem.inputs
            hashes = input_hashes(case, files_of(effects))
            _same_inputs(sources.hashes, hashes, case.path, kept.origin)
            problem = problem_of(case, record.problem.recordings).rougher(record.problem.roughness)
            done = again(record, problem, refit=refit, progress=tell)
            mismatches = [*_sealing(record, kept.origin), *done.mismatches]
            if done.selection is None:
                mismatches.append(_mismatch("found", f"is {record.found or 'nothing'}, which is no fit of the ledger"))
            else:
                mismatches += _conclusions(record, case, problem, done.selection, hashes, engines, tell)
        except (LookupError, ValueError, TypeError, ArithmeticError) as error:
            raise InputError(f"{kept.origin}: its ledger cannot be read ({error!r}); diagnose anew") from error
        now = versions()
        other = {
            name: f"{then} → {now.get(name, 'absent')}"
            for name, then in sources.versions.items()
            if now.get(name) != then
        }
    return Replayed(
        kept.origin, done.attempts, done.fits, tuple(mismatches), done.largest, other, _unverified(record, engines)
    )


def _mismatch(where: str, what: str) -> Mismatch:
    from harness.identify.selection.replay import Mismatch

    return Mismatch(where, what)


def _sealing(record: DiagnosisRecord, file: Path) -> Iterator[Mismatch]:
    """Whether the file and those written with it are what was written; a file that is not there says nothing."""
    if not record.intact:
        text = f"is {record.sealed[:_SHOWN]}…, but the content gives {record.seal[:_SHOWN]}…"
        yield _mismatch("sealed", text if record.sealed else "is missing: the file was not sealed")
    for name, digest in record.files.items():
        beside = file.parent / name
        if file.is_file() and beside.is_file() and sha256_of(beside) != digest:
            yield _mismatch(name, "has been changed since it was written")
    if record.inputs.hashes != record.problem.inputs.hashes:
        yield _mismatch("inputs.hashes", "are not those of the problem")
    if record.inputs.versions != record.problem.inputs.versions:
        yield _mismatch("inputs.versions", "are not those of the problem")


def _conclusions(
    record: DiagnosisRecord,
    case: Case,
    problem: Problem,
    selection: Selection,
    hashes: Mapping[str, str],
    engines: bool,
    tell: Progress,
) -> Iterator[Mismatch]:
    """Differences of all that follows from the ledger, made anew by the functions that made it."""
    from harness.api.assemble import diagnosis_record
    from harness.failures import Failed, Failures, Part
    from harness.identify.diagnosis import validate
    from harness.identify.outcome import contradiction, untried
    from harness.identify.verdict import judge

    failed = [Failed(Part(one.part), one.name, one.message, one.where) for one in record.failures]
    missing = untried(problem, selection, failed)
    if missing:
        yield _mismatch("ledger", f"has no attempt of {', '.join(missing)}, which the search tries first")
    text = contradiction(problem, selection, failed)
    if text:
        yield _mismatch("found", f"is {text}")
    failures = Failures(failed)
    tell("verdict and intervals")
    identified = judge(selection, failures)
    found = validate(identified, failures, tell, length=case.rig.length, engines=engines, scene=case.scene)
    made = diagnosis_record(found, case, record.wall_time_s, hashes)
    spared = {("errors", "also"), *(() if engines else [("errors", "engines")])}
    spared |= {("findings",)} if record.errors.also else set()
    recorded, now = (_conclusions_of(one) for one in (record, made))
    yield from differences(recorded, now, spared)


def _conclusions_of(record: DiagnosisRecord) -> dict[str, Any]:
    """What is compared: without the note on files that the harness has put beside the recordings, before or since."""
    findings = tuple(one for one in record.findings if one.code != OWN_FILES)
    return record.model_copy(update={"findings": findings}).model_dump(exclude=set(_APART))


def differences(
    recorded: Any, now: Any, spared: set[tuple[str, ...]], where: tuple[str, ...] = ()
) -> Iterator[Mismatch]:
    """Differences of two contents, each with its key and both values.

    Args:
        spared: keys that are not compared.
        where: the key of these contents.
    """
    if where in spared:
        return
    if isinstance(recorded, Mapping) and isinstance(now, Mapping):
        for key in dict.fromkeys((*recorded, *now)):
            yield from differences(recorded.get(key), now.get(key), spared, (*where, str(key)))
    elif _listed(recorded) and _listed(now) and len(recorded) == len(now):
        for at, (one, other) in enumerate(zip(recorded, now, strict=True)):
            yield from differences(one, other, spared, (*where, str(at)))
    elif not _alike(recorded, now, _REFITTED if _after_fits(where) else _EXACT):
        yield _mismatch(".".join(where), f"is {_said(now)}, recorded {_said(recorded)}")


def _after_fits(where: tuple[str, ...]) -> bool:
    """Whether what is at this key follows from fits that a replay makes again, not from recorded parameters alone."""
    return where[0] in _AFTER_FITS or where[:2] == ("model", "forecast")


def _listed(value: Any) -> bool:
    return isinstance(value, list | tuple)


def _alike(one: Any, other: Any, relative: float) -> bool:
    numbers = [isinstance(each, int | float) and not isinstance(each, bool) for each in (one, other)]
    if all(numbers):
        return math.isclose(one, other, rel_tol=relative, abs_tol=_LEAST * relative)
    return bool(one == other)


def _said(value: Any) -> str:
    if isinstance(value, str):
        return f'"{value}"'
    if isinstance(value, Mapping) or _listed(value):
        return f"{len(value)} entries"
    return "null" if value is None else str(value)


def _unverified(record: DiagnosisRecord, engines: bool) -> tuple[str, ...]:
    """What a replay takes as it is written."""
    spared = {
        "engines": not engines and bool(record.errors.engines),
        "also": bool(record.errors.also),
        "covariance": record.model.estimator == "free_runs",
        "predictions": record.found in record.fits and record.fits[record.found].travel_m is not None,
        "failures": bool(record.failures),
    }
    return tuple(_SPARED[name] for name, is_spared in spared.items() if is_spared)


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
