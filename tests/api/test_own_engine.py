"""`harness.compare` with an engine of the user's own, as an object."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import harness
from harness.engines.mujoco import MuJoCo
from tests.acceptance.short import write_short_case


class Twin(MuJoCo):
    """MuJoCo under another name."""

    name = "twin"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A short case."""
    return write_short_case(tmp_path_factory.mktemp("own_engine") / "case")


@pytest.mark.slow
def test_it_runs_beside_the_others(folder: Path, tmp_path: Path) -> None:
    """Drive it as the others, with its own settings, into tables, attribution, report and manifest."""
    settings = {"twin": {"time_step": 0.002}}
    comparison = harness.compare(folder, engines=["mujoco", Twin()], settings=settings, windows=[1.0])
    table = comparison.trajectories
    assert not np.array_equal(table["twin_m"], table["mujoco_m"])  # by the longer step
    # MuJoCo's error at 1 ms is 5 µm over 10 s (README's tolerance); of second order, it is four times that at 2 ms.
    assert np.max(np.abs(table["twin_m"] - table["mujoco_m"])) < 25e-6
    same = harness.compare(folder, engines=["mujoco", Twin()], windows=[1.0])
    assert np.array_equal(same.trajectories["twin_m"], same.trajectories["mujoco_m"])
    out = comparison.save(tmp_path / "out")
    manifest = json.loads((out / "manifest.json").read_text(encoding="utf-8"))
    assert manifest["settings"]["engines"]["twin"]["time_step"] == 0.002
    assert "twin" in (out / "report.html").read_text(encoding="utf-8")
    assert comparison.report_failures == ()


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("mujoco", "the name 'mujoco' is taken; choose another for Twin"),
        ("cam", "the name 'cam' is taken"),
        ("My engine", "'My engine' cannot be the name of an engine; use lower case, digits and _"),
    ],
)
def test_a_name_that_cannot_be_is_refused(folder: Path, name: str, said: str) -> None:
    """Raise an error that says why, before anything is computed."""
    engine = Twin()
    engine.name = name
    with pytest.raises(harness.InputError, match=said):
        harness.compare(folder, engines=[engine])


def test_what_is_no_engine_is_refused(folder: Path) -> None:
    """Say what is wanted, and of a class that an object is."""
    with pytest.raises(
        harness.InputError, match=r"neither a name nor a harness\.engines\.protocol\.Engine; .*Twin\(\)"
    ):
        harness.compare(folder, engines=[Twin])  # type: ignore[list-item]
    with pytest.raises(harness.InputError, match=r"the name 'twin' is taken"):
        harness.compare(folder, engines=[Twin(), Twin()])


def test_settings_that_it_does_not_have_are_refused(folder: Path) -> None:
    """Name its parameters."""
    with pytest.raises(harness.InputError, match=r"twin has no parameter 'frction'\. Did you mean 'friction'"):
        harness.compare(folder, engines=[Twin()], settings={"twin": {"frction": 0.3}})
