"""Standard output and error of the process, for libraries that write into them from C."""

from __future__ import annotations

import contextlib
import ctypes
import os
import sys
import tempfile
from collections.abc import Iterator

STDOUT, STDERR = 1, 2  # C code knows the file descriptor alone; sys.stderr can be replaced without it noticing


@contextlib.contextmanager
def without_lines(prefix: bytes) -> Iterator[None]:
    """Drop the lines that begin with `prefix` from the standard error of the process.

    Everything else that is written meanwhile, by other threads too, comes out at the end, also when the block raises.
    """
    try:
        kept = os.dup(STDERR)
    except OSError:  # closed: nothing can be seen there
        yield
        return
    with tempfile.TemporaryFile() as caught:
        os.dup2(caught.fileno(), STDERR)
        try:
            yield
        finally:
            os.dup2(kept, STDERR)
            os.close(kept)
            caught.seek(0)
            os.write(STDERR, b"".join(line for line in caught if not line.startswith(prefix)))


@contextlib.contextmanager
def without_output() -> Iterator[list[str]]:
    """Keep C code from writing to the standard output of the process, where JSON may go.

    Yields:
        A list that has what was written, as one text, when the block has ended.
    """
    said: list[str] = []
    try:
        kept = os.dup(STDOUT)
    except OSError:  # closed: nothing can be seen there
        yield said
        return
    with tempfile.TemporaryFile() as caught:
        _flush()
        os.dup2(caught.fileno(), STDOUT)
        try:
            yield said
        finally:
            _flush()
            os.dup2(kept, STDOUT)
            os.close(kept)
            caught.seek(0)
            said.append(caught.read().decode(errors="replace"))


def _flush() -> None:
    """Write what Python and C have buffered, to where standard output goes now."""
    sys.stdout.flush()
    with contextlib.suppress(OSError, AttributeError, TypeError):  # no C library of this process to be found
        ctypes.CDLL(None).fflush(None)
