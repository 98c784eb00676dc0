"""What a case's model lacks: found, verified, plotted, written."""

from __future__ import annotations

import shlex
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from harness.api.acceptance import check_codes, refuse_worthless
from harness.api.case import Case, case_of, input_files
from harness.api.effects import Given, beside_catalogue, files_of
from harness.api.effort import ask, diagnosis_time, expected
from harness.api.memory import diagnosis_memory
from harness.api.outputs import report_folder, write_columns
from harness.api.progress import shown
from harness.api.saved import LoadedDiagnosis
from harness.api.writing import all_or_nothing, hashes_of
from harness.errors import InputError
from harness.failures import Failures, Part, attempt
from harness.identify.record import FILE, DiagnosisRecord
from harness.progress import Progress
from harness.recording import Recording, load_recording
from harness.recording.case import typed_path
from harness.recording.own_files import NEXT_EXPERIMENT
from harness.recording.source import read_source
from harness.threads import one_blas_thread

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from harness.identify.diagnosis import Diagnosis as Found
    from harness.recording import Case as CheckedCase
    from harness.scene import Scene

REPORT = "diagnosis.html"


@dataclass(frozen=True)
class Asked:
    """What a diagnosis was asked for: further recordings, own effects, accepted findings, where to write."""

    also: tuple[Path, ...] = ()
    effects: tuple[Path, ...] = ()
    out: Path | None = None
    accept: tuple[str, ...] = ()
    parameters: Path | None = None

    @contextmanager
    def scratch(self, folder: Path, case: CheckedCase, *, force: bool) -> Iterator[Path]:
        """A scratch folder for all files of a diagnosis (`all_or_nothing`)."""
        names = (FILE, REPORT, NEXT_EXPERIMENT, *prediction_files(case))
        parameters = () if self.parameters is None else (self.parameters,)
        inputs = (*input_files(case), *self.also, *self.effects, *parameters)
        with all_or_nothing(folder, record=FILE, names=names, inputs=inputs, force=force, supersede=True) as scratch:
            yield scratch

    def command(self, name: str, *paths: Path, whole: bool = True) -> str:
        """What is to be typed; with `also`, `accept` and `out` where it is the `whole`."""
        options: list[tuple[str, Path | str]] = [("--out", self.out)] if whole and self.out is not None else []
        options += [("--accept", code) for code in self.accept if whole]
        options += [("--also", file) for file in self.also if whole]
        options += [("--parameters", self.parameters)] if whole and self.parameters is not None else []
        options += [("--effects", file) for file in self.effects]
        words = [str(word) for option in options for word in option]
        return shlex.join(["harness", name, *map(str, paths), *words])


class Diagnosis(LoadedDiagnosis):
    """What `diagnose` found: all that a `LoadedDiagnosis` has, and its plot and report.

    Attributes:
        case: what was diagnosed.
        found: fits, search and validation (`harness.identify.diagnosis.Diagnosis`).
    """

    def __init__(
        self,
        record: DiagnosisRecord,
        case: Case,
        found: Found,
        *,
        effects: Sequence[Given] = (),
        asked: Asked | None = None,
    ) -> None:
        """Take the record, and what it was made from."""
        super().__init__(record, case.path, effects)
        self.case, self.found, self._asked = case, found, asked or Asked()

    def plot(self) -> Figure:
        """The recording shown in the report predicted from its first two seconds, without and with what was found."""
        from harness.report.diagnosis.account import Account
        from harness.report.diagnosis.verdict import before_after

        with beside_catalogue(self._own):
            return before_after(Account(self.found, self.record, self.case, ""))

    @one_blas_thread()
    def save(self, folder: str | Path | None = None, *, jobs: int = 1, force: bool = False) -> Path:
        """Write diagnosis.json, diagnosis.html, predictions and the next experiment, all of them or none.

        Args:
            folder: to write into; `reports/<name of the case>` if none is given.
            jobs: processes to draw the report in; 1 for this one.
            force: replace files that no diagnosis wrote, or that have been changed since, too.

        Returns:
            The folder.

        Raises:
            InputError: the folder cannot be written, or a file is in the way.
        """
        folder = report_folder(self.case.path) if folder is None else Path(folder)
        with beside_catalogue(self._own), self._asked.scratch(folder, self.case, force=force) as scratch:
            self._write(scratch, folder, jobs)
        return folder

    def _write(self, scratch: Path, folder: Path, jobs: int) -> None:
        """Into `scratch`, from where it gets into `folder`; the effects are beside the catalogue."""
        from harness.api.assemble import failure_records
        from harness.report.diagnosis import render_diagnosis
        from harness.report.page import render_page

        failures = Failures(self.found.failures)
        if self.found.next_experiment is not None:
            write_columns(self.found.next_experiment.table(), scratch / NEXT_EXPERIMENT)
        for file, name in prediction_files(self.case).items():
            table = attempt(failures, Part.PREDICTION, name, partial(self._predicted, self.case.recordings[name]), None)
            if table is not None:
                write_columns(table, scratch / file)
        page = attempt(
            failures,
            Part.REPORT,
            REPORT,
            lambda: render_diagnosis(
                self.found,
                self.record,
                self.case,
                command=self._asked.command("diagnose", typed_path(self.case.path)),
                replay=self._asked.command("replay", folder, typed_path(self.case.path), whole=False),
                jobs=jobs,
                failures=failures,
            ),
            None,
        ) or render_page(f"{self.case.name}: {self.sentence}", (), failures=failures.all)
        (scratch / REPORT).write_text(page, encoding="utf-8")
        told = {"failures": failure_records(failures.all), "files": hashes_of(scratch)}
        self.record = self.record.model_copy(update=told).with_seal()
        (scratch / FILE).write_text(self.record.text() + "\n", encoding="utf-8")


@one_blas_thread()
def diagnose(
    case: CheckedCase | str | Path,
    *,
    also: Sequence[str | Path] = (),
    effects: Sequence[Given] = (),
    accept: Sequence[str] = (),
    parameters: str | Path | None = None,
    out: str | Path | None = None,
    force: bool = False,
    yes: bool = False,
    jobs: int = 1,
    progress: bool | Progress = False,
) -> Diagnosis:
    """Find what the model lacks: which effects act, their sizes and intervals, and errors before and after.

    Args:
        case: as of `load_case`, or its path.
        also: further recordings of the rig, with positions, to hold the result against; nothing is fitted to them.
        effects: effects of your own to look for beside the catalogue's, as Python files or as `Effect` objects.
        accept: codes of findings about the input that would stop the diagnosis, such as `angle-sign`, and are meant so.
        parameters: settings of the engines with which the result is validated, as a TOML file with one table an engine,
            such as `tune` writes. Its table `[rig]` is left aside: effects that are found stand for it.
        out: folder to write into at once, checked before anything is computed; nothing is written if none is given.
        force: replace files in `out` that no diagnosis wrote, or that have been changed since, too.
        yes: diagnose although it takes longer than ten minutes or more than 4 GB of memory.
        jobs: processes that run engines, search by held-out errors and draw the report. More than 1 forks this process,
            which is not safe where other threads hold locks, as they may in a notebook. The search by likelihood uses
            threads on all cores, and that by held-out errors with 1; but not within a process of `multiprocessing`.
        progress: show a bar on stderr, or a function to be told.

    Raises:
        InputError: the case, a further recording, a file of effects or a file's name cannot be used, or a file is in
            the way; nothing has been written then.
        WorthlessInput: a finding about the input, such as a reversed sign, makes any verdict worthless.
    """
    begin = time.monotonic()
    asked = Asked(tuple(map(Path, also)), files_of(effects), None if out is None else Path(out), tuple(accept),
                  None if parameters is None else Path(parameters))  # fmt: skip
    check_codes(asked.accept)
    with beside_catalogue(effects) as own, shown(progress) as tell:
        case = case_of(case)
        settings = _engine_settings(asked.parameters, case.scene)
        hashes = input_hashes(case, asked.effects)
        prediction_files(case)
        further = _further(case, asked.also)
        refuse_worthless(case, further, asked.accept)
        used = [case.recordings[name] for name in case.identify]
        takes = diagnosis_time(used), diagnosis_memory(used)
        ask(*takes, "list fewer or shorter recordings to identify from, or record at a lower rate", yes=yes)
        # Entered first: what cannot be written need not be computed.
        with nullcontext() if asked.out is None else asked.scratch(asked.out, case, force=force) as scratch:
            tell(f"drives and rig; {expected(*takes)}", share=0.0)
            from harness.api.assemble import diagnosis_record
            from harness.engines.catalogue import try_scene
            from harness.identify.diagnosis import diagnose as find
            from harness.identify.pose import problem_of
            from harness.identify.problem.problem import PreparedRecording

            problem = problem_of(case)
            records = [PreparedRecording.of(problem.observed(one, case.sensors)) for one in further]
            if case.scene is not None:
                try_scene(case.scene, problem.rig)
            found = find(
                problem,
                tell,
                also=records,
                length=case.rig.length,
                jobs=jobs,
                settings=settings,
                scene=case.scene,
            )
            record = diagnosis_record(found, case, time.monotonic() - begin, hashes, further).with_seal()
            made = Diagnosis(record, case, found, effects=own, asked=asked)
            if scratch is not None and asked.out is not None:
                tell("report", share=0.95)
                made._write(scratch, asked.out, jobs)
    return made


def _engine_settings(file: Path | None, scene: Scene | None) -> dict[str, dict[str, Any]]:
    """Settings by engine, all of them checked."""
    if file is None:
        return {}
    from harness.engines.catalogue import engine_of, parameters_of, read_settings

    settings = read_settings(file, ())
    for name, given in settings.items():
        parameters_of(engine_of(name, scene), given)
    return settings


def _further(case: Case, files: Sequence[Path]) -> list[Recording]:
    """Recordings beside the case's own, each under a name of its own."""
    used = {case.recordings[name].sha256: name for name in case.identify}
    found: dict[str, Recording] = {}
    for file in files:
        one = load_recording(file, rig=case.rig, sensors=case.sensors)
        if one.sha256 in used:
            raise InputError(
                f"{file}: is {used[one.sha256]}, which is in use already; give --also a recording that is not"
            )
        if not one.known.any():
            raise InputError(f"{file}: holds no ball positions, so there is nothing to hold predictions against")
        used[one.sha256] = str(file)
        name = str(file) if one.name in (*found, *case.identify) else one.name
        found[name] = replace(one, name=name)
    return list(found.values())


def input_hashes(case: CheckedCase, effects: Sequence[Path] = ()) -> dict[str, str]:
    """SHA-256 of everything that a diagnosis is made from, by file; files of effects by name, wherever they lie.

    Raises:
        InputError: a file of effects cannot be read, or has the name of another file.
    """
    hashes = {name: case.recordings[name].sha256 for name in case.identify}
    hashes |= {"rig.toml": case.sha256} if case.sha256 else {}
    hashes |= case.scene.sha256 if case.scene else {}
    for file in effects:
        if file.name in hashes:
            raise InputError(f"{file}: another file that the diagnosis is made from has this name; rename one of them")
        hashes[file.name] = read_source(file).sha256
    return hashes


def prediction_files(case: CheckedCase) -> dict[str, str]:
    """The recordings to predict, by the file that each prediction is written to.

    Raises:
        InputError: two recordings have one stem.
    """
    files: dict[str, str] = {}
    for name in case.predict:
        file = f"prediction_{Path(name).stem}.csv"
        if file in files:
            raise InputError(f"{case.path}: {files[file]} and {name} would both be predicted into {file}; rename one")
        files[file] = name
    return files
