"""One recording through every model and engine: tables, plot, report."""

from __future__ import annotations

import math
import re
import time
from collections.abc import Mapping, Sequence
from contextlib import nullcontext
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from harness.api.case import Case, case_of, input_files
from harness.api.effects import Given, beside_catalogue, files_of
from harness.api.effort import ask, comparison_time
from harness.api.memory import comparison_memory
from harness.api.outputs import report_folder, sealed_json
from harness.api.progress import shown
from harness.api.writing import all_or_nothing, hashes_of
from harness.errors import EngineFailure, InputError
from harness.failures import Failed, Failures
from harness.progress import Progress
from harness.report.tables import Summarised, Summary, Table, texts
from harness.threads import one_blas_thread

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

    from analytic.motion import State
    from harness.comparison import Choices, Study
    from harness.engines.parameters import EngineParameters
    from harness.engines.protocol import Engine
    from harness.metrics import OwnMetric
    from harness.recording import Case as CheckedCase
    from harness.recording import Recording
    from harness.scene import Scene
    from harness.tolerances import Checked, Tolerances

REPORT = "report.html"
MANIFEST = "manifest.json"
FILES = (REPORT, "trajectories.csv", "metrics.csv", MANIFEST)
HEADS = ("source", "RMS [mm]", "max [mm]", "fit [%]", "E/u_val", "ISO 18571")


@dataclass(frozen=True, repr=False)
class Comparison(Summarised):
    """What `compare` found.

    Attributes:
        case: what was compared.
        study: every run, score and attribution (`harness.comparison.Study`).
        checks: outcome of every tolerance, if `check` was asked for.
        limits: the tolerances, likewise.
        wall_time: that it took [s].
        command: what repeats it; empty if not known.
        report_failures: sections of the written report that failed.
        own_metrics: values of your own metrics by name, in the order of the rows of `scores`.
    """

    case: Case
    study: Study
    checks: tuple[Checked, ...] = ()
    limits: Tolerances | None = None
    wall_time: float = 0.0
    command: str = field(default="", compare=False)
    report_failures: tuple[Failed, ...] = field(default=(), compare=False)
    own_metrics: Mapping[str, tuple[float, ...]] = field(default_factory=dict)

    @property
    def scores(self) -> pd.DataFrame:
        """One row a source and horizon; columns as in metrics.csv, your own metrics last."""
        from harness.api.outputs import metrics

        return metrics(self.study, self.own_metrics)

    @property
    def trajectories(self) -> pd.DataFrame:
        """`time_s`, `measured_m`, then one column a source [m]; the whole recording as one free run."""
        from harness.api.outputs import trajectories

        return trajectories(self.study)

    @property
    def failures(self) -> tuple[EngineFailure, ...]:
        """Every engine run that failed."""
        return self.study.failures

    @property
    def answer(self) -> tuple[str, ...]:
        """Which model to trust, how far, and why, in sentences."""
        from harness.report.answer import answer

        return answer(self.study)

    def summary(self) -> Summary:
        """The answer and the scores on the headline horizon."""
        source, *numbers = HEADS
        rows = headline_rows(self.study)
        if self.own_metrics:
            shown = self.scores[self.scores["horizon"] == self.study.headline.name].set_index("source")
            own = [[f"{float(shown[name][row[0]]):.4g}" for name in self.own_metrics] for row in rows]
            rows = [(*row, *more) for row, more in zip(rows, own, strict=True)]
        heads = [*texts(source), *numbers, *self.own_metrics]
        table = Table(f"Horizon: {self.study.headline.name}", heads, rows)
        return Summary(f"Comparison of {self.study.setting.recording.path}", self.answer, [table])

    def plot(self) -> Figure:
        """The recording against all sources, on the horizon of the answer."""
        from harness.report.comparison.overlay import drawn
        from harness.report.comparison.subject import Subject

        return drawn(Subject(self.study, {}, self.checks, self.command), self.study.headline)

    def save(self, folder: str | Path | None = None, *, force: bool = False) -> Path:
        """Write report.html, trajectories.csv, metrics.csv and manifest.json, all of them or none.

        Args:
            folder: to write into; `reports/<name of the case>` if none is given.
            force: replace files that no comparison wrote, or that have been changed since, too.

        Returns:
            The folder.

        Raises:
            InputError: the folder cannot be written, or a file is in the way.
        """
        folder = report_folder(self.case.path) if folder is None else Path(folder)
        inputs = input_files(self.case)
        with all_or_nothing(folder, record=MANIFEST, names=FILES, inputs=inputs, force=force) as scratch:
            self._write(scratch)
        return folder

    def _write(self, folder: Path) -> tuple[Failed, ...]:
        """Into `folder`; the sections of the report that failed."""
        from harness.api.outputs import manifest, write_tables
        from harness.report.comparison import render_comparison

        write_tables(self.study, folder, self.own_metrics)
        facts = manifest(self.study, command=self.command, wall_time=self.wall_time)
        failures = Failures()
        page = render_comparison(self.study, facts, checks=self.checks, failures=failures)
        (folder / REPORT).write_text(page, encoding="utf-8")
        facts["failures"] += map(str, failures.all)
        facts["files"] = hashes_of(folder)
        (folder / MANIFEST).write_text(sealed_json(facts), encoding="utf-8")
        return failures.all


@one_blas_thread()
def compare(
    case: CheckedCase | str | Path,
    *,
    recording: str | None = None,
    engines: Sequence[str | Engine] = (),
    settings: Mapping[str, Mapping[str, Any]] | None = None,
    start: State | tuple[float, float] | None = None,
    level_angle: float | Literal["estimate"] | None = None,
    windows: Sequence[float] = (),
    tube: float = 0.010,
    seed: int = 0,
    check: bool = False,
    tolerances: str | Path | None = None,
    effects: Sequence[Given] = (),
    metrics: Mapping[str, OwnMetric] | None = None,
    out: str | Path | None = None,
    force: bool = False,
    yes: bool = False,
    command: str = "",
    progress: bool | Progress = False,
) -> Comparison:
    """Drive every model and engine with the recorded beam angle and score them against the recording.

    Args:
        case: as of `load_case`, or its path.
        recording: which one of the case; the first to identify from if none is named.
        engines: `mujoco`, `pybullet`, `dart`, or objects of your own engines (`harness.engines.protocol.Engine`); the
            first two, and those with settings, if none is named.
        settings: contact parameters by engine, as in `{"mujoco": {"friction": 0.3}}`.
        start: of the ball at the first stamp, position [m] and velocity [m/s]; estimated if none is given.
        level_angle: α₀ [rad], or "estimate"; as rig.toml says if none is given.
        windows: lengths of the windows [s]; 1, 2 and 5 s if none is given.
        tube: half width of the tolerance tube [m].
        seed: of the draws that propagate uncertainty.
        check: hold the result to tolerances.
        tolerances: file of limits to check; those of the case, else the package's, if none is given.
        effects: effects of your own that rig.toml declares, as Python files or as `Effect` objects.
        metrics: metrics of your own by name, which ends in the unit: functions of a `harness.metrics.RunComparison`
            (one run beside the measurement) that return a number, NaN where it is undefined. Of several windows the
            median counts.
        out: folder to write into at once, checked before anything is computed; nothing is written if none is given.
        force: replace files in `out` that no comparison wrote, or that have been changed since, too.
        yes: compare although it takes longer than ten minutes or more than 4 GB of memory.
        command: what repeats the comparison, for the manifest.
        progress: show a bar on stderr, or a function to be told.

    Raises:
        InputError: anything given cannot be used; nothing has been written then. An engine that fails raises nothing:
            see `Comparison.failures`.
    """
    begin = time.monotonic()
    with beside_catalogue(effects), shown(progress) as tell:
        case = case_of(case)
        tell("loading engines", share=0.0)
        from analytic.motion import State
        from harness.comparison import Choices, prepare, study
        from harness.metrics import check_names
        from harness.tolerances import check as held_to
        from harness.tolerances import tolerances_for

        chosen = _choose_engines(engines, settings or {}, case.scene)
        limits = None
        if check or tolerances is not None:
            limits = tolerances_for(case.path, None if tolerances is None else Path(tolerances))
            if engines:  # limits on engines that the user left out are not what was asked
                limits = limits.without(set(limits.engines) - {one.name for one, _ in chosen})
        choices = Choices(
            recording=recording,
            start=State(*start) if isinstance(start, tuple) else start,
            level_angle=level_angle,
            lengths=tuple(windows) or Choices.lengths,
            tolerance=tube,
            seed=seed,
        )
        if limits is not None:
            choices = limits.applied_to(choices)
        check_names(metrics or {})
        _check_numbers(case, recording, chosen, choices)
        seconds = comparison_time(_longest(case, recording), chosen, choices)
        memory = max(comparison_memory(one, chosen, choices) for one in _compared(case, recording))
        remedy = "set a longer time_step, compare fewer engines, or longer windows, or choose a shorter recording"
        ask(seconds, memory, remedy, yes=yes)
        given = (*files_of(effects), *([] if tolerances is None else [Path(tolerances)]))
        writing = partial(all_or_nothing, record=MANIFEST, names=FILES, inputs=(*input_files(case), *given))
        # Entered first: what cannot be written need not be computed.
        with nullcontext() if out is None else writing(Path(out), force=force) as scratch:
            tell("drive and measured state", share=0.05)
            result = study(prepare(case, choices), chosen, tell)
            checks = tuple(held_to(result, limits)) if limits is not None else ()
            own = result.own_metrics(metrics or {})
            made = Comparison(case, result, checks, limits, time.monotonic() - begin, command, own_metrics=own)
            if scratch is not None:
                tell("report", share=0.8)
                made = replace(made, report_failures=made._write(scratch))
    return made


def _check_numbers(
    case: Case, recording: str | None, engines: Sequence[tuple[Engine, EngineParameters]], choices: Choices
) -> None:
    """Refuse numbers that cannot be, and time steps of which memory does not hold a run."""
    from harness.engines.leapfrog import check_steps

    for name, values in (("tube", (choices.tolerance,)), ("windows", choices.lengths)):
        for value in values:
            if not (math.isfinite(value) and value > 0.0):
                raise InputError(f"{name}: {value:g} is not a finite length; give a positive number")
    if choices.seed < 0:
        raise InputError(f"seed: {choices.seed} is negative; give 0 or more")
    longest = _longest(case, recording)
    for engine, parameters in engines:
        # The numerical error is told by runs with half the step.
        check_steps(2.0 * longest, parameters.time_step, f"{engine.name}.time_step")


def _longest(case: Case, recording: str | None) -> float:
    """Duration of the recording to compare; of the longest, where none is named [s]."""
    return max(float(one.time[-1] - one.time[0]) for one in _compared(case, recording))


def _compared(case: Case, recording: str | None) -> list[Recording]:
    """The recording to compare; all that it may be, where none is named."""
    return [case.recordings[recording]] if recording in case.recordings else list(case.recordings.values())


def headline_rows(study: Study) -> list[tuple[str, ...]]:
    """The scores of every source on the headline horizon, as texts under `HEADS`."""
    scores = [study.score_of(name, study.headline) for name in study.sources]
    return [
        (
            one.source,
            f"{one.rms_error_mm:.2f}",
            f"{1e3 * one.max_error_m:.2f}",
            f"{one.fit_percent:.1f}",
            f"{one.rms_error_over_uncertainty:.1f}",
            f"{one.iso18571_rating:.2f}",
        )
        for one in scores
    ]


def _choose_engines(
    given: Sequence[str | Engine], settings: Mapping[str, Mapping[str, Any]], scene: Scene | None
) -> list[tuple[Engine, EngineParameters]]:
    """Those that are given; else the default ones and whichever has settings. All settings are checked."""
    from harness.engines.catalogue import DEFAULT_ENGINES, engine_of, parameters_of

    own = _own_engines([one for one in given if not isinstance(one, str)])
    names = [one if isinstance(one, str) else one.name for one in given]
    idle = sorted(set(settings) - set(names)) if names else []
    if idle:
        raise InputError(f"parameters of {', '.join(idle)} are set, but --engine leaves it out; name it or drop them")
    wanted = dict.fromkeys((*(names or DEFAULT_ENGINES), *settings))
    engines = {name: own[name] if name in own else engine_of(name, scene) for name in wanted}
    checked = {name: parameters_of(engine, settings.get(name, {})) for name, engine in engines.items()}
    return [(engines[name], checked[name]) for name in dict.fromkeys(names or engines)]


def _own_engines(given: Sequence[Engine]) -> dict[str, Engine]:
    """Engines of the user's own by name, which becomes that of columns: no other source may have it."""
    if not given:
        return {}
    from harness.engines.protocol import Engine
    from harness.tolerances.file import SOURCES

    own: dict[str, Engine] = {}
    for one in given:
        if not isinstance(one, Engine):
            made = f"; make an object of it: {one.__name__}()" if isinstance(one, type) else ""
            raise InputError(f"engines: {one!r} is neither a name nor a harness.engines.protocol.Engine{made}")
        name = getattr(one, "name", "")
        if not re.fullmatch(r"[a-z][a-z0-9_]*", name):
            raise InputError(f"engines: {name!r} cannot be the name of an engine; use lower case, digits and _")
        if name in SOURCES or name in own:
            raise InputError(f"engines: the name {name!r} is taken; choose another for {type(one).__name__}")
        own[name] = one
    return own
