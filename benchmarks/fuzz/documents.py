"""rig.toml and diagnosis.json: good ones with keys and values changed."""

from __future__ import annotations

import copy
import json
import math
import tomllib
from typing import Any

from hypothesis import strategies as st

from benchmarks.fuzz import strange
from benchmarks.fuzz.doors import RIG, SETTINGS, SWEEP, seed
from harness.identify.record import FILE

_EFFECTS = ("level_error", "rolling_resistance", "channel_delay", "angle_gain", "level_per_recording", "no_such_effect")
_KEYS = ("mass_kg", "radius_m", "length_m", "angle", "coefficient", "delay", "name", "identify", "predict", "origin")

_SWEEP = (
    "cases",
    "recordings",
    "sources",
    "window_s",
    "design",
    "size",
    "seed",
    "indices",
    "time_limit_s",
    "time_step",
)
_SWEEP_VALUES: tuple[Any, ...] = (
    *(["case", "case"], ["."], ["../case"], ["mujoco", "dart"], [], "grid", "sobol", "latin_hypercube", "all"),
    *(0, -1, 3, 64, 10**6, 2**60, 1e-12, 1e300, True, {"low": 1e-3, "high": 1e-4}, {"low": 0.0, "high": 1.0}),
    *({"low": 1e-3, "high": 1e-2, "levels": 10**9}, {"low": 0.0, "high": 1.0, "scale": "log", "levels": 3}),
)
_SETTINGS = (
    "friction",
    "time_step",
    "rolling_friction",
    "cone",
    "solver",
    "rolling_radius_m",
    "gravity_m_s2",
    "mass_kg",
)


@st.composite
def rig_files(draw: st.DrawFn) -> bytes:
    """Bytes of a changed rig.toml."""
    content = tomllib.loads(seed(RIG).decode())
    if draw(st.booleans()):
        values = draw(st.dictionaries(st.sampled_from(_KEYS) | strange.texts, strange.scalars, max_size=2))
        content["declared"] = [{"name": draw(st.sampled_from(_EFFECTS)), **values}]
    for _ in range(draw(st.integers(0, 4))):
        content = draw(_changed(content))
    return draw(strange.edited(_toml(content).encode("utf-8", errors="replace"), most=2))


@st.composite
def sweep_files(draw: st.DrawFn) -> bytes:
    """Bytes of a changed sweep.toml."""
    content = tomllib.loads(seed(SWEEP).decode())
    if draw(st.booleans()):
        content[draw(st.sampled_from(tuple(_SWEEP)))] = draw(st.sampled_from(_SWEEP_VALUES) | strange.trees)
    for _ in range(draw(st.integers(0, 3))):
        content = draw(_changed(content))
    return draw(strange.edited(_toml(content).encode("utf-8", errors="replace"), most=draw(st.sampled_from((0, 0, 2)))))


@st.composite
def settings_files(draw: st.DrawFn) -> bytes:
    """Bytes of a changed file of settings, as `tune` writes it and `--parameters` takes it."""
    content = tomllib.loads(seed(SETTINGS).decode())
    if draw(st.booleans()):
        engine = draw(st.sampled_from(("mujoco", "pybullet", "dart", "rig", "cam", "no_such")))
        key = draw(st.sampled_from(_SETTINGS) | strange.texts)
        content[engine] = {key: draw(strange.scalars | st.sampled_from(("none", "elliptic", 1e-9)))}
    for _ in range(draw(st.integers(0, 3))):
        content = draw(_changed(content))
    return draw(strange.edited(_toml(content).encode("utf-8", errors="replace"), most=draw(st.sampled_from((0, 0, 2)))))


@st.composite
def diagnosis_files(draw: st.DrawFn) -> bytes:
    """Bytes of a changed diagnosis.json."""
    content = json.loads(seed(FILE))
    for _ in range(draw(st.integers(0, 3))):
        content = draw(_changed(content))
    raw = json.dumps(content, ensure_ascii=draw(st.booleans())).encode("utf-8", errors="replace")
    return draw(strange.edited(raw, most=draw(st.sampled_from((0, 0, 2)))))


@st.composite
def _changed(draw: st.DrawFn, content: Any) -> Any:
    """One value, somewhere in the tree, changed."""
    content = copy.deepcopy(content)
    home: Any = None
    key: Any = None
    inner = content
    while isinstance(inner, dict | list) and inner and (home is None or draw(st.integers(0, 7))):
        home = inner
        key = draw(st.sampled_from(list(inner))) if isinstance(inner, dict) else draw(st.integers(0, len(inner) - 1))
        inner = home[key]
    if home is None:
        return content
    kind = draw(st.sampled_from(("value", "value", "number", "delete", "add", "tree", "rename")))
    if kind == "delete":
        del home[key]
    elif kind == "number" and isinstance(inner, int | float) and abs(inner) < 1e300:
        home[key] = draw(st.sampled_from((-inner, 0 * inner, 1e3 * inner, 1e-6 * inner, 1e200 * inner, inner + 1)))
    elif kind == "add" and isinstance(home, dict):
        home[draw(st.sampled_from(_KEYS) | strange.texts)] = draw(strange.scalars)
    elif kind == "add":
        home.append(copy.deepcopy(home[0]))
    elif kind == "rename" and isinstance(home, dict):
        home[draw(st.sampled_from((*_KEYS, *_EFFECTS)) | strange.texts)] = home.pop(key)
    else:
        home[key] = draw(strange.trees if kind == "tree" else strange.scalars)
    return content


def _toml(content: dict[str, Any]) -> str:
    """TOML of tables and arrays of tables, wherever the value is one of these."""
    lines = [f"{_name(key)} = {_value(one)}" for key, one in content.items() if not _table(one)]
    for key, one in content.items():
        if _table(one):
            tables, head = (one, f"[[{_name(key)}]]") if isinstance(one, list) else ([one], f"[{_name(key)}]")
            for table in tables:
                lines += [head, *(f"{_name(inner)} = {_value(value)}" for inner, value in table.items())]
    return "\n".join(lines) + "\n"


def _table(value: Any) -> bool:
    listed = isinstance(value, list) and bool(value) and all(isinstance(one, dict) for one in value)
    return isinstance(value, dict) or listed


def _name(key: str) -> str:
    return key if key.isascii() and key.isidentifier() else json.dumps(key)


def _value(value: Any) -> str:
    if isinstance(value, dict):
        return "{" + ", ".join(f"{_name(key)} = {_value(one)}" for key, one in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(_value, value)) + "]"
    if isinstance(value, float) and not math.isfinite(value):
        return repr(value)
    return "''" if value is None else json.dumps(value)
