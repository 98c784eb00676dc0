"""Which reader a file needs, by its first bytes; its name only tells files of ROS 2, and spreadsheets, apart."""

from __future__ import annotations

from pathlib import Path

from harness.errors import InputError
from harness.importing.bytes import head_of
from harness.importing.json_file import NAMES as JSON_NAMES
from harness.importing.json_file import read_json
from harness.importing.matlab import HDF5
from harness.importing.matlab_process import read_apart
from harness.importing.ros import is_bag, read_bag
from harness.importing.signals import SourceFile
from harness.importing.tables import read_parquet, read_workbook
from harness.importing.text_file import read_text

_OLD_SPREADSHEET = b"\xd0\xcf\x11\xe0"
_NAMES = ".mat, .xlsx, .parquet, .lvm, .csv, .txt, .json, .mcap, .bag, .db3, or the folder of a ROS 2 bag"


def read_file(path: Path) -> SourceFile:
    """Reads a file of any format that can be imported.

    Raises:
        InputError: it cannot be read; the message says what to do.
    """
    if is_bag(path):
        return read_bag(path)
    head = head_of(path)
    if not head.strip():
        raise InputError(f"{path}: is empty. Check that the recording was saved completely.")
    binary = head.startswith((b"MATLAB", b"\x00\x00\x00\x00")) or HDF5 in head
    if not binary and path.suffix.lower() == ".mat" and _is_text(head):
        raise InputError(
            f"{path}: text, and no MAT-file. Rename it to .csv or .txt if it is a table; of Octave's text format save "
            "it again with save('-v7', 'log.mat')."
        )
    if binary or path.suffix.lower() == ".mat":
        return read_apart(path)
    if head.startswith(b"PAR1"):
        return read_parquet(path)
    if head.startswith(b"PK\x03\x04"):
        return read_workbook(path)
    if head.startswith(_OLD_SPREADSHEET):
        raise InputError(f"{path}: an .xls file of old. Save it as .xlsx or as CSV from the spreadsheet program.")
    if b"\0" in head and not head.startswith((b"\xff\xfe", b"\xfe\xff")):
        raise InputError(f"{path}: binary data of an unknown format. Known are {_NAMES}.")
    if path.suffix.lower() in JSON_NAMES or head.lstrip(b"\xef\xbb\xbf \t\r\n").startswith((b"{", b"[{")):
        return read_json(path)
    return read_text(path)


def _is_text(head: bytes) -> bool:
    """Whether the first bytes of a file are text; the last of them may be cut off."""
    return all(byte >= 0x20 or byte in b"\t\r\n\f" for byte in head)
