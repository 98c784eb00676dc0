"""What is left for a spline term to explain, sample by sample, over what the term depends on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from analytic.motion import FloatArray
from analytic.rig import Rig
from harness.identify.filter.run import run_filter
from harness.identify.problem.problem import PreparedRecording
from harness.identify.problem.spline_term import Regressor, SplineTerm
from harness.identify.validation.residual_acceleration import ResidualAcceleration, residual_acceleration
from harness.report.clouds import stamped
from harness.report.diagnosis.account import Account

_MIN_ROLLING_SPEED = 0.03  # above which the sign of the velocity is certain [m/s]


@dataclass(frozen=True)
class Samples:
    """Samples of all recordings.

    Attributes:
        where: argument of the spline term, shape (n,), in its unit.
        left: what is left of it to explain, shape (n,), in the unit of the nodes.
        notes: recording and time of each, n texts.
    """

    where: FloatArray
    left: FloatArray
    notes: Sequence[str]

    def within(self, first: float, last: float) -> Samples:
        """Those whose argument is not outside of `first` and `last`."""
        at = np.flatnonzero((self.where >= first) & (self.where <= last))
        return Samples(self.where[at], self.left[at], [self.notes[one] for one in at.tolist()])


def samples_of(account: Account, spline: SplineTerm) -> Samples:
    """Errors of readings for a term of the sensor, else the residual of the motion, at trusted readings."""
    return _misread(account) if spline.sensor else _left(account, spline)


def _misread(account: Account) -> Samples:
    """Where the model's filtered ball is [m], and what readings are more than a sensor without an error gives there."""
    diagnosis = account.diagnosis
    wheres, lefts, notes = [], [], []
    for record in diagnosis.problem.recordings:
        run = run_filter(diagnosis.problem, record, diagnosis.found.terms, diagnosis.found.process_noise)
        known = np.isfinite(record.reading)
        lies = run.state[known, 3]
        wheres.append(lies)
        lefts.append(record.reading[known] - replace(run.sensor, error=None).curve(lies))
        notes += stamped(record.time[known], record.name)
    return Samples(np.concatenate(wheres), np.concatenate(lefts), notes)


def _left(account: Account, spline: SplineTerm) -> Samples:
    """Residual of the model with the listed effects in the unit of the nodes, and its abscissa, at trusted readings."""
    diagnosis, k = account.diagnosis, account.diagnosis.problem.rig.rolling_ratio
    listed = replace(diagnosis.found, terms=replace(diagnosis.found.terms, spline=None))
    wheres, lefts, notes = [], [], []
    each = zip(diagnosis.problem.recordings, account.residual_accelerations, diagnosis.found.terms.phases, strict=True)
    for record, seen, phase in each:
        explained = residual_acceleration(diagnosis.problem, listed, record, account.ball(record)).law
        where = _along(spline, record, seen, diagnosis.problem.rig, float(phase))
        left, use = (seen.residual - explained) / k, seen.trusted
        if spline.friction:
            normal = _normal(record, seen, diagnosis.problem.rig)
            use = use & (np.abs(seen.velocity) > _MIN_ROLLING_SPEED) & (normal > 0.0)
            left = -np.sign(seen.velocity) * left / np.where(normal > 0.0, normal, 1.0)
        wheres.append(where[use])
        lefts.append(left[use])
        notes += stamped(seen.time[use], record.name)
    return Samples(np.concatenate(wheres), np.concatenate(lefts), notes)


def _along(
    spline: SplineTerm, record: PreparedRecording, seen: ResidualAcceleration, rig: Rig, phase: float
) -> FloatArray:
    """Argument of the spline term at the stamps of a recording; `phase` is the ball's initial roll phase [rad]."""
    match spline.depends:
        case Regressor.POSITION:
            return spline.low + (seen.position - spline.low) % spline.period if spline.periodic else seen.position
        case Regressor.VELOCITY:
            return seen.velocity
        case Regressor.ANGLE:
            return seen.angle
        case Regressor.ROLL_ANGLE:
            return ((seen.position - record.origin) / rig.rolling_radius + phase) % (2.0 * np.pi)
        case Regressor.TIME:
            return seen.time


def _normal(record: PreparedRecording, seen: ResidualAcceleration, rig: Rig) -> FloatArray:
    """N/m = g cos α − 2 ṡ α̇ − s α̈ − (h + r) α̇² at the stamps [m/s²]."""
    angle, rate, angular = record.drive.states_at(record.time).T
    arm = rig.eccentricity + rig.rolling_radius
    turning = 2.0 * seen.velocity * rate + seen.position * angular + arm * rate**2
    return np.asarray(rig.gravity * np.cos(angle) - turning)
