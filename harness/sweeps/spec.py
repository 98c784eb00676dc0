"""Reads `sweep.toml`: what is to be swept, checked before anything runs, with one message a mistake."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from analytic.naming import did_you_mean
from harness.engines.catalogue import DEFAULT_ENGINES, ENGINES
from harness.errors import InputError
from harness.recording.case import case_path
from harness.recording.source import read_source
from harness.sweeps.factors import CAM_SOURCE, Factor, factors_of
from harness.sweeps.ranges import Range, Varied
from harness.toml_text import parse_toml

SOURCES = (*ENGINES, CAM_SOURCE)
GRID, LATIN_HYPERCUBE, SOBOL = "grid", "latin_hypercube", "sobol"
_EXAMPLE = "docs/sweeps.md has an example"


Table = dict[str, Varied]


class _Content(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False)
    cases: Annotated[list[str], Field(min_length=1)]
    recordings: Literal["first", "all"] | Annotated[list[str], Field(min_length=1)] = "first"
    sources: Annotated[list[str], Field(min_length=1)] = list(DEFAULT_ENGINES)
    window_s: Annotated[float, Field(gt=0.0)] | None = None
    design: Literal["grid", "latin_hypercube", "sobol"] = "grid"
    size: Annotated[int, Field(ge=2, le=10_000_000)] | None = None
    indices: bool = False
    seed: Annotated[int, Field(ge=0)] = 0
    time_limit_s: Annotated[float, Field(gt=0.0)] = 600.0
    time_step: Varied | None = None
    mujoco: Table = {}
    pybullet: Table = {}
    dart: Table = {}
    rig: Table = {}
    effects: dict[str, Table] = {}


@dataclass(frozen=True)
class Spec:
    """A checked `sweep.toml`.

    Attributes:
        path: of the file.
        case_names: as written.
        cases: paths of the cases.
        recordings: `first` of each case, `all`, or names.
        sources: models and engines that run.
        window: length of the windows that each run restarts in; `None` for one free run [s].
        design: `grid`, `latin_hypercube` or `sobol`.
        size: points of the design; base samples where indices are asked; `None` for a grid.
        indices: whether Sobol' indices are computed.
        seed: of the design.
        time_limit: for one run [s].
        factors: by source, all that is set or varied there.
        content: of the file, for the record.
    """

    path: Path
    case_names: tuple[str, ...]
    cases: tuple[Path, ...]
    recordings: Literal["first", "all"] | tuple[str, ...]
    sources: tuple[str, ...]
    window: float | None
    design: str
    size: int | None
    indices: bool
    seed: int
    time_limit: float
    factors: Mapping[str, tuple[Factor, ...]]
    content: Mapping[str, Any]


def read_spec(path: Path) -> Spec:
    """Reads and checks a `sweep.toml`.

    Raises:
        InputError: it cannot be read, is no TOML, or asks for what cannot be; the message names the key.
    """
    text = read_source(path).text
    try:
        raw = parse_toml(text)
        content = _Content.model_validate(raw)
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{path}: not valid TOML: {error}.") from None
    except ValidationError as error:
        raise InputError(f"{path}: {_advice(error, raw)}") from None
    _check_design(path, content)
    for source in content.sources:
        if source not in SOURCES:
            hint = did_you_mean(source, SOURCES)
            raise InputError(f"{path}: sources: there is no {source!r}.{hint} There are {', '.join(SOURCES)}.")
    twice = next((one for one in content.sources if content.sources.count(one) > 1), None)
    if twice is not None:
        raise InputError(f"{path}: sources lists {twice!r} twice; list it once.")
    for engine in ENGINES:
        if getattr(content, engine) and engine not in content.sources:
            raise InputError(
                f"{path}: [{engine}] is set, but sources leaves {engine} out; add it there, or drop the table."
            )
    tables = {engine: getattr(content, engine) for engine in ENGINES}
    factors = {
        source: factors_of(path, source, content.time_step, tables.get(source, {}), content.rig, content.effects)
        for source in content.sources
    }
    for every in factors.values():
        for factor in every:
            _check_factor(path, factor, content.design)
    if content.design != GRID and not any(one.range for every in factors.values() for one in every):
        raise InputError(f'{path}: design = "{content.design}" samples ranges, and there is none; write '
                         'NAME = { low = …, high = … }, or design = "grid".')  # fmt: skip
    return Spec(
        path=path,
        case_names=tuple(content.cases),
        cases=tuple(_case(path, one) for one in content.cases),
        recordings=content.recordings if isinstance(content.recordings, str) else tuple(content.recordings),
        sources=tuple(content.sources),
        window=content.window_s,
        design=content.design,
        size=content.size,
        indices=content.indices,
        seed=content.seed,
        time_limit=content.time_limit_s,
        factors=factors,
        content=raw,
    )


def _case(path: Path, name: str) -> Path:
    """A case beside the spec, else one relative to where the user is, or a built-in one."""
    beside = path.parent / name
    return beside if beside.exists() else case_path(name)


def _check_design(path: Path, content: _Content) -> None:
    if content.design == GRID and content.size is not None:
        raise InputError(
            f"{path}: size = {content.size} says nothing of a grid; give levels in each range, and drop size."
        )
    if content.design != GRID and content.size is None:
        raise InputError(
            f'{path}: size is missing; design = "{content.design}" needs the number of points, as in size = 64.'
        )
    if content.design == SOBOL and content.size is not None and content.size & (content.size - 1):
        near = 2 ** round(math.log2(content.size))
        raise InputError(f"{path}: size = {content.size} is no power of 2, which Sobol' points need; write {near}.")
    if content.indices and content.design != SOBOL:
        raise InputError(f'{path}: indices = true needs design = "sobol"; design is "{content.design}".')


def _check_factor(path: Path, factor: Factor, design: str) -> None:
    if factor.range is None:
        return
    if design == GRID and factor.range.levels is None:
        raise InputError(
            f"{path}: {factor.name} has no levels; a grid needs them, as in levels = 5, or list the values."
        )
    if design != GRID and factor.range.levels is not None:
        raise InputError(f'{path}: {factor.name}: levels is for a grid; drop it, or write design = "grid".')


def _advice(error: ValidationError, raw: Mapping[str, Any]) -> str:
    """One mistake in words. A union's branches report one each; the furthest one in knows what was meant."""
    first = max(error.errors(), key=lambda one: len(one["loc"]) if "Range" in one["loc"] else 0)
    names = [
        str(part)
        for part in first["loc"]
        if not str(part).startswith(("Range", "list[", "function-", "constrained-", "literal["))
    ]
    names = [one for one in names if one not in ("float", "int", "bool", "str")]
    where, kind, value = ".".join(names), first["type"], first["input"]
    if kind == "extra_forbidden":
        if len(names) == 1:
            known: list[str] = list(_Content.model_fields)
            hint = " Write sources." if where in ("engines", "engine") else did_you_mean(where, known)
            return f"{where} is unknown.{hint} Keys are {', '.join(known)}."
        known = list(Range.model_fields)
        return f"{where} is unknown.{did_you_mean(names[-1], known)} A range has {', '.join(known)}."
    if kind == "missing":
        return (
            f'{where} is missing. Write cases = ["my_rig"].' if where == "cases" else f"{where} is missing; {_EXAMPLE}."
        )
    if names == ["design"]:
        known = [GRID, LATIN_HYPERCUBE, SOBOL]
        return f"design: there is no {value!r}.{did_you_mean(str(value), known)} There are {', '.join(known)}."
    if kind == "too_short":
        return f"{where} is empty; name one at least, or leave it out where it has a default."
    if kind == "value_error":
        return f"{where}: {first['msg'].removeprefix('Value error, ')}."
    shown = raw.get(names[0]) if names and len(names) == 1 else value
    if names and names[0] in ("cases", "sources") and isinstance(shown, str):
        return f'{where} = {shown!r} has to be a list; write {where} = ["{shown}"].'
    return f"{where} = {shown!r}: {first['msg'][:1].lower()}{first['msg'][1:]}; {_EXAMPLE}."
