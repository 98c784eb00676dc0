"""Diagnoses made without a search, so that a test of what is done with them takes seconds."""

from __future__ import annotations

from pathlib import Path

from harness.identify.estimate.fit import fit
from harness.identify.model_file import model_record
from harness.identify.pose import problem_of
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.record import (
    AllErrorsRecord,
    BeforeAfterRecord,
    DiagnosisRecord,
    ErrorsRecord,
    InputsRecord,
    SourcesRecord,
)
from harness.identify.selection.ledger_record import ledger_record
from harness.identify.selection.search import Selection
from harness.recording import load_case

NO_ERRORS = ErrorsRecord(rms_m={}, innovation_correlation=None, innovation_over_noise=None, innovation_on_beam={})
BOTH = BeforeAfterRecord(before=NO_ERRORS, after=NO_ERRORS)


def nothing_missing(folder: Path) -> DiagnosisRecord:
    """The record of a diagnosis that tried nothing: its model is the rig as declared."""
    case = load_case(folder)
    problem = problem_of(case)
    base = fit(problem, Hypothesis(()))
    ledger = ledger_record(Selection(problem, base, base, ()), SourcesRecord(hashes={}, versions={}))
    return DiagnosisRecord(
        verdict="none",
        sentence="Nothing is missing.",
        effects=(),
        unlisted=None,
        errors=AllErrorsRecord(identify=BOTH, heldout=BOTH, engines={}, engines_enter={}, also={}),
        hidden_by_unknown_rig=(),
        baselines=None,
        ledger=ledger.ledger,
        fits=ledger.fits,
        found=ledger.found,
        problem=ledger.problem,
        model=model_record(problem, base, case.sensors),
        inputs=InputsRecord(hashes={}, versions={}, also={}, seed=0),
        next_experiment=None,
        wall_time_s=0.0,
    )
