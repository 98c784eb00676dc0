"""Detection limits in words."""

from __future__ import annotations

import math

from harness.formatting import number
from harness.identify.design.detection import Limit

BEYOND = "no size"
AS_RECORDED = "the expected gain reaches the threshold of the diagnosis, while the model lacks what it lacks now"
EXPLAINED = "the same once everything else that is missing has been found"


def limit_text(one: Limit, limit: float) -> str:
    """A limit in words: a number, `below` it for an effect of small values, or that no size shows."""
    if limit == 0.0 or math.isinf(limit):
        return BEYOND
    return f"below {number(limit)}" if one.inverse else number(limit)
