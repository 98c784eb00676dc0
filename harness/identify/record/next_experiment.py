"""The proposed next experiment."""

from __future__ import annotations

from harness.identify.record.parts import Finite, Number, RecordPart


class SeparationRecord(RecordPart):
    """Separation of the identified model from a rival [σ]."""

    found: str
    rival: str
    at_hand: Number
    expected: Number
    needed: Number
    told: bool


class LimitsRecord(RecordPart):
    """The operating envelope."""

    ball_position_m: tuple[Finite, Finite]
    beam_angle_rad: Finite
    beam_rate_rad_s: Finite
    beam_acceleration_rad_s2: Finite


class NextExperimentRecord(RecordPart):
    """The proposed next experiment; its beam angle is in `file`."""

    profile: str
    does: str
    sentence: str
    file: str
    duration_s: Finite
    separations: tuple[SeparationRecord, ...]
    tried: dict[str, Number]
    open_loop_drift_m: Number
    limits: LimitsRecord
