"""What raises is kept as a failure with its text where a collector is given, and raises where none is."""

from __future__ import annotations

import pickle

import pytest

from harness.errors import EngineFailure, InputError, Terminated
from harness.failures import Failed, Failures, Part, attempt, caught


def broken() -> int:
    """Divide by zero."""
    return 1 // 0


def test_a_failure_has_type_text_and_place() -> None:
    """Say what was raised and where, since it may be a fault of the program."""
    failed = caught(Part.SEARCH, "swaps", broken)
    assert isinstance(failed, Failed)
    assert failed.message.startswith("ZeroDivisionError: ")
    assert failed.where.startswith("test_failures.py, line ")
    assert failed.where.endswith(", in broken")
    assert str(failed) == f"search swaps failed: {failed.message} ({failed.where})"
    assert pickle.loads(pickle.dumps(failed)) == failed


def test_a_message_for_the_user_stands_alone() -> None:
    """Leave out type and place of an error that names its remedy."""

    def refuse() -> None:
        raise InputError("the rig cannot be built; widen the gap")

    assert str(caught(Part.ENGINE, "mujoco", refuse)) == (
        "engine mujoco failed: the rig cannot be built; widen the gap"
    )


def test_an_engine_that_fails_is_named_once() -> None:
    """Say engine, recording, instant and cause in one sentence."""

    def run() -> None:
        raise EngineFailure("mujoco", None, 9.891, "the ball lifts off the beam")

    assert str(caught(Part.ENGINE, "mujoco on rec_01.csv", run)) == (
        "engine mujoco on rec_01.csv failed at t = 9.891 s: the ball lifts off the beam"
    )


@pytest.mark.parametrize("came", [KeyboardInterrupt, Terminated])
def test_a_signal_is_no_failure_of_a_part(came: type[BaseException]) -> None:
    """Raise what a signal raised, though the compiled code that it came upon made a `SystemError` of it."""

    def interrupted() -> None:
        try:
            raise came
        except came as signal:
            raise SystemError("returned a result with an exception set") from signal

    with pytest.raises(came):
        attempt(Failures(), Part.SEARCH, "swaps", interrupted, None)


def test_without_a_collector_exceptions_pass() -> None:
    """Raise where nobody would show the failure, and never swallow an interrupt."""
    with pytest.raises(ZeroDivisionError):
        attempt(None, Part.CANDIDATE, "level_error", broken, 0)

    def interrupt() -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        attempt(Failures(), Part.CANDIDATE, "level_error", interrupt, None)


def test_a_failure_is_listed_once() -> None:
    """Give what is left to do with, and collect equal failures once, in order."""
    failures = Failures([Failed(Part.REPORT, "page", "first")])
    for _ in range(2):
        assert attempt(failures, Part.CANDIDATE, "level_error", broken, 7) == 7
    assert attempt(failures, Part.CANDIDATE, "level_error", lambda: 8, 7) == 8
    assert [one.part for one in failures.all] == ["report", "candidate"]


def test_an_engine_failure_comes_back_from_another_process() -> None:
    """Keep what failed, when and how, through the pickle in which a worker process hands it over."""
    failure = EngineFailure("mujoco", "lost contact", 1.25, "1 contact with 0.3 N")
    back = pickle.loads(pickle.dumps(failure))
    assert (str(back), back.engine, back.failure, back.time) == (str(failure), "mujoco", "lost contact", 1.25)
