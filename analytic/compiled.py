"""numba's `njit` with a cache on disk that no change of the sources outlives.

numba's own checks only the file of the compiled function: where a function that it calls or a constant that it reads
changes in another file, the old machine code would go on running. Here a digest of all sources of compiled code is part
of the names of the cache's files. The rest is left to numba: `NUMBA_CACHE_DIR` or `__pycache__` or the user's cache
folder, and one entry for each CPU, signature, version of Python and of numba. Arrays that are strided or read-only have
signatures of their own: where callers give either, `fixed` leaves one to compile.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, TypeVar

import numba
import numpy as np
from numba.core.caching import CompileResultCacheImpl, FunctionCache
from numpy.typing import NDArray

__all__ = ["fixed", "njit"]

Function = TypeVar("Function", bound=Callable[..., Any])
_ROOT = Path(__file__).parent.parent


def njit(*, cache: bool, **options: Any) -> Callable[[Function], Function]:
    """`numba.njit` of code that releases Python's global lock, for threads to run side by side.

    With `cache`, machine code is kept on disk until a source of compiled code changes.
    """

    def compiled(function: Function) -> Function:
        dispatcher = numba.njit(nogil=True, **options)(function)
        if cache:  # as numba's `enable_caching`, which knows no other cache than its own
            dispatcher._cache = _Cache(function)  # type: ignore[no-untyped-call]
        return dispatcher

    return compiled


def fixed(array: NDArray[Any]) -> NDArray[Any]:
    """The array as compiled code reads it: contiguous and read-only; a copy only where it is strided."""
    view = np.ascontiguousarray(array).view()
    view.flags.writeable = False
    return view


def sources() -> list[Path]:
    """Files that compiled code comes from: those with compiled functions, and those with the constants they read."""
    files = sorted(file for package in ("analytic", "harness") for file in (_ROOT / package).rglob("*.py"))
    return [file for file in files if file.parent == _ROOT / "analytic" or b"njit" in file.read_bytes()]


@cache
def _digest() -> str:
    return hashlib.sha256(b"".join(file.read_bytes() for file in sources())).hexdigest()[:16]


class _CacheFiles(CompileResultCacheImpl):
    def get_filename_base(self, fullname: str, abiflags: str) -> str:
        return f"{super().get_filename_base(fullname, abiflags)}-{_digest()}"  # type: ignore[no-untyped-call]


class _Cache(FunctionCache):
    _impl_class = _CacheFiles
