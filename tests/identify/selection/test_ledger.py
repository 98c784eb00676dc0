"""The ledger as a record: hashes that pin what was done, and a replay that decides it again."""

from __future__ import annotations

import copy
import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from harness.identify.estimate.fit import Estimator
from harness.identify.pose import problem_of
from harness.identify.problem.settings import Settings
from harness.identify.problem.spline_term import Regressor
from harness.identify.record import LedgerRecord, SourcesRecord
from harness.identify.selection.criterion import Criterion
from harness.identify.selection.decision import Rule
from harness.identify.selection.ledger_record import digest, ledger_record
from harness.identify.selection.replay import replay
from harness.identify.selection.search import Selection, search
from harness.recording import load_case
from harness.simulator import Experiment, write_case
from tests.posed import pose

HIDDEN = {"rolling_resistance": {"coefficient": 0.004}, "level_error": {"angle": 0.004}}
INPUTS = SourcesRecord(hashes={"rec_01.csv": "0123"}, versions={"numpy": "2.0"})


@pytest.fixture(scope="module")
def searched(tmp_path_factory: pytest.TempPathFactory) -> Selection:
    """A search that finds two effects, and so keeps, swaps and drops some."""
    problem = pose(tmp_path_factory.mktemp("two") / "case", 0, HIDDEN).problem
    return search(problem)


@pytest.fixture(scope="module")
def kept(searched: Selection) -> dict[str, Any]:
    """Its record, through JSON and back."""
    return json.loads(ledger_record(searched, INPUTS).model_dump_json())


@pytest.mark.slow
def test_every_line_is_decided_by_the_criterion(searched: Selection) -> None:
    """Come to every decision, gain and reason from the line's own fits and evidence."""
    criterion = Criterion(searched.problem.settings)
    for line in searched.ledger:
        assert criterion.decide(line.rule, line.fit, line.against, line.evidence) == line.decision
        assert set(line.beside) <= set(line.against.hypothesis.names) & set(line.fit.hypothesis.names)
        assert not set(line.beside) & set(line.effects)


@pytest.mark.slow
def test_the_search_adds_drops_and_swaps(searched: Selection) -> None:
    """Hold each of two effects against none and against all others, and find both."""
    assert {Rule.ADD, Rule.DROP, Rule.SWAP} <= {line.rule for line in searched.ledger}
    assert set(searched.found.hypothesis.names) == set(HIDDEN)


@pytest.mark.slow
def test_the_same_inputs_replay_to_nothing(searched: Selection, kept: dict[str, Any]) -> None:
    """Find every hash, deviance and decision again."""
    done = replay(LedgerRecord.model_validate(kept), searched.problem)
    assert done.mismatches == ()
    # the same code on the same processor sums the same terms in the same order
    assert done.largest == 0.0
    assert done.attempts == len(searched.ledger)


def rehashed(line: dict[str, Any]) -> None:
    """Give a line the hash of its content, as who forges it well would."""
    line["hash"] = digest({key: value for key, value in line.items() if key != "hash"})


def _parameter(record: dict[str, Any]) -> str:
    """Another coefficient of the first attempt."""
    record["fits"][record["ledger"][0]["fit"]]["parameters"][0] += 0.05
    return "deviance"


def _decision(record: dict[str, Any]) -> str:
    """Something else is kept."""
    line = next(line for line in record["ledger"] if not line["kept"])
    line["kept"] = True
    rehashed(line)
    return "not kept, recorded as kept"


def _gain(record: dict[str, Any]) -> str:
    """A rival's gain is talked down."""
    record["ledger"][1]["gain"] -= 1.0
    rehashed(record["ledger"][1])
    return "gain"


def _reason(record: dict[str, Any]) -> str:
    """Another reason for the same decision."""
    line = record["ledger"][1]
    line["because"] = "was asked for"
    rehashed(line)
    return 'recorded "was asked for"'


def _hash(record: dict[str, Any]) -> str:
    """The reason is another one."""
    record["ledger"][1]["because"] = "nobody knows"
    return "does not give its hash"


def _mass(record: dict[str, Any]) -> str:
    """Another rig."""
    record["problem"]["rig"]["mass"] *= 1.001
    return "rig is"


def _threshold(record: dict[str, Any]) -> str:
    """Another threshold is claimed."""
    record["problem"]["settings"]["keep"] = 1.0
    return "settings is"


def _version(record: dict[str, Any]) -> str:
    """Other software is claimed."""
    record["problem"]["inputs"]["versions"]["numpy"] = "1.0"
    return "does not give its hash"


@pytest.mark.slow
@pytest.mark.parametrize("forge", [_parameter, _decision, _gain, _reason, _hash, _mass, _threshold, _version])
def test_what_was_changed_is_named(
    searched: Selection, kept: dict[str, Any], forge: Callable[[dict[str, Any]], str]
) -> None:
    """Name what no longer comes out, or the hash that no longer fits."""
    record = copy.deepcopy(kept)
    text = forge(record)
    said = [one.what for one in replay(LedgerRecord.model_validate(record), searched.problem).mismatches]
    assert any(text in one for one in said), said


@pytest.mark.slow
@pytest.mark.parametrize("rule", [Rule.ADD, Rule.DROP, Rule.SWAP])
def test_every_kind_of_decision_is_decided_anew(searched: Selection, kept: dict[str, Any], rule: Rule) -> None:
    """Notice of each rule that a decision was turned round, hashes and all."""
    record = copy.deepcopy(kept)
    line = next(line for line in record["ledger"] if line["rule"] == rule)
    line["kept"] = not line["kept"]
    rehashed(line)
    assert any(
        "recorded as" in one.what for one in replay(LedgerRecord.model_validate(record), searched.problem).mismatches
    )


@pytest.mark.slow
def test_other_recordings_give_other_deviances(tmp_path: Path, kept: dict[str, Any]) -> None:
    """Reproduce nothing from recordings of the same rig with other noise."""
    other = pose(tmp_path / "case", 1, HIDDEN).problem
    said = [one.what for one in replay(LedgerRecord.model_validate(kept), other).mismatches]
    assert sum("deviance" in one for one in said) == len(kept["fits"])


@pytest.mark.slow
def test_a_search_that_began_again_replays(searched: Selection) -> None:
    """Decide again a search that tried a runner-up as well, and held both ends against each other."""
    # as if much were left: nothing counts as explained, any runner-up may begin, and spline terms never pay
    never = Settings(at_floor_ratio=0.0, restart_share=0.0, restart_slack=1e9, spline_keep=1e9)
    problem = replace(searched.problem, settings=never)
    selection = search(problem)
    assert {Rule.RESTART, Rule.PREFER, Rule.SPLINE} <= {line.rule for line in selection.ledger}
    record = ledger_record(selection, INPUTS)
    assert replay(record, problem).mismatches == ()


@pytest.mark.slow
def test_a_search_that_returns_to_its_spline_term_replays(tmp_path: Path) -> None:
    """Keep the curve of a rough patch, which free runs do not find, for what it predicts as the likelihood fits it.

    The ball stops on the patch or rolls over it, and free runs of a few seconds part at its edges.
    """
    patch = {"coefficient": 0.00992369, "start": 0.292006, "end": 0.347991}
    experiment = Experiment(
        declared={"rolling_resistance": {"coefficient": 0.00183}},
        unlisted={"rough_patch": patch},
        counts=40_000,
        position_noise=0.35e-3,
        predict=0,
        seed=1682453602,
    )
    write_case(tmp_path / "case", experiment)
    problem = problem_of(load_case(tmp_path / "case"))
    selection = search(problem)
    (line,) = (line for line in selection.ledger if line.rule is Rule.RESTORE)
    assert line.kept
    # that very fit, with the band and the travel of its predictions
    assert selection.found.terms is line.fit.terms
    assert selection.found.covariance is line.fit.covariance
    assert selection.found.process_noise == line.fit.process_noise
    assert selection.found.estimator is line.fit.estimator is Estimator.LIKELIHOOD
    spline = selection.found.hypothesis.spline
    assert spline is not None
    assert (spline.depends, spline.friction) == (Regressor.POSITION, True)
    # free runs lay half of the patch to an evenly rough track
    assert sum(line.evidence.after) < 0.5 * sum(line.evidence.before)
    assert replay(ledger_record(selection, INPUTS), problem).mismatches == ()
