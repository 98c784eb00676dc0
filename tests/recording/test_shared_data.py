"""The cases and recordings handed out with the project load, and only true things are said about them."""

from __future__ import annotations

from pathlib import Path

import pytest

from harness.recording import inferred_resolution, load_case
from tests.shared_data import CASES, measured_rigs

pytestmark = pytest.mark.slow

needs_shared = pytest.mark.skipif(not CASES.is_dir(), reason="the folder ../shared is absent")


@needs_shared
@pytest.mark.parametrize("folder", sorted(path.parent for path in CASES.glob("*/rig.toml")), ids=lambda path: path.name)
def test_simulated_cases_raise_no_plausibility_warning(folder: Path) -> None:
    """Warn of nothing in the simulated cases, whatever effect is hidden in them."""
    case = load_case(folder)
    assert (case.identify, case.predict) == (("rec_01.csv", "rec_02.csv"), ("rec_03.csv",))
    assert case.rig.unknown == ()
    assert [finding for finding in case.findings if finding.severity == "warning"] == []
    for name in case.identify:
        recording = case.recordings[name]
        assert recording.known.all()
        assert not recording.outlier.any()
        # The rig files give nine digits, the angles are printed to 1e-7 rad over at least 0.04 rad.
        assert inferred_resolution(recording.angle) == pytest.approx(case.sensors.angle_resolution, rel=5e-6)


@pytest.mark.parametrize("folder", measured_rigs(), ids=lambda path: path.name)
def test_real_recordings_only_show_spikes(folder: Path) -> None:
    """Warn of outliers in one real rig's sensor, and of no unit or sign on any."""
    case = load_case(folder)
    for recording in case.recordings.values():
        warnings = [finding.text for finding in recording.findings if finding.severity == "warning"]
        assert all("are outliers" in text for text in warnings)
        assert len(warnings) == recording.outlier.any()
    assert case.rig.unknown
