"""Whatever bytes a file holds, it is imported or refused with one InputError; nothing else ever comes through."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from harness.errors import InputError
from harness.importing import Options, Understood, read_file, understand
from tests.importing import made
from tests.recording.test_any_bytes import EDITS, edited

CHOSEN = {
    "tek.csv": Options(angle="CH1:0.05 rad/V", position="CH2:0.125 m/V-0.1"),
    "rigol.csv": Options(angle="CH1:0.05 rad/V", position="CH2:0.125 m/V-0.1"),
    "scope.mat": Options(linkage="r=0.05,L=0.4"),
    "free.txt": Options(angle="theta"),
    "monitor.txt": Options(angle="TH:deg"),
}
TEXTS = ("tek.csv", "rigol.csv", "log.lvm", "free.txt", "monitor.txt", "labels.txt", "records.jsonl", "lists.json")
BINARIES = ("scope.mat", "v73.mat", "logsout.mat", "log73.mat", "timetable.mat", "book.xlsx", "log.parquet")


@lru_cache
def sound(name: str) -> bytes:
    """The bytes of a file as its program writes it."""
    with TemporaryDirectory() as folder:
        return made.FILES[name][0](Path(folder) / name).read_bytes()


def outcome(path: Path, options: Options) -> Understood | str:
    """The recording, or the message by which it is refused."""
    try:
        return understand([read_file(path)], options)
    except InputError as error:
        return str(error)


@pytest.mark.slow
@pytest.mark.parametrize("name", [*TEXTS, *BINARIES])
@given(edits=EDITS)
@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_damaged_files(tmp_path: Path, name: str, edits: list[tuple[float, int, bytes]]) -> None:
    """Give a recording or one message that names the file, for a file with stretches of it replaced."""
    path = tmp_path / name
    path.write_bytes(edited(sound(name), edits))
    result = outcome(path, CHOSEN.get(name, Options()))
    assert isinstance(result, Understood) or str(path) in result


@given(content=st.binary(max_size=400))
@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_any_bytes(tmp_path: Path, content: bytes) -> None:
    """Give one message for bytes that are no file of anything."""
    path = tmp_path / "file.dat"
    path.write_bytes(content)
    result = outcome(path, Options())
    assert isinstance(result, Understood) or str(path) in result


MAGIC = [b"MATLAB 5.0 MAT-file", b"\x89HDF\r\n\x1a\n", b"PAR1", b"PK\x03\x04", b"\x89MCAP0\r\n", b"#ROSBAG V2.0\n",
         b"SQLite format 3\x00", b"LabVIEW Measurement\t\n***End_of_Header***\n", b"\xff\xfe"]  # fmt: skip


@given(head=st.sampled_from(MAGIC), content=st.binary(max_size=300))
@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_any_bytes_behind_a_known_beginning(tmp_path: Path, head: bytes, content: bytes) -> None:
    """Give one message for what begins like a known format and goes on like none."""
    path = tmp_path / "file.mcap"
    path.write_bytes(head + content)
    result = outcome(path, Options())
    assert isinstance(result, Understood) or str(path) in result


@given(text=st.text(alphabet="0123456789.,;:\t \n-eEtxs#\"'()[]°µ/=+", max_size=300))
@settings(max_examples=200, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_any_text_of_numbers(tmp_path: Path, text: str) -> None:
    """Give a recording or one message for text that looks like numbers."""
    path = tmp_path / "file.txt"
    path.write_text(text, encoding="utf-8")
    result = outcome(path, Options(time="1:s", angle="2:rad", position="3:m"))
    assert isinstance(result, Understood) or str(path) in result


@pytest.mark.slow
@given(text=st.text(max_size=40))
@settings(max_examples=200, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_any_options(tmp_path: Path, text: str) -> None:
    """Give a recording or one message for whatever is written as a column or a linkage."""
    path = tmp_path / "log.lvm"
    if not path.exists():
        path.write_bytes(sound("log.lvm"))
    for options in (Options(position=text), Options(linkage=text), Options(time=text)):
        assert outcome(path, options)


def test_a_workbook_is_told_by_its_bytes(tmp_path: Path) -> None:
    """Read a spreadsheet under any name, as every other format."""
    path = tmp_path / "book.bak"
    path.write_bytes(sound("book.xlsx"))
    assert isinstance(outcome(path, Options()), Understood)


def test_a_separator_without_a_name_is_a_tab(tmp_path: Path) -> None:
    """Read a LabVIEW file whose header has the key Separator and no value."""
    path = tmp_path / "log.lvm"
    path.write_bytes(sound("log.lvm").replace(b"Separator\tTab", b"Separator", 1))
    assert b"Separator\n" in path.read_bytes() or b"Separator\r" in path.read_bytes()
    assert isinstance(outcome(path, Options()), Understood)
