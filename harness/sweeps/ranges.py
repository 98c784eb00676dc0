"""What a key of `sweep.toml` may be given: a value, a list of values, or a range."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, model_validator


class Range(BaseModel):
    """A range of values; `levels` of them in a grid."""

    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False, frozen=True)
    low: float
    high: float
    scale: Literal["lin", "log"] = "lin"
    levels: Annotated[int, Field(ge=2)] | None = None

    @model_validator(mode="after")
    def _ordered(self) -> Range:
        if not self.low < self.high:
            raise ValueError(f"low {self.low:g} is not below high {self.high:g}")
        if self.scale == "log" and self.low <= 0.0:
            raise ValueError(f"low {self.low:g} has no logarithm; give a positive one, or leave out scale")
        return self


Value = float | int | bool | str
Varied = Range | list[Value] | Value
