"""Arrays without their reference counts, for the loops of compiled code.

numba counts the references to an array wherever it is passed on or a part of it is taken, with an atomic operation
each; in the step of a ball, which passes the parameters on from law to law, that took half of the time. Whoever calls a
compiled function holds its arguments until it returns, so that nothing has to be counted within.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from numba.core import cgutils, types
from numba.extending import lower_builtin, type_callable

Arrays = TypeVar("Arrays")


def borrowed(arrays: Arrays) -> Arrays:
    """The array, or a tuple with arrays, whose references compiled code does not count from here on.

    For arguments of the function: what is borrowed, or taken from it, is valid as long as its owner is, and may be
    neither returned nor kept. In Python nothing changes.
    """
    return arrays


@type_callable(borrowed)
def _same_type(context: Any) -> Callable[[types.Type], types.Type]:
    return lambda arrays: arrays


@lower_builtin(borrowed, types.Any)  # type: ignore[no-untyped-call, untyped-decorator]
def _without_owners(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    return _nameless(context, builder, signature.args[0], arguments[0])


def _nameless(context: Any, builder: Any, kind: Any, value: Any) -> Any:
    """The value, in LLVM's terms, of an array or of a tuple with arrays, that names no owner."""
    if isinstance(kind, types.Array):
        view = context.make_array(kind)(context, builder, value=value)
        view.meminfo = cgutils.get_null_value(view.meminfo.type)  # type: ignore[no-untyped-call]
        view.parent = cgutils.get_null_value(view.parent.type)  # type: ignore[no-untyped-call]
        return view._getvalue()
    if isinstance(kind, types.BaseTuple):
        kinds: Any = kind  # numba's annotations do not tell that it iterates
        for i, each in enumerate(kinds):
            part = _nameless(context, builder, each, builder.extract_value(value, i))
            value = builder.insert_value(value, part, i)
    return value
