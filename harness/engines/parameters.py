"""Settings that every engine has; importing them loads no engine and no solver."""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict, Field


class EngineParameters(BaseModel):
    """Settings of one engine. Field names are what the user types (`--set mujoco.friction=0.3`); each field has a
    description with its unit, a default that attains the validated accuracy, and bounds."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    time_step: float = Field(1e-3, gt=0.0, le=0.02, description="integration step [s]")
    slip_limit: float = Field(
        0.01, gt=0.0, le=100.0, description="slip velocity beyond which a run counts as sliding [m/s]"
    )

    @classmethod
    def unit_of(cls, name: str) -> str:
        """Unit of a setting, as its description has it; "1" for a number."""
        return (cls.model_fields[name].description or "").partition("[")[2].partition("]")[0] or "1"
