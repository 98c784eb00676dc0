"""Sobol' indices on the page of a sweep: what is said of those that cannot be right."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from harness.report.page import render_page
from harness.report.sweep.indices import section
from harness.sweeps.indices import Index, Indices
from harness.sweeps.results import MEASURED


@pytest.mark.parametrize(("total", "told"), [(1.08, True), (0.98, False)])
def test_an_index_above_1_is_remarked_on(total: float, told: bool) -> None:
    """Name the factor whose share exceeds all there is, and ask for more samples."""
    indices = Indices("mujoco", MEASURED, {}, (Index("mujoco.friction", 0.9, 0.2, total, 0.2),), 16)
    page = render_page(
        "indices", [section(SimpleNamespace(results=SimpleNamespace(indices=[indices]), measured="measured"))]
    )  # type: ignore[arg-type, list-item]
    assert ("is above 1, which no share is: 16 samples of the design" in page) is told
