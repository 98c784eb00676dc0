"""The ledger as a record: hashes that pin what was done, and a replay that does it again."""

from __future__ import annotations

import copy
import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from harness.identify.estimate.fit import fit
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.problem import Problem
from harness.identify.record import LedgerRecord, SourcesRecord
from harness.identify.selection.candidates import Entry
from harness.identify.selection.ledger import ledger_record
from harness.identify.selection.replay import replay
from harness.identify.selection.stepwise import select
from tests.identify.conftest import pose

HIDDEN = {"rolling_resistance": {"coefficient": 0.004}, "level_error": {"angle": 0.004}}
INPUTS = SourcesRecord(hashes={"rec_01.csv": "0123"}, versions={"numpy": "2.0"})


@pytest.fixture(scope="module")
def searched(tmp_path_factory: pytest.TempPathFactory) -> tuple[Problem, list[Entry]]:
    """A search that finds two effects, and so keeps, exchanges and drops some."""
    problem = pose(tmp_path_factory.mktemp("two") / "case", 0, HIDDEN).problem
    return problem, select(problem, fit(problem, Hypothesis(())))[1]


@pytest.fixture(scope="module")
def kept(searched: tuple[Problem, list[Entry]]) -> dict[str, Any]:
    """Its record, through JSON and back."""
    problem, ledger = searched
    return json.loads(ledger_record(problem, fit(problem, Hypothesis(())), ledger, INPUTS).model_dump_json())


def test_every_attempt_has_its_reference(searched: tuple[Problem, list[Entry]]) -> None:
    """Keep with each attempt the fit without what was tried, behind it by exactly the gain."""
    for entry in searched[1]:
        assert set(entry.beside) <= {*entry.against.hypothesis.names, *entry.fit.hypothesis.names}
        assert entry.against.score - entry.fit.score == pytest.approx(entry.gain, abs=1e-6)


def test_the_same_inputs_replay_to_nothing(searched: tuple[Problem, list[Entry]], kept: dict[str, Any]) -> None:
    """Find every hash, deviance and decision again; on one machine to the bit."""
    done = replay(LedgerRecord.model_validate(kept), searched[0])
    assert done.mismatches == ()
    assert done.largest == 0.0
    assert done.attempts == len(searched[1])


def _number(record: dict[str, Any]) -> str:
    """Another coefficient of the first attempt."""
    one = record["fits"][record["ledger"][0]["fit"]]
    one["numbers"][0] += 0.05
    return "deviance"


def _decision(record: dict[str, Any]) -> str:
    """Something else is kept."""
    line = next(line for line in record["ledger"] if not line["kept"])
    line["kept"] = True
    return "not kept, recorded as kept"


def _gain(record: dict[str, Any]) -> str:
    """A rival's gain is talked down."""
    record["ledger"][1]["gain"] -= 1.0
    return "gain"


def _mass(record: dict[str, Any]) -> str:
    """Another rig."""
    record["problem"]["rig"]["mass"] *= 1.001
    return "rig is"


def _version(record: dict[str, Any]) -> str:
    """Other software is claimed."""
    record["problem"]["inputs"]["versions"]["numpy"] = "1.0"
    return "does not give its hash"


@pytest.mark.parametrize("forge", [_number, _decision, _gain, _mass, _version])
def test_what_was_changed_is_named(
    searched: tuple[Problem, list[Entry]], kept: dict[str, Any], forge: Callable[[dict[str, Any]], str]
) -> None:
    """Name what no longer comes out, and the hash that no longer fits."""
    record = copy.deepcopy(kept)
    text = forge(record)
    said = [one.what for one in replay(LedgerRecord.model_validate(record), searched[0]).mismatches]
    assert any(text in one for one in said), said
    assert any("does not give its hash" in one for one in said), said


def test_other_recordings_give_other_deviances(tmp_path: Path, kept: dict[str, Any]) -> None:
    """Reproduce nothing from recordings of the same rig with other noise."""
    other = pose(tmp_path / "case", 1, HIDDEN).problem
    said = [one.what for one in replay(LedgerRecord.model_validate(kept), other).mismatches]
    assert sum("deviance" in one for one in said) == len(kept["fits"])


def test_a_search_that_began_again_replays(
    searched: tuple[Problem, list[Entry]], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Find the decisions again of a search that tried a runner-up as well, and held both ends against each other."""
    problem = searched[0]
    base = fit(problem, Hypothesis(()))
    for name, value in (
        ("explained", lambda *_: False),
        ("_SHARE", 0.0),
        ("_NEARLY", math.inf),
    ):  # as if much were left
        monkeypatch.setattr(f"harness.identify.selection.stepwise.{name}", value)
    _, ledger = select(problem, base)
    assert {"again", "either"} <= {entry.rule for entry in ledger}
    record = ledger_record(problem, base, ledger, INPUTS)
    assert replay(record, problem).mismatches == ()
