"""Engines by name, and settings as a user writes them."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from harness.engines import catalogue
from harness.engines.catalogue import DEFAULT_ENGINES, ENGINES, describe, engine_of, parameters_of, read_settings
from harness.errors import InputError


def test_engines_go_by_their_names() -> None:
    """Give each engine under the name it has itself."""
    assert ENGINES == ("mujoco", "pybullet", "dart")
    for name in DEFAULT_ENGINES:
        assert engine_of(name).name == name


def test_an_unknown_engine_is_refused() -> None:
    """List the engines."""
    with pytest.raises(InputError, match=r"no engine 'bullet'; engines are mujoco, pybullet, dart"):
        engine_of("bullet")


def test_an_engine_that_is_not_installed_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    """Say which package is missing, and which engines can be used instead."""
    monkeypatch.setitem(catalogue._CLASSES, "dart", ("no_such_package.dart", "Dart"))
    with pytest.raises(InputError, match=r"dart cannot be loaded .*no_such_package.*mujoco, pybullet with --engine"):
        engine_of("dart")


def test_assignments_win_over_the_file(tmp_path: Path) -> None:
    """Take settings from the file, and replace those that are assigned."""
    file = tmp_path / "contact.toml"
    file.write_text("[mujoco]\nfriction = 0.3\ncondim = 3\n[pybullet]\ncontact_erp = 0.1\n", encoding="utf-8")
    assert read_settings(file, ["mujoco.friction=0.4", "dart.time_step = 5e-4"]) == {
        "mujoco": {"friction": 0.4, "condim": 3},
        "pybullet": {"contact_erp": 0.1},
        "dart": {"time_step": 5e-4},
    }
    assert read_settings(None, []) == {}


@pytest.mark.parametrize(
    ("text", "value"),
    [("0.3", 0.3), ("3", 3), ("true", True), ("'a b'", "a b"), ("elliptic", "elliptic"), ("a=b", "a=b"), ("", "")],
)
def test_values_are_toml_or_plain_text(text: str, value: object) -> None:
    """Read numbers, truth values and quoted texts as TOML, anything else as text."""
    assert read_settings(None, [f"mujoco.cone={text}"]) == {"mujoco": {"cone": value}}


@pytest.mark.parametrize("text", ["friction=0.3", "mujoco.friction", "mujoco.=1", "mujoco=1", "=1"])
def test_an_assignment_without_its_parts_is_refused(text: str) -> None:
    """Show how an assignment is written."""
    with pytest.raises(InputError, match=re.escape(f"--set {text}: write engine.parameter=value")):
        read_settings(None, [text])


def test_settings_of_an_unknown_engine_are_refused(tmp_path: Path) -> None:
    """Refuse settings that no engine would read, from either source."""
    with pytest.raises(InputError, match="no engine 'mujuco' to set a parameter of"):
        read_settings(None, ["mujuco.friction=0.3"])
    file = tmp_path / "contact.toml"
    file.write_text("[bullet]\nfriction = 0.3\n", encoding="utf-8")
    with pytest.raises(InputError, match="no engine 'bullet'"):
        read_settings(file, [])


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"friction = 0.3\n", "friction is not a table; write [mujoco] above its settings"),
        (b"[mujoco\n", "not valid TOML"),
        (b"\xff\xfe\x00", "not valid TOML"),
        (None, "cannot be read"),
    ],
)
def test_a_bad_file_is_named(tmp_path: Path, content: bytes | None, message: str) -> None:
    """Name the file and what is wrong with it."""
    file = tmp_path / "contact.toml"
    if content is not None:
        file.write_bytes(content)
    with pytest.raises(InputError, match=re.escape(message)) as caught:
        read_settings(file, [])
    assert str(file) in str(caught.value)


def test_an_unknown_parameter_is_answered_by_those_that_exist() -> None:
    """List the parameters and suggest one with a similar name."""
    engine = engine_of("mujoco")
    with pytest.raises(InputError) as caught:
        parameters_of(engine, {"frction": 0.3})
    assert "mujoco has no parameter 'frction'. Did you mean 'friction'?" in str(caught.value)
    assert all(name in str(caught.value) for name in engine.parameters.model_fields)


@pytest.mark.parametrize("value", [-1.0, 1e9, "fast", float("nan")])
def test_a_value_out_of_bounds_is_refused(value: object) -> None:
    """Name parameter, bound and value given."""
    with pytest.raises(InputError, match=r"mujoco\.time_step: .*\(given: "):
        parameters_of(engine_of("mujoco"), {"time_step": value})


def test_settings_are_applied() -> None:
    """Change what is set and nothing else."""
    engine = engine_of("pybullet")
    changed, default = parameters_of(engine, {"time_step": 5e-4}), parameters_of(engine, {})
    assert changed.time_step == 5e-4
    assert changed.model_dump(exclude={"time_step"}) == default.model_dump(exclude={"time_step"})


@pytest.mark.parametrize("name", DEFAULT_ENGINES)
def test_every_parameter_is_described_with_its_unit(name: str) -> None:
    """Describe each parameter; what can be a fraction has a unit in brackets."""
    engine = engine_of(name)
    rows = {key: (default, text) for key, default, text in describe(engine)}
    assert list(rows) == [f"{name}.{field}" for field in engine.parameters.model_fields]
    for field, about in engine.parameters.model_fields.items():
        default, text = rows[f"{name}.{field}"]
        assert text, field
        assert "Undefined" not in default
        if isinstance(about.default, float):
            assert re.search(r"\[[^\]]+\]", text), field
