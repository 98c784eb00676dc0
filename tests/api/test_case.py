"""A case shows itself: recordings, what is known, findings."""

from __future__ import annotations

from pathlib import Path

import pytest

import harness
from tests.acceptance.short import write_short_case


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two recordings of a rig whose ball nobody weighed."""
    return write_short_case(tmp_path_factory.mktemp("case") / "my_rig", known={"gravity_m_s2": 9.81})


def test_a_case_shows_what_is_in_it(folder: Path) -> None:
    """Name recordings, known and unknown quantities with units, and findings, as text and as HTML."""
    case = harness.load_case(folder)
    for shown in (repr(case), case._repr_html_()):
        for text in (
            "my_rig",
            "rec_01.csv",
            "identify",
            "9.81",
            "m/s²",
            "not known",
            *(f.text[:30] for f in case.findings),
        ):
            assert text in shown, text
        assert all(finding.text[:30] in shown for finding in case.findings)
    assert "array(" not in repr(case)


def test_the_bundled_case_is_the_default() -> None:
    """Load the recordings that come with the package, and say that they are simulated."""
    assert "simulated" in repr(harness.load_case())


def test_a_bad_path_raises_the_message_of_the_command(tmp_path: Path) -> None:
    """Raise an error that carries the one message."""
    with pytest.raises(harness.InputError, match="there is no such file or folder"):
        harness.load_case(tmp_path / "nothing")
