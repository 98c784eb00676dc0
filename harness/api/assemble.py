"""diagnosis.json from what a diagnosis found."""

from collections.abc import Iterable, Mapping, Sequence

from harness.api.acceptance import findings_of
from harness.failures import Failed
from harness.identify.design import proposal
from harness.identify.design.proposal import Proposal
from harness.identify.diagnosis import Diagnosis
from harness.identify.model_file import model_record
from harness.identify.problem.spline_term import SplineTerm
from harness.identify.problem.windows import AHEAD, KNOWN
from harness.identify.record import (
    AllErrorsRecord,
    AlsoRecord,
    BaselinesRecord,
    BeforeAfterRecord,
    DependenceRecord,
    DiagnosisRecord,
    EffectRecord,
    EngineRecord,
    ErrorsRecord,
    FailureRecord,
    FindingRecord,
    InputsRecord,
    LimitsRecord,
    MarginRecord,
    NextExperimentRecord,
    SeparationRecord,
    ShapeRecord,
    SourcesRecord,
    UnlistedRecord,
)
from harness.identify.rig_completion import contradicted
from harness.identify.selection.ledger_record import ledger_record
from harness.identify.validation.baseline_comparison import BASELINES, BaselineComparison
from harness.identify.validation.engine_errors import entries
from harness.identify.validation.held_out import BeforeAfter, Errors
from harness.provenance import versions
from harness.recording import Case, Recording
from harness.report.wording import sentence


def diagnosis_record(
    found: Diagnosis, case: Case, wall_time: float, hashes: Mapping[str, str], further: Sequence[Recording] = ()
) -> DiagnosisRecord:
    """The record of a diagnosis.

    Args:
        found: what was found.
        case: from which.
        wall_time: that it took [s].
        hashes: SHA-256 of every input file, by name.
        further: recordings that nothing was fitted to.
    """
    spline = found.found.terms.spline
    inputs = SourcesRecord(hashes=dict(hashes), versions=versions())
    ledger = ledger_record(found.selection, inputs)
    return DiagnosisRecord(
        verdict=found.verdict.value,
        sentence=sentence(found),
        effects=tuple(EffectRecord.model_validate(one) for one in found.effects),
        unlisted=None
        if spline is None
        else UnlistedRecord(depends_on=tuple(one.value for one in found.depends_on), shape=_shape(spline)),
        errors=AllErrorsRecord(
            identify=_before_after(found.identify),
            heldout=_before_after(found.heldout),
            engines=_engines(found.engines),
            engines_enter=entries(found.found),
            also={
                name: AlsoRecord(
                    before=_errors(one.errors.before), after=_errors(one.errors.after), engines=_engines(one.engines)
                )
                for name, one in found.also.items()
            },
        ),
        hidden_by_unknown_rig=found.hidden,
        baselines=None if found.baselines is None else _baselines(found.baselines),
        ledger=ledger.ledger,
        fits=ledger.fits,
        found=ledger.found,
        problem=ledger.problem,
        model=model_record(found.problem, found.found, case.sensors, found.forecasting),
        inputs=InputsRecord(
            hashes=inputs.hashes, versions=inputs.versions, also={one.name: one.sha256 for one in further}, seed=0
        ),
        next_experiment=None if found.next_experiment is None else _next_experiment(found.next_experiment),
        failures=failure_records(found.failures),
        findings=tuple(
            FindingRecord.model_validate(one)
            for one in (*findings_of(case, further), contradicted(case.rig, found.problem.rig))
            if one is not None
        ),
        wall_time_s=round(wall_time, 2),
    )


def failure_records(failures: Iterable[Failed]) -> tuple[FailureRecord, ...]:
    """Failures as diagnosis.json has them."""
    return tuple(FailureRecord.model_validate(one) for one in failures)


def _shape(spline: SplineTerm) -> ShapeRecord:
    return ShapeRecord(
        at=tuple(spline.places.tolist()),
        values=tuple(spline.nodes.tolist()),
        unit=spline.unit,
        friction=spline.friction,
        sensor=spline.sensor,
        low=spline.low,
        step=spline.step,
        periodic=spline.periodic,
    )


def _engines(engines: Mapping[str, object]) -> dict[str, EngineRecord]:
    return {name: EngineRecord.model_validate(one) for name, one in engines.items()}


def _before_after(one: BeforeAfter) -> BeforeAfterRecord:
    return BeforeAfterRecord(before=_errors(one.before), after=_errors(one.after))


def _errors(one: Errors) -> ErrorsRecord:
    return ErrorsRecord(
        rms_m=dict(one.rms),
        innovation_correlation=round(one.innovation_correlation, 4),
        innovation_over_noise=round(one.innovation_over_noise, 4),
        innovation_on_beam={
            name: DependenceRecord(p=test.p, correlation=round(test.correlation, 4), lag_s=round(test.lag, 3))
            for name, test in one.beam.items()
        },
    )


def _baselines(compared: BaselineComparison) -> BaselinesRecord:
    margins = {name: compared.margin(name) for name in BASELINES}
    return BaselinesRecord(
        known_s=KNOWN,
        ahead_s=AHEAD,
        blocks=compared.blocks,
        rms_m={source: compared.rms(source) for source in compared.errors},
        errors_m={source: tuple(errors.tolist()) for source, errors in compared.errors.items()},
        blocks_won={name: compared.won(name) for name in BASELINES},
        predicting=compared.predicting,
        better_by_m={name: one and MarginRecord.model_validate(one) for name, one in margins.items()},
    )


def _next_experiment(one: Proposal) -> NextExperimentRecord:
    envelope = one.envelope
    return NextExperimentRecord(
        profile=one.profile.name,
        does=one.profile.words,
        sentence=proposal.sentence(one),
        file=proposal.FILE,
        duration_s=float(one.time[-1]),
        separations=tuple(SeparationRecord.model_validate(each) for each in one.separations),
        tried=dict(one.tried),
        open_loop_drift_m=one.open_loop_drift,
        limits=LimitsRecord(
            ball_position_m=(envelope.low, envelope.high),
            beam_angle_rad=envelope.angle,
            beam_rate_rad_s=envelope.rate,
            beam_acceleration_rad_s2=envelope.acceleration,
        ),
    )
