"""Reads a text file: SHA-256 of its bytes, decoding, normalised line ends."""

import codecs
import hashlib
import stat
from dataclasses import dataclass
from pathlib import Path

from harness.errors import InputError

UTF16_MARKS = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)
SPREADSHEET_MARKS = (b"PK\x03\x04", b"\xd0\xcf\x11\xe0")  # xlsx and ods; xls


@dataclass(frozen=True)
class Source:
    """A file's text and the SHA-256 of its bytes (hexadecimal)."""

    text: str
    sha256: str


def read_source(path: Path) -> Source:
    """Reads a text file in UTF-8 or UTF-16, with or without a byte order mark; line ends become `\\n`.

    Bytes that are not valid UTF-8 are decoded as Windows-1252, in which loggers write `°` and `µ`.

    Raises:
        InputError: the file cannot be read or is not text.
    """
    try:
        if not stat.S_ISREG(path.stat().st_mode):  # reading a pipe or a device may never end
            kind = "a folder" if path.is_dir() else "a pipe or a device"
            raise InputError(f"{path}: {kind}, not a file. Save the data in a file, and pass that.")
        raw = path.read_bytes()
    except FileNotFoundError:
        raise InputError(f"{path}: there is no such file. Check the path.") from None
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}). Check its permissions.") from None
    if raw.startswith(SPREADSHEET_MARKS):
        raise InputError(f"{path}: a spreadsheet, not a text file. Save it as CSV from the spreadsheet program.")
    if raw.startswith(UTF16_MARKS):
        encoding = "utf-16"
    elif b"\0" in raw:
        raise InputError(f"{path}: binary data, not text. Export the recording as a CSV file in UTF-8.")
    else:
        encoding = "utf-8-sig"
    try:
        text = raw.decode(encoding)
    except UnicodeDecodeError:
        text = raw.decode("cp1252", errors="replace")
    return Source(text.replace("\r\n", "\n").replace("\r", "\n"), hashlib.sha256(raw).hexdigest())
