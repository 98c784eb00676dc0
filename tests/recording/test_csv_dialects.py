"""A CSV is read the same whichever program wrote it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from harness.recording import Recording, load_recording
from tests.recording.simulated import contract_columns, csv_text, simulated

COLUMNS = contract_columns()


def load_text(folder: Path, text: str, encoding: str = "utf-8") -> Recording:
    """The recording that `text` in a file becomes."""
    path = folder / "rec.csv"
    path.write_bytes(text.encode(encoding))
    return load_recording(path)


def assert_is_simulated(recording: Recording) -> None:
    """Every number survives to the last bit, as it was written in full."""
    for got, expected in zip((recording.time, recording.angle, recording.position), simulated(), strict=True):
        np.testing.assert_array_equal(got, expected)


@pytest.mark.parametrize(
    ("separator", "decimal"), [(",", "."), (";", "."), ("\t", "."), (";", ","), ("\t", ",")], ids=str
)
def test_separator_and_decimal_mark(tmp_path: Path, separator: str, decimal: str) -> None:
    """Read comma, semicolon and tab, and decimal commas where they do not separate."""
    assert_is_simulated(load_text(tmp_path, csv_text(COLUMNS, separator=separator, decimal=decimal)))


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16"])
@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_encoding_and_line_ends(tmp_path: Path, encoding: str, end: str) -> None:
    """Read files with and without byte order mark, from any operating system."""
    assert_is_simulated(load_text(tmp_path, csv_text(COLUMNS).replace("\n", end), encoding))


def test_windows_1252(tmp_path: Path) -> None:
    """Read a degree sign from a logger that knows no UTF-8."""
    text = csv_text({"time_s": COLUMNS["time_s"], "angle °": np.degrees(COLUMNS["beam_angle_rad"])})
    recording = load_text(tmp_path, text, "cp1252")
    np.testing.assert_allclose(recording.angle, COLUMNS["beam_angle_rad"], rtol=1e-15, atol=0)


def test_decoration(tmp_path: Path) -> None:
    """Skip comments, blank rows, rows of separators only, trailing separators; strip quotes and blanks."""
    header, *rows = csv_text(COLUMNS).splitlines()
    quoted = [",".join(f' "{cell}" ' for cell in row.split(",")) + "," for row in rows]
    quoted[5:5] = ["", "# the ball was nudged here", ",,,", "   "]
    assert_is_simulated(load_text(tmp_path, "\n".join(["# rig 3", "", header + ",", *quoted])))


def test_announced_separator(tmp_path: Path) -> None:
    """Obey the line by which spreadsheet programs announce their separator."""
    assert_is_simulated(load_text(tmp_path, "sep=;\n" + csv_text(COLUMNS, separator=";")))


def test_header_in_comment(tmp_path: Path) -> None:
    """Take the names from the comment above the numbers, where numpy.savetxt writes them."""
    path = tmp_path / "rec.csv"
    np.savetxt(path, np.column_stack(list(COLUMNS.values())), "%.17g", delimiter=",", header=",".join(COLUMNS))
    assert_is_simulated(load_recording(path))


@pytest.mark.parametrize("blank", ["", "nan", "NaN", "NA", "n/a", "null", "-"])
def test_unknown_positions(tmp_path: Path, blank: str) -> None:
    """Keep unknown positions as NaN and say how many there are."""
    columns = {**COLUMNS, "ball_position_m": COLUMNS["ball_position_m"].copy()}
    columns["ball_position_m"][200:] = np.nan
    recording = load_text(tmp_path, csv_text(columns, blank=blank))
    np.testing.assert_array_equal(recording.position, columns["ball_position_m"])
    assert not recording.known[200:].any()
    unknown = len(recording.time) - 200
    assert any(f"unknown in {unknown} of" in finding.text for finding in recording.findings)


def test_without_positions(tmp_path: Path) -> None:
    """Accept a recording of the angle alone."""
    recording = load_text(tmp_path, csv_text({name: COLUMNS[name] for name in ("time_s", "beam_angle_rad")}))
    assert np.isnan(recording.position).all()
    assert recording.velocity is None
    assert not recording.outlier.any()


def test_arrays_are_read_only(tmp_path: Path) -> None:
    """Refuse to let anybody change what was measured."""
    recording = load_text(tmp_path, csv_text(COLUMNS))
    with pytest.raises(ValueError, match="read-only"):
        recording.position[0] = 0.0


def test_hash_is_of_the_bytes(tmp_path: Path) -> None:
    """Give the SHA-256 that any other program would compute for the file."""
    import hashlib

    recording = load_text(tmp_path, csv_text(COLUMNS))
    assert recording.sha256 == hashlib.sha256((tmp_path / "rec.csv").read_bytes()).hexdigest()
