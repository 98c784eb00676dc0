"""`harness diagnose` on a rig whose controller shakes the beam within the counts of its encoder."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.acceptance.conftest import call
from tests.identify.selection.test_beam_roughness import RESISTANCE, SEED, followed


@pytest.mark.slow
def test_a_beam_that_moves_within_its_counts_is_told_and_replayed(tmp_path: Path) -> None:
    """Keep the roughness that the ball tells, show it among the inputs, and come to the same conclusions with it."""
    case, out = tmp_path / "case", tmp_path / "out"
    case.mkdir()
    followed(case, SEED)
    done = call(tmp_path, "diagnose", case, "--out", out)
    assert done.code == 0, done.err
    found = json.loads((out / "diagnosis.json").read_text(encoding="utf-8"))
    assert [one["name"] for one in found["effects"]] == [RESISTANCE]
    assert found["model"]["roughness"] == found["problem"]["roughness"] > 1.0
    page = (out / "diagnosis.html").read_text(encoding="utf-8")
    assert "times as dense as the angle's readings tell" in page.replace("&#39;", "'")
    replayed = call(tmp_path, "replay", out, case)
    assert replayed.code == 0, replayed.out
    assert "nothing differs" in replayed.out
