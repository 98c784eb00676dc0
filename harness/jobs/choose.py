"""Where jobs run: on this machine, or on a Dask cluster that the user names."""

from __future__ import annotations

import re

from harness.errors import InputError
from harness.jobs.interface import Executor
from harness.jobs.local import Local
from harness.jobs.one_process import OneProcess


def executor_on(place: str = "", workers: int | None = None) -> Executor:
    """The executor for `--on`.

    Args:
        place: `dask://host:port`, address of a Dask scheduler; empty for this machine.
        workers: processes on this machine; `None` for one a processor, 0 for none but this one.

    Raises:
        InputError: no such place, the extra `dask` is not installed, or the scheduler cannot be used.
    """
    if not place:
        return OneProcess() if workers == 0 else Local(workers)
    found = re.fullmatch(r"dask://([^/:]+|\[[^]]+\]):(\d+)/?", place)
    if found is None:
        raise InputError(f"--on {place}: write dask://host:port, the address of a Dask scheduler")
    try:
        from harness.jobs.cluster import Dask
    except ImportError as error:
        raise InputError(f"--on {place}: {error}; install the extra: pip install 'ball-beam-harness[dask]'") from error
    return Dask(f"tcp://{found[1]}:{found[2]}")
