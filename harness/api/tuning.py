"""An engine's contact and scene parameters fitted to a case: tuned, judged, written."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from contextlib import nullcontext
from dataclasses import asdict, dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from harness.api.acceptance import check_codes, refuse_worthless
from harness.api.case import Case, case_of, input_files
from harness.api.diagnosis import input_hashes
from harness.api.effects import Given, beside_catalogue, files_of
from harness.api.effort import ask, tuning_time
from harness.api.memory import tuning_memory
from harness.api.outputs import report_folder, sealed_json
from harness.api.progress import shown
from harness.api.saved import LoadedDiagnosis, load_diagnosis
from harness.api.writing import all_or_nothing, hashes_of
from harness.errors import InputError
from harness.failures import Failed, Failures, Part, attempt
from harness.progress import Progress, Stage
from harness.provenance import versions
from harness.recording.case import typed_path
from harness.report.tables import Summarised, Summary, Table, texts
from harness.threads import one_blas_thread

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from harness.identify.problem.problem import Problem
    from harness.recording import Case as CheckedCase
    from harness.tuning.cam import CamErrors
    from harness.tuning.tune import Tuned

RECORD, REPORT, SETTINGS = "tuning.json", "tuning.html", "tuned.toml"
FILES = (RECORD, REPORT, SETTINGS)


@dataclass(frozen=True, repr=False)
class Tuning(Summarised):
    """What `tune` found.

    Attributes:
        case: to which the engine was tuned.
        tuned: fits, decisions and held-out errors (`harness.tuning.tune.Tuned`).
        cam: CAM with the effects that a diagnosis finds, on the same held-out blocks; `None` if it is not known.
        failures: parts that failed, without which the rest was made.
        wall_time: that it took [s].
        command: what repeats it; empty if not known.
    """

    case: Case
    tuned: Tuned
    cam: CamErrors | None = None
    failures: tuple[Failed, ...] = ()
    wall_time: float = 0.0
    command: str = field(default="", compare=False)

    @property
    def verdict(self) -> str:
        """`tuned`, `nothing_to_tune` or `physics_missing`."""
        return self.tuned.verdict.value

    @property
    def sentences(self) -> tuple[str, ...]:
        """What was found, what it gains, and what to do next."""
        from harness.report.tuning.words import sentences

        return sentences(self.tuned, self.cam, str(typed_path(self.case.path)))

    @property
    def parameters(self) -> dict[str, dict[str, Any]]:
        """The fitted parameters by name: `value`, `interval` (95 %), `unit`, and whether each one `pays`."""
        found = self.tuned.selection.found
        return {
            name: {
                "value": found.values[name],
                "interval": found.interval(name),
                "unit": self.tuned.model.free[name].unit,
                "pays": name in self.tuned.selection.pays,
            }
            for name in found.names
        }

    @property
    def settings(self) -> dict[str, dict[str, Any]]:
        """Settings by engine, as `compare(settings=…)` takes them."""
        return {self.tuned.model.engine.name: self.tuned.settings}

    @property
    def settings_text(self) -> str:
        """The settings file, which `--parameters` takes; empty if nothing was tuned."""
        if not self.tuned.selection.pays:
            return ""
        from harness.tuning.settings_file import settings_text

        head = "\n".join((f"Tuned to {self.case.path} by harness tune. Give it to --parameters.", *self.sentences[:1]))
        return settings_text(self.tuned.model.engine.name, self.tuned.settings, self.tuned.scene, head)

    def summary(self) -> Summary:
        """The answer and the fitted parameters."""
        from harness.report.tuning.sections import values_table

        lines = [one.replace("`", "") for one in self.sentences]
        lines += [f"not identifiable: {one.text.replace('`', '')}" for one in self.tuned.combinations]
        tables = [values_table(self.tuned), self._left()]
        name = self.tuned.model.engine.name
        return Summary(f"Tuning of {name} on {self.case.path}", [*lines, *map(str, self.failures)], tables)

    def _left(self) -> Table:
        from harness.report.tuning.words import left_as

        selection = self.tuned.selection
        rows = [
            (name, f"{one.sensitivity:.3g}", "does not pay" if one.seen else "not seen by these recordings")
            for name, one in selection.screened.items()
            if name not in selection.found.names
        ]
        title = f"Left {left_as(self.tuned, 'at their defaults')}"
        return Table(title, [*texts("parameter"), "change of the runs [σ]", *texts("why")], rows)

    def plot(self) -> Figure:
        """Free runs over windows before and after, against the readings."""
        from harness.report.tuning.sections import drawn

        return drawn(self._subject())

    @one_blas_thread()
    def save(self, folder: str | Path | None = None, *, force: bool = False) -> Path:
        """Write tuning.json, tuning.html and, if anything was tuned, tuned.toml, all of them or none.

        Args:
            folder: to write into; `reports/<name of the case>` if none is given.
            force: replace files that no tuning wrote, or that have been changed since, too.

        Returns:
            The folder.

        Raises:
            InputError: the folder cannot be written, or a file is in the way.
        """
        folder = report_folder(self.case.path) if folder is None else Path(folder)
        inputs = input_files(self.case)
        with all_or_nothing(folder, record=RECORD, names=FILES, inputs=inputs, force=force) as scratch:
            self._write(scratch)
        return folder

    def _subject(self) -> Any:
        from harness.report.tuning.subject import Subject

        return Subject(self.tuned, self.cam, self.case, self.settings_text, self.command)

    def _write(self, folder: Path) -> tuple[Failed, ...]:
        """Into `folder`; all parts that failed."""
        from harness.report.tuning import render_tuning

        failures = Failures(self.failures)
        (folder / REPORT).write_text(render_tuning(self._subject(), failures), encoding="utf-8")
        if self.settings_text:
            (folder / SETTINGS).write_text(self.settings_text, encoding="utf-8")
        content = replace(self, failures=failures.all).content() | {"files": hashes_of(folder)}
        (folder / RECORD).write_text(sealed_json(content), encoding="utf-8")
        return failures.all

    def content(self) -> dict[str, Any]:
        """What tuning.json holds."""
        tuned, selection = self.tuned, self.tuned.selection
        held, found = tuned.held_out, selection.found
        return {
            "schema": 1,
            "command": self.command,
            "case": str(self.case.path),
            "origin": self.case.origin,
            "engine": tuned.model.engine.name,
            "verdict": self.verdict,
            "sentences": self.sentences,
            "parameters": self.parameters,
            "correlation": {"names": found.names, "matrix": found.correlation.tolist()},
            "not_identifiable": [asdict(one) for one in tuned.combinations],
            "left_at_default": {
                name: {"sensitivity": one.sensitivity, "seen": one.seen, "tried": one.tried, "failed": one.failed}
                for name, one in selection.screened.items()
                if name not in found.names
            },
            "attempts": [asdict(one) for one in selection.attempts],
            "residual_over_expected": {"before": selection.before.misfit**0.5, "after": found.misfit**0.5},
            "windows": len(tuned.windows),
            "left_out": [{"time_s": one.time, "failure": one.reason} for one in tuned.left_out],
            "held_out": None
            if held is None
            else {
                "blocks": held.blocks,
                "before_m": held.before.tolist(),
                "after_m": held.after.tolist(),
                "left_out": held.left_out,
            },
            "cam": None
            if self.cam is None
            else {
                "effects": self.cam.effects,
                "unlisted": self.cam.unlisted,
                "before_m": self.cam.before.tolist(),
                "after_m": self.cam.after.tolist(),
                "diagnosis": self.cam.source,
            },
            "rejected": None if tuned.rejected is None else asdict(tuned.rejected),
            "settings": self.settings,
            "rig": tuned.scene,
            "inputs": input_hashes(self.case),
            "versions": versions() | {tuned.model.engine.name: tuned.model.engine.version()},
            "failures": [str(one) for one in self.failures],
            "wall_time_s": round(self.wall_time, 2),
        }


@one_blas_thread()
def tune(
    case: CheckedCase | str | Path,
    *,
    engine: str = "mujoco",
    free: Sequence[str] | None = None,
    settings: Mapping[str, Mapping[str, Any]] | None = None,
    diagnosis: LoadedDiagnosis | str | Path | None = None,
    effects: Sequence[Given] = (),
    accept: Sequence[str] = (),
    out: str | Path | None = None,
    force: bool = False,
    yes: bool = False,
    jobs: int = 1,
    on: str = "",
    command: str = "",
    progress: bool | Progress = False,
) -> Tuning:
    """Fit contact and scene parameters of an engine to the recordings of a case.

    The level angle and the start of every window are fitted along. A parameter is tuned if the recordings tell it and
    it pays; the others stay at their defaults.

    Args:
        case: as of `load_case`, or its path.
        engine: `mujoco`, `pybullet` or `dart`.
        free: names of what may be tuned: settings of the engine, and quantities of the scene under their keys in
            rig.toml, as in `friction` or, with bounds of your own, `friction=0.01:0.2`; a default set if none is given.
        settings: contact parameters that stay as they are, as in `{"mujoco": {"time_step": 2e-3}}`.
        diagnosis: of the same recordings, or its folder: CAM with its effects is held against the engine. Without one
            the effects are searched for.
        effects: effects of your own that rig.toml declares, as Python files or as `Effect` objects.
        accept: codes of findings about the input that would stop it, and are meant so.
        out: folder to write into at once, checked before anything is computed; nothing is written if none is given.
        force: replace files in `out` that no tuning wrote, or that have been changed since, too.
        yes: tune although it takes longer than ten minutes or more than 4 GB of memory.
        jobs: processes that run the engine; more than 1 forks this process.
        on: `dask://host:port`, to hand the fits to a Dask cluster instead.
        command: what repeats the tuning, for the record.
        progress: show a bar on stderr, or a function to be told.

    Raises:
        InputError: anything given cannot be used; nothing has been written then.
        WorthlessInput: a finding about the input, such as a reversed sign, makes any fit worthless.
        EngineFailure: the engine fails with its settings.
    """
    begin = time.monotonic()
    check_codes(accept)
    with beside_catalogue(effects), shown(progress) as tell:
        case = case_of(case)
        refuse_worthless(case, (), accept)
        known = _known(case, diagnosis, effects)
        from harness.engines.catalogue import engine_of, parameters_of
        from harness.jobs import executor_on
        from harness.tuning.tune import check_names, free_parameters
        from harness.tuning.tune import tune as fit

        chosen = engine_of(engine, case.scene)
        idle = sorted(set(settings or {}) - {engine})
        if idle:
            raise InputError(f"parameters of {', '.join(idle)} are set, but {engine} is tuned; drop them")
        fixed = dict((settings or {}).get(engine, {}))
        check_names(chosen, fixed, free)
        if on and effects:
            raise InputError("--on: the workers of a cluster know no effects of your own; leave --effects or --on out")
        executor = executor_on(on) if on else None
        given = (*input_files(case), *files_of(effects))
        writing = partial(all_or_nothing, record=RECORD, names=FILES, inputs=given, force=force)
        # Entered first: what cannot be written need not be computed.
        with nullcontext() if out is None else writing(Path(out)) as scratch:
            tell("drives and rig", share=0.0)
            from harness.identify.pose import problem_of

            problem = problem_of(case)
            names = free_parameters(problem, chosen, fixed, free)
            durations = [one.time[-1] - one.time[0] for one in problem.recordings]
            seconds = tuning_time(durations, len(names), chosen, fixed, jobs)
            used = [case.recordings[name] for name in case.identify]
            memory = tuning_memory(used, parameters_of(chosen, fixed).time_step, jobs)
            remedy = "set a longer time_step, free fewer parameters, or list fewer or shorter recordings"
            ask(seconds, memory, remedy, yes=yes)
            tuned = fit(problem, chosen, fixed, free, tell, jobs=jobs, executor=executor)
            failures = Failures(tuned.failures)
            cam = None
            if tuned.held_out is not None:
                job = partial(_cam, problem, known, Stage(tell, 0.9, 0.97, 20.0), jobs)
                cam = attempt(failures, Part.SEARCH, "effects of CAM", job, None)
            made = Tuning(case, tuned, cam, failures.all, time.monotonic() - begin, command)
            if scratch is not None:
                tell("report", share=0.97)
                made = replace(made, failures=made._write(scratch))
    return made


def _known(case: Case, diagnosis: LoadedDiagnosis | str | Path | None, effects: Sequence[Given]) -> Any:
    """The diagnosis, refused if it was made from other recordings."""
    if diagnosis is None:
        return None
    kept = diagnosis if isinstance(diagnosis, LoadedDiagnosis) else load_diagnosis(diagnosis, effects=effects)
    hashes = {name: case.recordings[name].sha256 for name in case.identify}
    made = {name: kept.record.inputs.hashes.get(name) for name in kept.record.problem.recordings}
    if made != hashes:
        raise InputError(
            f"{kept.origin}: was made from other recordings than {case.path}; diagnose this case, or leave "
            "--diagnosis out"
        )
    return kept


def _cam(problem: Problem, known: LoadedDiagnosis | None, progress: Progress, jobs: int) -> CamErrors | None:
    from harness.tuning.cam import cam_of_record, cam_of_search

    if known is None:
        return cam_of_search(problem, progress, jobs=jobs)
    return cam_of_record(known.record, str(known.origin))
