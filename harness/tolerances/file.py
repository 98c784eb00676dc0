"""`tolerances.toml`: one table per source and horizon, one line per metric.

    [tube]
    tolerance_m = 0.01           # half width of the tube of `fraction_outside_tube`

    [mujoco.whole]               # the free run over the whole recording, against the measurement
    max_error_m = 0.02

    [cam."2 s"]                  # windows of 2 s, against the measurement
    rms_error_mm = 5

    [mujoco.against_cam]         # the free run, against CAM
    max_difference_m = 2e-5

    [mujoco.against_cam."2 s"]   # windows of 2 s, against CAM
    rms_difference_m = 1e-6

Metrics against the measurement are those of metrics.csv, by name or alias; limits are in the metric's unit.
"""

import math
import re
import tomllib
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

from analytic.models import CAM, MODELS
from analytic.naming import did_you_mean
from harness.engines.catalogue import ENGINES
from harness.errors import InputError
from harness.metrics import WHOLE, Better, Metric, find_metric
from harness.recording.source import read_source
from harness.tolerances.limits import AGAINST_CAM, DIFFERENCES, Limit, Tolerances
from harness.toml_text import parse_toml

TOLERANCES_FILE = "tolerances.toml"
DEFAULTS = Path(__file__).parents[1] / "data" / TOLERANCES_FILE
SOURCES = (*MODELS, *ENGINES)
TUBE, TUBE_KEY = "tube", "tolerance_m"

_DIFFERENCES_BY_ANY_NAME = {key: metric for metric in DIFFERENCES.values() for key in (metric.name, *metric.aliases)}


def tolerances_for(case_path: Path, file: Path | None = None) -> Tolerances:
    """The limits of a case: from `file` if given, else `tolerances.toml` beside `rig.toml`, else the defaults.

    Args:
        case_path: a folder, its `rig.toml`, or a CSV recording, for which the defaults apply.
        file: chosen by the user.

    Raises:
        InputError: as `read_tolerances`.
    """
    if file is not None:
        return read_tolerances(file)
    if case_path.is_dir() or case_path.suffix.lower() == ".toml":
        own = (case_path if case_path.is_dir() else case_path.parent) / TOLERANCES_FILE
        if own.exists():
            return read_tolerances(own, chosen="of the case")
    return read_tolerances(DEFAULTS, chosen="defaults of the package")


def read_tolerances(path: Path, *, chosen: str = "given") -> Tolerances:
    """Read and check a `tolerances.toml`.

    Raises:
        InputError: the file cannot be read, sets no limit, or has an invalid source, horizon, metric or value; the
            message names file and table and lists valid names.
    """
    try:
        content = parse_toml(read_source(path).text)
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{path}: not valid TOML: {error}.") from None
    try:
        tube = _tube(content.pop(TUBE, {}))
        limits = tuple(limit for source, table in content.items() for limit in _limits_of(source, table))
        _each_once(limits)
    except InputError as error:
        raise InputError(f"{path}: {error}") from None
    if not limits:
        raise InputError(f'{path}: sets no limit. Write for instance [mujoco."2 s"] and below it max_error_m = 0.02.')
    return Tolerances(path, chosen, limits, tube)


def _tube(table: Any) -> float | None:
    if not isinstance(table, Mapping):
        raise InputError(f"{TUBE} is not a table. Write [{TUBE}] and below it {TUBE_KEY} = 0.01.")
    for key in table:
        if key != TUBE_KEY:
            raise InputError(f"[{TUBE}] has no key {key!r}. Its only key is {TUBE_KEY}.")
    if TUBE_KEY not in table:
        return None
    value = _number(f"[{TUBE}] {TUBE_KEY}", table[TUBE_KEY])
    if value <= 0.0:
        raise InputError(f"[{TUBE}] {TUBE_KEY} = {value:g} is not positive. Give a length in metres, as in 0.01.")
    return value


def _limits_of(source: str, table: Any) -> Iterator[Limit]:
    if source not in SOURCES:
        raise InputError(
            f"there is no source {source!r}.{did_you_mean(source.lower(), SOURCES)} Sources are {', '.join(SOURCES)}."
        )
    if not isinstance(table, Mapping):
        raise InputError(f'{source} is not a table. Write [{source}.{WHOLE}] or [{source}."2 s"] above its limits.')
    for horizon, entries in table.items():
        place = f"[{source}.{_key(horizon)}]"
        if horizon == AGAINST_CAM:
            yield from _differences_of(source, place, entries)
        elif not isinstance(entries, Mapping):
            raise InputError(
                f"[{source}] {horizon} is not in the table of a horizon. "
                f'Write it under [{source}.{WHOLE}], [{source}."2 s"] or [{source}.{AGAINST_CAM}].'
            )
        else:
            yield from _entries(source, place, _seconds(place, horizon), entries)


def _differences_of(source: str, place: str, table: Any) -> Iterator[Limit]:
    if source == CAM.name:
        raise InputError(f"{place} compares CAM with itself. Remove it.")
    if not isinstance(table, Mapping):
        raise InputError(f"{place} is not a table. Write {place} and below it max_difference_m = 2e-5.")
    for name, entry in table.items():
        if isinstance(entry, Mapping):
            inner = f"{place[:-1]}.{_key(name)}]"
            yield from _entries(source, inner, _seconds(inner, name), entry, against_cam=True)
        else:
            yield from _entries(source, place, None, {name: entry}, against_cam=True)


def _entries(
    source: str, place: str, seconds: float | None, entries: Mapping[str, Any], *, against_cam: bool = False
) -> Iterator[Limit]:
    for name, value in entries.items():
        metric = _difference(place, name) if against_cam else _metric(place, name)
        number = _number(f"{place} {name}", value)
        if number < 0.0 and metric.better is not Better.LARGER:
            raise InputError(
                f"{place} {name} = {number:g} cannot be satisfied. The metric is a magnitude; give a positive number."
            )
        yield Limit(source, seconds, metric, number, against_cam)


def _seconds(place: str, horizon: str) -> float | None:
    """Length of the windows [s], `None` for the whole recording."""
    if horizon == WHOLE:
        return None
    match = re.fullmatch(r"(\d+(?:\.\d+)?|\.\d+)\s*s", horizon)
    if match is None or float(match[1]) == 0.0:
        dotted = " Quote a length that contains a point." if horizon.isdigit() else ""
        raise InputError(
            f"{place} is not a horizon.{did_you_mean(horizon.lower(), (WHOLE, AGAINST_CAM))}{dotted} "
            f'Horizons are {WHOLE}, windows such as "2 s" or "0.5 s", and {AGAINST_CAM}.'
        )
    return float(match[1])


def _metric(place: str, name: str) -> Metric:
    if name.lower() in DIFFERENCES:
        source = place[1:-1].partition(".")[0]
        raise InputError(f"{place} {name} is a difference from CAM. Write it under [{source}.{AGAINST_CAM}].")
    try:
        return find_metric(name)
    except InputError as error:
        raise InputError(f"{place}: {error}.") from None


def _difference(place: str, name: str) -> Metric:
    try:
        return _DIFFERENCES_BY_ANY_NAME[name.lower()]
    except KeyError:
        near = did_you_mean(name.lower(), _DIFFERENCES_BY_ANY_NAME)
        raise InputError(f"{place}: there is no metric {name!r}.{near} Metrics are {', '.join(DIFFERENCES)}.") from None


def _number(place: str, value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise InputError(f"{place} = {value!r} is not a number. Give a finite number, without quotes or a unit.")
    return float(value)


def _each_once(limits: Iterable[Limit]) -> None:
    seen = set()
    for limit in limits:
        key = limit.place, limit.metric.name
        if key in seen:
            raise InputError(f"{limit.place}: {limit.metric.name} has two limits in two spellings. Remove one.")
        seen.add(key)


def _key(name: str) -> str:
    """`name` as a TOML key, quoted if necessary."""
    return name if re.fullmatch(r"[A-Za-z0-9_-]+", name) else f'"{name}"'
