"""Whatever bytes a file holds, the door opens or refuses with an InputError; nothing else ever comes through."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from harness.errors import InputError
from harness.recording import Case, load_case
from tests.recording.simulated import contract_columns, csv_text
from tests.recording.test_rig_file import FULL

SOUND = csv_text({name: values[:120] for name, values in contract_columns().items()}).encode()
PIECES = st.one_of(
    st.sampled_from(
        [
            b"",
            b",",
            b";",
            b"\n",
            b"\t",
            b'"',
            b"#",
            b"nan",
            b"-",
            b"1e999",
            b"e300",
            b"e-300",
            b"\x00",
            b"\xb0",
            b"\xef\xbb\xbf",
        ]
    ),
    st.binary(max_size=6),
)
EDITS = st.lists(st.tuples(st.floats(0.0, 1.0), st.integers(0, 40), PIECES), min_size=1, max_size=6)


def edited(raw: bytes, edits: list[tuple[float, int, bytes]]) -> bytes:
    """`raw` with stretches replaced by pieces."""
    for at, length, piece in edits:
        begin = int(at * len(raw))
        raw = raw[:begin] + piece + raw[begin + length :]
    return raw


def outcome(path: Path) -> Case | str:
    """The case, or the message by which it is refused."""
    try:
        return load_case(path)
    except InputError as error:
        return str(error)


@given(edits=EDITS)
@settings(max_examples=120, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_damaged_recording(tmp_path: Path, edits: list[tuple[float, int, bytes]]) -> None:
    """Give checked arrays or one InputError for a damaged CSV."""
    path = tmp_path / "rec.csv"
    path.write_bytes(edited(SOUND, edits))
    case = outcome(path)
    if isinstance(case, str):
        assert str(path) in case
        return
    (recording,) = case.recordings.values()
    assert np.all(np.diff(recording.time) > 0)
    assert np.isfinite(recording.angle).all()
    assert len(recording.time) == len(recording.angle) == len(recording.position) == len(recording.outlier)


@given(edits=EDITS)
@settings(max_examples=120, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_damaged_rig_file(tmp_path: Path, edits: list[tuple[float, int, bytes]]) -> None:
    """Give a case or one InputError for a damaged rig.toml."""
    for name in ("rec_01.csv", "rec_02.csv"):
        (tmp_path / name).write_bytes(SOUND)
    (tmp_path / "rig.toml").write_bytes(edited(FULL.encode(), edits))
    case = outcome(tmp_path)
    assert isinstance(case, Case) or str(tmp_path) in case
