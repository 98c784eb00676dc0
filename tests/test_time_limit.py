"""A limit on time ends what does not end, in any thread, and leaves nothing behind."""

from __future__ import annotations

import signal
import threading
import time

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
