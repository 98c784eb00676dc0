"""The plan: every run by its number, made when it is asked for, so that a million of them takes no memory."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from scipy.stats import qmc

from analytic.motion import FloatArray
from harness.engines.catalogue import engine_of
from harness.errors import InputError
from harness.recording import Case
from harness.recording.case import load_case
from harness.scene import Scene
from harness.sweeps.factors import RIG, RIG_KEYS, Factor
from harness.sweeps.ranges import Value
from harness.sweeps.spec import GRID, SOBOL, Spec

MOST_RUNS = 100_000_000


@dataclass(frozen=True)
class Run:
    """One run.

    Attributes:
        number: counted from 0.
        case: number of its case.
        recording: name of its recording.
        source: model or engine.
        point: number of the combination of values within the source.
        values: by factor.
    """

    number: int
    case: int
    recording: str
    source: str
    point: int
    values: Mapping[str, Value]


@dataclass(frozen=True)
class Design:
    """The points of one source: listed values are crossed, ranges sampled; the sampled points vary fastest.

    Attributes:
        listed: factors with values, crossed.
        ranged: factors with ranges; in a grid they are among the listed.
        samples: of the ranges, values, shape (n, len(ranged)); (1, 0) without any.
    """

    listed: tuple[Factor, ...]
    ranged: tuple[Factor, ...]
    samples: FloatArray

    @cached_property
    def shape(self) -> tuple[int, ...]:
        """How many values each listed factor has, and the number of samples."""
        return (*(len(one.levels) for one in self.listed), len(self.samples))

    def __len__(self) -> int:
        return math.prod(self.shape)

    def values(self, point: int) -> dict[str, Value]:
        """The values at a point, by factor."""
        *where, sample = (int(one) for one in np.unravel_index(point, self.shape))
        made = {one.name: one.levels[at] for one, at in zip(self.listed, where, strict=True)}
        return made | {one.name: float(x) for one, x in zip(self.ranged, self.samples[sample], strict=True)}


@dataclass(frozen=True)
class Plan:
    """All runs of a sweep.

    Attributes:
        spec: what was asked for.
        recordings: number of the case and name of each recording.
        durations: of these recordings, shape (recordings,) [s].
        inputs: SHA-256 of every file that was read, by path.
        files: their paths.
        simulated: whether each case says that it is simulated.
        scenes: of the user's own, one entry a case; `None` where it has none.
        designs: by source.
    """

    spec: Spec
    recordings: tuple[tuple[int, str], ...]
    durations: tuple[float, ...]
    inputs: Mapping[str, str]
    files: tuple[Path, ...]
    simulated: tuple[bool, ...]
    scenes: tuple[Scene | None, ...]
    designs: Mapping[str, Design]

    @cached_property
    def per_recording(self) -> int:
        """Runs of one recording."""
        return sum(map(len, self.designs.values()))

    def __len__(self) -> int:
        return len(self.recordings) * self.per_recording

    @property
    def names(self) -> tuple[str, ...]:
        """All factors, in the order of the file."""
        return tuple(dict.fromkeys(one.name for every in self.spec.factors.values() for one in every))

    def run(self, number: int) -> Run:
        """The run of this number."""
        at, rest = divmod(number, self.per_recording)
        case, recording = self.recordings[at]
        for source, design in self.designs.items():
            if rest < len(design):
                return Run(number, case, recording, source, rest, design.values(rest))
            rest -= len(design)
        raise IndexError(number)

    def batches(self, missing: Iterable[int], most: int) -> Iterator[list[Run]]:
        """The runs of these numbers, ascending, at most so many together, of one recording and source."""
        batch: list[Run] = []
        for number in missing:
            run = self.run(number)
            first = batch[0] if batch else run
            if len(batch) == most or (run.case, run.recording, run.source) != (
                first.case,
                first.recording,
                first.source,
            ):
                yield batch
                batch = []
            batch.append(run)
        if batch:
            yield batch


def plan_of(spec: Spec) -> Plan:
    """All runs of a sweep; every recording is read once.

    Raises:
        InputError: a case cannot be read, a recording is not in it, or there are more than `MOST_RUNS` runs.
    """
    recordings: list[tuple[int, str]] = []
    durations: list[float] = []
    inputs: dict[str, str] = {}
    files: list[Path] = []
    simulated = []
    scenes = []
    for number, (written, path) in enumerate(zip(spec.case_names, spec.cases, strict=True)):
        try:
            case = load_case(path)
        except InputError as error:
            raise InputError(f"{spec.path}: cases: {error}") from error
        simulated.append(case.simulated)
        scenes.append(case.scene)
        _check_scene(spec, case)
        if case.sha256:
            inputs[f"{written}: rig.toml"] = case.sha256
        if case.scene is not None:
            inputs |= {f"{written}: {name}": sha256 for name, sha256 in case.scene.sha256.items()}
            files += case.scene.files
        for name in _chosen(spec, path, (*case.identify, *case.recordings), tuple(case.recordings)):
            one = case.recordings[name]
            recordings.append((number, name))
            durations.append(float(one.time[-1] - one.time[0]))
        for name, one in case.recordings.items():
            inputs[f"{written}: {name}"] = one.sha256
            files.append(one.path)
    designs = {source: _design(spec, factors) for source, factors in spec.factors.items()}
    plan = Plan(
        spec,
        tuple(recordings),
        tuple(durations),
        inputs,
        tuple(files),
        tuple(simulated),
        tuple(scenes),
        designs,
    )
    if len(plan) > MOST_RUNS:
        raise InputError(
            f"{spec.path}: {len(plan):.3g} runs are more than {MOST_RUNS:.0e}; sweep fewer values or points."
        )
    return plan


def _check_scene(spec: Spec, case: Case) -> None:
    """Refuse to vary what the scene of a case has fixed.

    Raises:
        InputError: a factor is no parameter of that scene.
    """
    for source, factors in spec.factors.items():
        if case.scene is None or case.scene.file_of(source) is None:
            continue
        fields = engine_of(source, case.scene).parameters.model_fields
        for factor in factors:
            table, _, key = factor.name.partition(".")
            # whatever scene it is, gravity acts along the level
            fixed = table == RIG and RIG_KEYS[key] != "level_angle"
            if fixed or (table == source and key not in fields):
                raise InputError(
                    f"{spec.path}: {factor.name} is fixed in {case.scene.file_of(source)}, the scene of {case.path}; "
                    "drop it, or change it there."
                )


def _chosen(spec: Spec, path: Path, order: tuple[str, ...], every: tuple[str, ...]) -> tuple[str, ...]:
    if spec.recordings == "first":
        return order[:1]
    if spec.recordings == "all":
        return every
    for name in spec.recordings:
        if name not in every:
            raise InputError(f"{spec.path}: {path} has no recording {name!r}; it has {', '.join(every)}.")
    return tuple(spec.recordings)


def _design(spec: Spec, factors: tuple[Factor, ...]) -> Design:
    ranged = tuple(one for one in factors if one.range is not None and spec.design != GRID)
    listed = tuple(one for one in factors if one not in ranged)
    if not ranged:
        return Design(listed, (), np.empty((1, 0)))
    shares = _shares(spec, len(ranged))
    return Design(listed, ranged, np.column_stack([one.at(shares[:, i]) for i, one in enumerate(ranged)]))


def _shares(spec: Spec, dimensions: int) -> FloatArray:
    """Points in the unit cube, shape (n, dimensions)."""
    size = spec.size or 1
    if spec.indices:
        from SALib.sample import sobol  # imports pandas

        problem = {
            "num_vars": dimensions,
            "names": [str(i) for i in range(dimensions)],
            "bounds": [[0.0, 1.0]] * dimensions,
        }
        return sobol.sample(problem, size, calc_second_order=False, seed=spec.seed)
    if spec.design == SOBOL:
        return qmc.Sobol(dimensions, scramble=True, rng=spec.seed).random(size)
    return qmc.LatinHypercube(dimensions, rng=spec.seed).random(size)
