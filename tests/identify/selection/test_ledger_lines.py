"""The lines of the ledger: what was tried beside what, which candidate of a round is kept, and how that is recorded."""

from __future__ import annotations

import hashlib
from types import SimpleNamespace
from typing import Any, cast

import pytest

from analytic.effects import acting
from analytic.models import CAM
from analytic.rig import Rig
from harness.identify.problem.problem import WHITE, Problem
from harness.identify.problem.settings import DEFAULT
from harness.identify.record import LedgerRecord, SourcesRecord
from harness.identify.selection.criterion import Criterion
from harness.identify.selection.decision import NONE, Decision, Evidence, Rule
from harness.identify.selection.ledger import Ledger, Line
from harness.identify.selection.ledger_record import digest, hashed, ledger_record
from harness.identify.selection.search import Selection
from tests.identify.selection.made import made

BASE = made(100.0)
BOTH, LEVEL = made(60.0, "rolling_resistance", "level_error"), made(80.0, "level_error")
SPLINE = made(40.0, "level_error", spline=True, parameters=13)


def line(fit: Any, against: Any, *effects: str) -> Line:
    """A line of the ledger that was kept."""
    return Line(Rule.ADD, effects, fit, against, NONE, Decision(True, 20.0, "for a reason"))


def test_a_line_is_titled_by_what_was_tried() -> None:
    """Name the effects, else the spline term, else nothing."""
    assert line(BOTH, BASE, "rolling_resistance", "level_error").title == "rolling_resistance + level_error"
    assert SPLINE.hypothesis.spline is not None
    assert line(SPLINE, LEVEL).title == SPLINE.hypothesis.spline.name
    assert line(BASE, BASE).title == "nothing"


def test_beside_is_what_both_fits_have() -> None:
    """Leave out what was tried, and what only one of the two has."""
    assert line(BOTH, LEVEL, "rolling_resistance").beside == ("level_error",)
    assert line(BOTH, BASE, "rolling_resistance").beside == ()
    assert line(BOTH, BOTH, "rolling_resistance").beside == ("level_error",)


def test_a_line_tells_its_decision() -> None:
    """Give what was decided, by how much, and why."""
    one = line(BOTH, LEVEL, "rolling_resistance")
    assert (one.kept, one.gain, one.because) == (True, 20.0, "for a reason")


def test_the_best_of_a_round_is_kept_and_all_are_written_down() -> None:
    """Keep the first that pays, and tell of every other why it was not."""
    ledger, second = Ledger(Criterion()), made(70.0, "level_error", "track_bump")
    best = made(60.0, "level_error", "rolling_resistance")
    assert ledger.decide_round(Rule.ADD, [best, second], LEVEL) is best
    assert [(one.effects, one.kept) for one in ledger.lines] == [
        (("rolling_resistance",), True),
        (("track_bump",), False),
    ]
    compared = [(one.rule, one.fit, one.against) for one in ledger.lines]
    assert compared == [(Rule.ADD, best, LEVEL), (Rule.ADD, second, LEVEL)]
    assert [one.evidence.winner for one in ledger.lines] == [best, best]


def test_a_round_without_gain_or_candidates_keeps_nothing() -> None:
    """Return nothing where none pays and where there is none."""
    ledger = Ledger(Criterion())
    assert ledger.decide_round(Rule.ADD, [made(79.0, "level_error", "track_bump")], LEVEL) is None
    assert len(ledger.lines) == 1
    assert ledger.decide_round(Rule.ADD, [], LEVEL) is None
    assert len(ledger.lines) == 1


def test_a_round_of_swaps_is_held_against_the_effect_in_its_place() -> None:
    """Keep a candidate only if it beats the fit that holds the place."""
    tried, holder = made(60.0, "track_bump"), made(50.0, "level_error")
    ledger = Ledger(Criterion())
    assert ledger.decide_round(Rule.SWAP, [tried], BASE, holder=holder) is None
    assert ledger.lines[0].evidence.holder is holder
    assert ledger.decide_round(Rule.SWAP, [tried], BASE, holder=LEVEL) is tried


@pytest.fixture
def problem() -> Problem:
    """What a record says of a problem."""
    return cast(
        Problem,
        SimpleNamespace(
            recordings=(SimpleNamespace(name="rec_01"), SimpleNamespace(name="rec_02")),
            readings=1000,
            reading_variance=4e-6,
            colour=WHITE,
            roughness=1.0,
            noise_share=1.0,
            held_command=False,
            model=CAM,
            rig=Rig(),
            declared=(acting("viscous_damping", {"coefficient": 0.01}),),
            settings=DEFAULT,
        ),
    )


def recorded(problem: Problem, *lines: Line) -> LedgerRecord:
    """The record of a selection with these lines."""
    inputs = SourcesRecord(hashes={"rec_01.csv": "0123"}, versions={"numpy": "2.0"})
    return ledger_record(Selection(problem, BASE, BOTH, lines), inputs)


def test_a_record_says_what_determines_the_fits(problem: Problem) -> None:
    """Write down recordings, readings, noise, baseline, rig, known effects and settings, under a hash of all."""
    posed = recorded(problem).problem
    assert (posed.recordings, posed.readings, posed.reading_variance_m2) == (("rec_01", "rec_02"), 1000, 4e-6)
    assert (posed.baseline, posed.rig.mass, posed.inputs.versions) == ("cam", Rig().mass, {"numpy": "2.0"})
    assert [(one.name, one.values) for one in posed.declared] == [("viscous_damping", {"coefficient": 0.01})]
    assert posed.settings["keep"] == DEFAULT.keep
    assert posed.hash == hashed(posed)


def test_fits_stand_in_one_table_with_the_base_first(problem: Problem) -> None:
    """Name every fit that a line or its evidence compares, each once, with its hypothesis and its numbers."""
    evidence = Evidence(winner=BOTH, holder=LEVEL, without=(SPLINE,), before=(1.0,), after=(2.0,), tests=3, nested=True)
    one = Line(Rule.ADD, ("rolling_resistance",), BOTH, LEVEL, evidence, Decision(True, 20.0, "pays"))
    record = recorded(problem, one, one)
    names = list(record.fits)
    said = record.ledger[0]
    assert len(names) == 4
    assert (said.fit, said.against) == (said.evidence.winner, said.evidence.holder)
    assert names == [names[0], said.fit, said.against, *said.evidence.without]
    assert [len(record.fits[name].effects) for name in names] == [0, 2, 1, 1]
    assert record.fits[names[0]].spline_term is None
    assert record.fits[names[3]].spline_term is not None
    both = record.fits[said.fit]
    assert both.parameters == (0.0, 0.0)
    assert (both.process_noise_m2_s3, both.deviance) == (BOTH.process_noise, BOTH.deviance)
    assert both.criterion == Criterion().value(BOTH)
    assert (said.evidence.before, said.evidence.after) == ((1.0,), (2.0,))
    assert (said.evidence.tests, said.evidence.nested) == (3, True)


def test_a_recorded_line_says_what_was_decided(problem: Problem) -> None:
    """Write down what was tried beside what, the decision and its reason, under a hash of them; no evidence is null."""
    said = recorded(problem, line(BOTH, LEVEL, "rolling_resistance")).ledger[0]
    assert (said.effect, said.tried, said.beside) == ("rolling_resistance", ("rolling_resistance",), ("level_error",))
    assert (said.rule, said.kept, said.gain, said.because) == ("add", True, 20.0, "for a reason")
    assert said.hash == hashed(said)
    assert said.evidence.winner is None
    assert said.evidence.holder is None


def test_a_fit_to_other_inputs_has_another_name(problem: Problem) -> None:
    """Let the problem's hash be part of each fit's."""
    other = cast(Problem, SimpleNamespace(**{**vars(problem), "readings": 1001}))
    assert not set(recorded(problem).fits) & set(recorded(other).fits)


def test_a_digest_is_the_start_of_the_sha_256_of_compact_json() -> None:
    """Let others reproduce it: keys in order, no blanks, letters as they are."""
    text = '{"a":[1,0.1],"φ":null}'
    assert digest({"φ": None, "a": [1, 0.1]}) == hashlib.sha256(text.encode()).hexdigest()[:16]
