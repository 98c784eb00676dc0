"""Standard error of the process, for libraries that write into it from C."""

from __future__ import annotations

import contextlib
import os
import tempfile
from collections.abc import Iterator

STDERR = 2  # C code knows the file descriptor alone; sys.stderr can be replaced without it noticing


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
