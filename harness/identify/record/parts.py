"""What every part of the record is made of: finite numbers, null for what is not finite, strict fields."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field

Finite = Annotated[float, Field(allow_inf_nan=False)]
Positive = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]
NotNegative = Annotated[float, Field(ge=0.0, allow_inf_nan=False)]


def _null(value: Any) -> Any:
    return None if isinstance(value, float) and not abs(value) < float("inf") else value


Number = Annotated[Finite | None, BeforeValidator(_null)]
"""A number, or null if it is not finite."""


class RecordPart(BaseModel):
    """A part of the record, read from JSON or from the attributes of a dataclass."""

    model_config = ConfigDict(
        extra="forbid", frozen=True, from_attributes=True, populate_by_name=True, defer_build=True
    )
