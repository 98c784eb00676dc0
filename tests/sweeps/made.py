"""Specs and plans for tests."""

from __future__ import annotations

from pathlib import Path

from harness.sweeps import Plan, plan_of, read_spec
from tests.acceptance.short import write_short_case


def spec_file(folder: Path, text: str, *, case: bool = True) -> Path:
    """A `sweep.toml` in this folder, beside a short simulated case of the name `rig`."""
    if case and not (folder / "rig").exists():
        write_short_case(folder / "rig")
    file = folder / "sweep.toml"
    file.write_text('cases = ["rig"]\n' + text if "cases" not in text else text, encoding="utf-8")
    return file


def planned(folder: Path, text: str) -> Plan:
    """The plan of this spec."""
    return plan_of(read_spec(spec_file(folder, text)))
