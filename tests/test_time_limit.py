"""A limit on time ends what does not end, in any thread, and leaves nothing behind."""

from __future__ import annotations

import signal
import sys
import threading
import time
from types import FrameType

import pytest

from harness.time_limit import TimeLimit, time_limit

SHORT = 0.2


def endless() -> None:
    """Run for ever, whatever is raised in between."""
    while True:
        try:
            sum(range(100))
        except Exception:
            continue


def test_what_does_not_end_is_ended() -> None:
    """Raise in Python code that handles every `Exception`."""
    with pytest.raises(TimeLimit, match=r"more than 0\.2 s"), time_limit(SHORT):
        endless()


def test_waiting_is_ended() -> None:
    """Raise in the main thread where nothing is computed."""
    with pytest.raises(TimeLimit), time_limit(SHORT):
        time.sleep(60.0)


def test_other_threads_have_a_limit_too() -> None:
    """Raise where no signal comes."""
    raised: list[TimeLimit] = []

    def run() -> None:
        try:
            with time_limit(SHORT):
                endless()
        except TimeLimit as error:
            raised.append(error)

    thread = threading.Thread(target=run, daemon=True)
    thread.start()
    thread.join(60.0)
    assert [one.seconds for one in raised] == [SHORT]


def test_the_limit_around_a_limit_holds_on() -> None:
    """End at the outer limit within a longer inner one."""
    with pytest.raises(TimeLimit, match=r"more than 0\.2 s"), time_limit(SHORT), time_limit(60.0):
        endless()


def test_a_limit_that_was_kept_does_not_end_the_one_around_it() -> None:
    """End at the outer limit after an inner one."""

    def kept_then_endless() -> None:
        with time_limit(0.1):
            pass
        endless()

    with pytest.raises(TimeLimit, match=r"more than 0\.2 s"), time_limit(SHORT):
        kept_then_endless()


def test_nothing_is_left_behind() -> None:
    """Leave no timer and no handler."""
    before = signal.getsignal(signal.SIGALRM)
    with pytest.raises(TimeLimit), time_limit(SHORT):
        endless()
    assert signal.getsignal(signal.SIGALRM) == before
    assert signal.getitimer(signal.ITIMER_REAL) == (0.0, 0.0)


def slow_to_leave(frame: FrameType, event: str, _: object) -> None:
    """As on a busy machine: it takes longer to leave a context than from one exception to the next."""
    if event == "c_call" and frame.f_code.co_name == "__exit__":
        time.sleep(0.3)


def test_nothing_goes_on_where_leaving_takes_long() -> None:
    """Leave no timer where the exception needs time to get out of the context."""
    sys.setprofile(slow_to_leave)
    try:
        with pytest.raises(TimeLimit) as raised, time_limit(SHORT):
            endless()
    finally:
        sys.setprofile(None)
    assert signal.getitimer(signal.ITIMER_REAL) == (0.0, 0.0)
    assert raised.value.seconds == SHORT  # who keeps the exception keeps the frames that it went through


def test_no_thread_goes_on_where_leaving_takes_long() -> None:
    """Raise once in another thread, too, and never again after its context."""
    raised: list[BaseException] = []

    def run() -> None:
        sys.setprofile(slow_to_leave)
        try:
            with time_limit(SHORT):
                endless()
        except TimeLimit as error:
            raised.append(error)
        try:
            end = time.monotonic() + 0.5
            while time.monotonic() < end:
                sum(range(100))
        except TimeLimit as error:
            raised.append(error)

    thread = threading.Thread(target=run, daemon=True)
    thread.start()
    thread.join(60.0)
    assert len(raised) == 1
