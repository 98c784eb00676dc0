"""Failures of single parts: what raises costs its own part and not the whole, and is shown with its exception text.

One mechanism for engines, candidates, steps of the search, validation and report: whoever calls a part that the result
can do without calls it through `attempt`. Without a collector nothing is caught, so that tests and blind trials see
every exception.
"""

from __future__ import annotations

import traceback
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import TypeVar

from harness.errors import INTERRUPTS, EngineFailure, HarnessError

T = TypeVar("T")
U = TypeVar("U")


class Part(StrEnum):
    """Kinds of parts that may fail; names as in diagnosis.json."""

    ENGINE = "engine"
    CANDIDATE = "candidate"
    SEARCH = "search"
    VALIDATION = "validation"
    BASELINES = "baselines"
    NEXT_EXPERIMENT = "next_experiment"
    PREDICTION = "prediction"
    REPORT = "report"


@dataclass(frozen=True)
class Failed:
    """A part that failed.

    Attributes:
        part: what kind of part.
        name: which one.
        message: text of the exception, with its type unless it is meant for the user.
        where: file, line and function that raised it; empty if it is meant for the user.
        of_the_rig: whether no part is to blame, as for a ball that lifts off in every model.
    """

    part: Part
    name: str
    message: str
    where: str = ""
    of_the_rig: bool = False

    def __str__(self) -> str:
        return described(self.part.value, self.name, self.message, self.where)


def described(part: str, name: str, message: str, where: str) -> str:
    """A failure in words; arguments as the attributes of `Failed`."""
    title = " ".join([part.replace("_", " "), *([name] if name else [])])
    engine = name.partition(" ")[0]
    if engine and message.startswith(f"{engine} failed "):  # of an `EngineFailure`, which names the engine itself
        message = message.removeprefix(f"{engine} ")
    else:
        message = f"failed: {message}"
    return f"{title} {message}" + (f" ({where})" if where else "")


class Failures:
    """Collects failures, possibly from several threads; one that occurs again is listed once."""

    def __init__(self, known: Iterable[Failed] = ()) -> None:
        self._all = list(known)

    def add(self, failed: Failed) -> None:
        """Append one."""
        self._all.append(failed)

    @property
    def all(self) -> tuple[Failed, ...]:
        """In the order of occurrence."""
        return tuple(dict.fromkeys(self._all))


def caught(part: Part, name: str, job: Callable[[], T]) -> T | Failed:
    """The result of `job`, or its failure, which can be pickled.

    Raises:
        KeyboardInterrupt, Terminated: a signal came, even if the part made another exception of it.
    """
    try:
        return job()
    except Exception as error:
        _let_signals_pass(error)
        if isinstance(error, EngineFailure) and error.__cause__ is not None:  # an exception of the engine's package
            return Failed(part, name, str(error), _place(error.__cause__))
        if isinstance(error, HarnessError):
            return Failed(part, name, str(error), of_the_rig=isinstance(error, EngineFailure) and error.of_the_rig)
        text = f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
        return Failed(part, name, text, _place(error))


def _let_signals_pass(error: BaseException) -> None:
    """Raise the signal of which `error` was made: compiled code that it interrupts raises a `SystemError` from it."""
    behind: BaseException | None = error
    while behind is not None:
        if isinstance(behind, INTERRUPTS):
            raise behind
        behind = behind.__cause__ or behind.__context__


def _place(error: BaseException) -> str:
    """File, line and function that raised."""
    last = traceback.extract_tb(error.__traceback__)[-1]
    return f"{Path(last.filename).name}, line {last.lineno}, in {last.name}"


def attempt(failures: Failures | None, part: Part, name: str, job: Callable[[], T], otherwise: U) -> T | U:
    """The result of `job`; if it raises, `otherwise`, and `failures` gets the failure.

    Args:
        failures: the collector; `None` lets exceptions pass.
    """
    if failures is None:
        return job()
    result = caught(part, name, job)
    if isinstance(result, Failed):
        failures.add(result)
        return otherwise
    return result
