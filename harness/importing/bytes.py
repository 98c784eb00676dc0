"""Bytes of a file: what it is by its first ones, and its hash."""

from __future__ import annotations

import hashlib
import stat
from pathlib import Path

from harness.errors import InputError


def head_of(path: Path, count: int = 1024) -> bytes:
    """The first bytes of a regular file.

    Raises:
        InputError: there is no such file, or it cannot be read.
    """
    try:
        if not stat.S_ISREG(path.stat().st_mode):  # reading a pipe or a device may never end
            kind = "a folder" if path.is_dir() else "a pipe or a device"
            raise InputError(f"{path}: {kind}, not a file. Pass the file that holds the recording.")
        with path.open("rb") as stream:
            return stream.read(count)
    except FileNotFoundError:
        raise InputError(f"{path}: there is no such file. Check the path.") from None
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}). Check its permissions.") from None


def sha256_of(path: Path) -> str:
    """SHA-256 of a file's bytes (hexadecimal)."""
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()
