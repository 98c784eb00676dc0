"""`python -m benchmarks.tuning`: whether `harness tune` recovers what was planted, and says nothing where nothing was.

Writes the tables of `docs/tuning.md`. One recording of 8 s at 50 Hz, angle in counts of 4096 a turn, position with
0.3 mm of noise in steps of 0.1 mm; MuJoCo is tuned with its default set of free parameters. The plant is the virtual
rig, whose contact shares no equation with the engine, or MuJoCo itself.
"""

from __future__ import annotations

import contextlib
import io
import json
import math
import tempfile
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path

import click
import numpy as np
from scipy.stats import binomtest

from analytic.geometry import rails_of
from analytic.motion import FloatArray, State
from analytic.rig import Rig
from benchmarks.sections import put
from harness.engines.catalogue import engine_of, parameters_of
from harness.engines.mujoco_parameters import MuJoCoParameters
from harness.identify.pose import problem_of
from harness.identify.problem.problem import Problem
from harness.parallel import side_by_side
from harness.provenance import code_digest
from harness.recording import load_case
from harness.simulator import Experiment, write_case
from harness.simulator.plant import Plant, Run
from harness.tuning.estimate.fit import Fitted
from harness.tuning.estimate.free import LEVEL, free_of, level_of
from harness.tuning.estimate.runs import Model
from harness.tuning.estimate.selection import select
from harness.tuning.estimate.windows import fitted_stretches
from mjcf.scene import make_scene

_ROWS, _DOCS = Path("build/calibration/tuning.jsonl"), Path("docs")
_USER_CODE = Path(__file__).with_name("tuning_sysid.py")
_STEP = 2e-3  # of the tuned engine [s]
_CREEP = 10.0  # rate at which the plant's contact removes slip, in any step [1/s]
_FIRST_SEED = 710_000  # none of these was seen while anything was chosen
_SOURCES = ("harness/tuning/estimate", "harness/engines", "harness/simulator", "harness/signals", "mjcf", "analytic")


@dataclass(frozen=True)
class Kind:
    """What is planted.

    Attributes:
        title: in the table.
        parameter: of the engine; empty if none.
        low, high: between which it is drawn, evenly on a logarithmic scale.
        plant: `_RIG`, or a key of `_ENGINES`.
        count: how many trials there are.
    """

    title: str
    parameter: str
    low: float
    high: float
    plant: str
    count: int


_RIG = "virtual rig"
# Steps of the engine as a plant [s]. With finer steps than the tuned engine's a ball that slides leaves the rails.
_ENGINES = {"MuJoCo at a quarter of the step": 5e-4, "MuJoCo at the same step": _STEP}
_QUARTER, _SAME = _ENGINES
KINDS: Mapping[str, Kind] = {
    "rolling": Kind("rolling friction, level", "rolling_friction", 5e-5, 2e-4, _QUARTER, 100),
    "nothing": Kind("nothing", "", 0.0, 0.0, _RIG, 100),
    "coulomb": Kind("rolling resistance by Coulomb's law, level", "rolling_friction", 5e-5, 2e-4, _RIG, 20),
    "slip": Kind("friction near slip, level", "friction", 0.0075, 0.011, _RIG, 100),
    "sliding": Kind("friction near slip, level", "friction", 0.0075, 0.011, _SAME, 100),
}


@dataclass(frozen=True)
class Trial:
    """One simulated rig: its kind and number."""

    kind: str
    number: int

    @property
    def seed(self) -> int:
        """Of everything random in it."""
        return _FIRST_SEED + 1000 * (1 + list(KINDS).index(self.kind)) + self.number

    @property
    def planted(self) -> dict[str, float]:
        """The truth, by the engine's names; nothing else acts."""
        kind = KINDS[self.kind]
        if not kind.parameter:
            return {}
        generator = np.random.default_rng((self.seed, 7))
        size = np.exp(generator.uniform(np.log(kind.low), np.log(kind.high)))
        level = generator.choice((-1.0, 1.0)) * generator.uniform(1e-3, 4e-3)
        return {kind.parameter: float(size), LEVEL: float(level)}


@dataclass(frozen=True)
class Row:
    """What came out of a trial: selected parameters, values and intervals by name, time [s]."""

    kind: str
    number: int
    planted: dict[str, float]
    pays: tuple[str, ...]
    values: dict[str, float]
    intervals: dict[str, tuple[float, float]]
    excess: float
    seconds: float
    error: str = ""
    how: str = "tune"

    def covers(self, name: str) -> bool:
        """Whether the interval of a parameter that was found holds the truth."""
        if name not in self.intervals:
            return False
        low, high = self.intervals[name]
        return low <= self.planted[name] <= high


def problem(trial: Trial) -> Problem:
    """The recording of a trial, posed by the same door as anybody's data."""
    kind, planted, rig = KINDS[trial.kind], trial.planted, Rig()
    hidden: dict[str, dict[str, float]] = {}
    if LEVEL in planted:
        hidden["level_error"] = {"angle": planted[LEVEL]}
    if kind.parameter == "friction":
        hidden["contact_slip"] = {"friction_coefficient": planted["friction"]}
    if kind.parameter == "rolling_friction":
        hidden["rolling_resistance"] = {"coefficient": planted["rolling_friction"] / rig.rolling_radius}
    experiment = Experiment(
        rig=rig, hidden=hidden, duration=8.0, counts=4096, rate=50.0, identify=1, predict=0, seed=trial.seed
    )
    mover = partial(_engine_moves, planted, _ENGINES[kind.plant]) if kind.plant in _ENGINES else None
    with tempfile.TemporaryDirectory(prefix="tuning-") as folder:
        write_case(Path(folder) / "case", experiment, experiment.recordings(mover))
        return problem_of(load_case(Path(folder) / "case"))


def _engine_moves(
    planted: Mapping[str, float], step: float, run: Run, plant: Plant, start: State, stamps: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """The ball of MuJoCo with what is planted, on the beam that the run drove."""
    engine = engine_of("mujoco")
    settings = {"time_step": step, "slip_limit": 10.0}
    settings |= {name: value for name, value in planted.items() if name != LEVEL}
    if "rolling_friction" in planted:
        settings |= {"condim": 6, "torsional_friction": 1e-5, "friction_relaxation": _CREEP * step}
    parameters = parameters_of(engine, settings)
    moved = engine.run(plant.rig, run.beam_motion, start, stamps, parameters=parameters).trajectory
    return moved.position, moved.velocity


def tuned(trial: Trial) -> Row:
    """Carry out a trial, and tune."""
    try:
        posed = problem(trial)
        begin = time.process_time()
        engine = engine_of("mujoco")
        base = parameters_of(engine, {"time_step": _STEP})
        free = {one.name: one for one in (level_of(posed.rig), *free_of(engine, posed.rig, base, None))}
        model = Model(engine, posed, {"time_step": _STEP}, free)
        done = select(model, fitted_stretches(posed), [name for name in free if name != LEVEL])
    except Exception as error:
        return Row(trial.kind, trial.number, trial.planted, (), {}, {}, np.nan, 0.0, f"{type(error).__name__}: {error}")
    found = done.found
    intervals = {name: found.interval(name) for name in found.names}
    return Row(
        trial.kind, trial.number, trial.planted, done.pays, found.values, intervals, _excess(found),
        time.process_time() - begin,
    )  # fmt: skip


def _excess(found: Fitted) -> float:
    return float(np.sqrt(found.misfit))


def digest() -> str:
    """Of the sources that decide what comes out of a trial."""
    return code_digest(packages=_SOURCES)


def kept_rows(path: Path, source: str) -> dict[tuple[str, int, str], Row]:
    """Rows of these sources, by kind, number and method."""
    kept = {}
    for text in path.read_text(encoding="utf-8").splitlines() if path.exists() else ():
        try:
            record = json.loads(text)
        except ValueError:  # cut short by the end of a run
            continue
        if record["source"] == source:
            record["row"].pop("more", None)
            row = Row(**record["row"])
            kept[row.kind, row.number, row.how] = row
    return kept


def run(
    trials: Iterable[Trial], how: str, measure: Callable[[Trial], Row], path: Path, source: str, workers: int
) -> list[Row]:
    """Rows of all these trials; those that are missing in the file are added to it as they come."""
    trials = list(trials)
    kept = kept_rows(path, source)
    missing = [one for one in trials if (one.kind, one.number, how) not in kept]
    path.parent.mkdir(parents=True, exist_ok=True)
    for at in range(0, len(missing), workers):
        batch = missing[at : at + workers]
        for row in side_by_side([partial(measure, one) for one in batch], workers):
            kept[row.kind, row.number, how] = row
            with path.open("a", encoding="utf-8") as file:
                file.write(json.dumps({"source": source, "row": asdict(row)}) + "\n")
        click.echo(f"{how}: {at + len(batch)} of {len(missing)}", err=True)
    return [kept[one.kind, one.number, how] for one in trials]


def by_sysid(trial: Trial) -> Row:
    """The same recording, handed to `mujoco.sysid`."""
    from benchmarks.tuning_sysid import fit_by_sysid

    try:
        posed = problem(trial)
        begin = time.process_time()
        settings = MuJoCoParameters(time_step=_STEP)
        rig, recording = posed.rig, posed.recordings[0]
        option, pair = settings.option(rig), settings.pair(rig)
        scene = make_scene(rig, channel=rails_of(rig), option=option, pair=pair, driven=True)
        angle = recording.drive.states[:, 0]
        with contextlib.redirect_stdout(io.StringIO()):  # SciPy's own progress
            values, intervals = fit_by_sysid(scene, rig.rolling_radius, recording.time, angle, recording.reading)
    except Exception as error:
        text = f"{type(error).__name__}: {error}"
        return Row(trial.kind, trial.number, trial.planted, (), {}, {}, np.nan, 0.0, text, "sysid")
    used = time.process_time() - begin
    return Row(trial.kind, trial.number, trial.planted, tuple(values), values, intervals, np.nan, used, "", "sysid")


def recovery(rows: Sequence[Row]) -> str:
    """The table of recovered parameters: found, bias, width and coverage."""
    lines = [
        "| planted | plant | parameter | carried out | found | mean error | standard error of it | median half-width | "
        "intervals that hold the truth |",
        "|---|---|---|---:|---:|---:|---:|---:|---:|",
    ]
    for key, kind in KINDS.items():
        of_kind = [row for row in rows if row.kind == key and not row.error]
        for name in (kind.parameter, LEVEL) if kind.parameter and of_kind else ():
            lines.append(f"| {kind.title} | {kind.plant} | `{name}` | {_recovered(of_kind, name)} |")
    return "\n".join(lines)


def _recovered(rows: Sequence[Row], name: str) -> str:
    """Cells of one parameter; errors and widths relative to the truth."""
    found = [row for row in rows if name in row.pays]
    if not found:
        return f"{len(rows)} | 0 | — | — | — | —"
    truth = np.array([abs(row.planted[name]) for row in found])
    error = np.array([abs(row.values[name]) for row in found]) / truth - 1.0
    half = np.array([0.5 * (row.intervals[name][1] - row.intervals[name][0]) for row in found]) / truth
    hold = sum(row.covers(name) for row in found)
    test = binomtest(hold, len(found)).proportion_ci(method="exact")
    spread = f"{np.std(error, ddof=1) / math.sqrt(len(found)):.2%}" if len(found) > 1 else "—"
    share = f"{hold / len(found):.0%} ({test.low:.0%}–{test.high:.0%})"
    return f"{len(rows)} | {len(found)} | {np.mean(error):+.2%} | {spread} | {np.median(half):.2%} | {share}"


def quiet(rows: Sequence[Row]) -> str:
    """How often nothing was tuned where nothing was planted."""
    clean = [row for row in rows if row.kind == "nothing" and not row.error]
    silent = sum(not row.pays for row in clean)
    test = binomtest(silent, max(len(clean), 1)).proportion_ci(method="exact")
    wrong = sorted({name for row in clean for name in row.pays})
    also = f"; otherwise {', '.join(f'`{name}`' for name in wrong)}" if wrong else ""
    return f"Nothing planted: in {silent} of {len(clean)} ({test.low:.0%}–{test.high:.0%}) nothing was tuned{also}."


def side_by_side_table(tuned_rows: Sequence[Row], sysid_rows: Sequence[Row]) -> str:
    """Both on the same recordings, with friction and level planted."""
    other = {row.number: row for row in sysid_rows if not row.error}
    both = [row for row in tuned_rows if row.kind == "slip" and not row.error and row.number in other]
    sources = {"`harness tune`": both, "`mujoco.sysid`": [other[row.number] for row in both]}
    lines = [
        "| | parameter | recordings | found | mean error | standard error of it | median half-width | "
        "intervals that hold the truth |",
        "|---|---|---:|---:|---:|---:|---:|---:|",
    ]
    lines += [
        f"| {title} | `{name}` | {_recovered(rows, name)} |"
        for title, rows in sources.items()
        for name in ("friction", LEVEL)
    ]
    ratio = float(np.median([row.seconds / other[row.number].seconds for row in both])) if both else math.nan
    user = len(_USER_CODE.read_text(encoding="utf-8").splitlines())
    lines += [
        "",
        f"`harness tune` took {ratio:.1f} times the processor time of `mujoco.sysid` (median, each pair on the same "
        f"machine): it screens four parameters and fits several sets and starts, where `mujoco.sysid` fits the two "
        f"that it is told. Lines to write: 1 against {user} (`benchmarks/tuning_sysid.py`).",
    ]
    return "\n".join(lines)


@click.command()
@click.option("--count", default=100, show_default=True, help="Trials of each kind.")
@click.option("--jobs", default=2, show_default=True, help="Processes.")
@click.option("--rows", "path", default=_ROWS, show_default=True, type=click.Path(path_type=Path), help="Kept rows.")
@click.option("--docs", default=_DOCS, show_default=True, type=click.Path(path_type=Path), help="The page is there.")
@click.option("--kept", is_flag=True, help="Write the tables from the rows that there are; carry out no trial.")
def main(count: int, jobs: int, path: Path, docs: Path, kept: bool) -> None:
    """Tune simulated rigs with planted parameters, and `mujoco.sysid` on the same recordings.

    Rows are kept; a run that was stopped goes on where it was.
    """
    source = digest()
    trials = [Trial(kind, number) for number in range(count) for kind, one in KINDS.items() if number < one.count]
    if not kept:
        run(trials, "tune", tuned, path, source, jobs)
        run([one for one in trials if one.kind == "slip"], "sysid", by_sysid, path, source, jobs)
    rows = kept_rows(path, source)
    tune_rows = [row for (_, _, how), row in rows.items() if how == "tune"]
    sysid_rows = [row for (_, _, how), row in rows.items() if how == "sysid"]
    failed = [row for row in tune_rows if row.error]
    page = docs / "tuning.md"
    text = page.read_text(encoding="utf-8") if page.exists() else ""
    head = (
        f"Generated by `python -m benchmarks.tuning` (digest of the sources: `{source}`). Simulated, with seeds not "
        "seen before."
    )
    count_lost = "One trial" if len(failed) == 1 else f"{len(failed)} trials"
    lost = f"\n\n{count_lost} could not be carried out: {failed[0].error}" if failed else ""
    title = "Tuning an engine"
    text = put("recovery", f"{head}\n\n{recovery(tune_rows)}\n\n{quiet(tune_rows)}{lost}", text, title=title)
    text = put("sysid", f"{head}\n\n{side_by_side_table(tune_rows, sysid_rows)}", text, title=title)
    page.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
