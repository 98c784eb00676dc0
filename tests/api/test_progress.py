"""Progress: a bar on a terminal that is gone in the end, a line a step elsewhere, nothing unless asked for."""

from __future__ import annotations

import io

import pytest
from rich.console import Console

from harness.api.progress import _bar, shown
from harness.errors import InputError
from harness.progress import Stage

WIDTH = 90


def watched(monkeypatch: pytest.MonkeyPatch, *, terminal: bool) -> io.StringIO:
    """Where progress goes instead of stderr."""
    out = io.StringIO()
    console = Console(file=out, force_terminal=terminal, width=WIDTH, color_system=None)
    monkeypatch.setattr("rich.console.Console", lambda stderr: console)
    return out


def test_a_log_gets_a_whole_line_a_step(monkeypatch: pytest.MonkeyPatch) -> None:
    """Write plain lines, however long."""
    out = watched(monkeypatch, terminal=False)
    with shown(True) as tell:
        tell("drives", share=0.5)
        tell("x" * 2 * WIDTH)
    assert [line.partition("] ")[2] for line in out.getvalue().splitlines()] == ["drives", "x" * 2 * WIDTH]
    assert "\r" not in out.getvalue()


def test_a_terminal_shows_step_and_share(monkeypatch: pytest.MonkeyPatch) -> None:
    """Draw one bar with the step and the share that is done, which never falls."""
    out = watched(monkeypatch, terminal=True)
    with shown(True) as tell:
        for text, share in (("first", 0.25), ("second", 0.5), ("third", 0.4)):
            tell(text, share=share)
            last = out.getvalue().split("\r")[-1]
            assert text in last
            assert f"{max(share, 0.5 if text == 'third' else 0.0):.0%}" in last


def test_an_error_leaves_no_bar_behind(monkeypatch: pytest.MonkeyPatch) -> None:
    """Erase the bar where the work ends by an error, before anything is said of it."""
    out = watched(monkeypatch, terminal=True)

    def fail() -> None:
        with shown(True) as tell:
            tell("half done")
            raise InputError("bad")

    with pytest.raises(InputError):
        fail()
    assert out.getvalue().endswith("\x1b[2K")  # ECMA-48: erase the line


def test_nothing_is_shown_unless_asked_for(capfd: pytest.CaptureFixture[str]) -> None:
    """Leave stdout and stderr alone, and pass on what is told to a function of the caller's."""
    told: list[tuple[str, float | None]] = []

    def tell_me(text: str, *, share: float | None = None) -> None:
        told.append((text, share))

    with shown(False) as tell:
        tell("unheard")
    with shown(tell_me) as tell:
        tell("heard", share=0.5)
    assert told == [("heard", 0.5)]
    assert capfd.readouterr() == ("", "")


def test_a_stage_is_a_part_of_the_whole() -> None:
    """Map a stage's own shares onto its part, and grow towards its end where only steps are told."""
    shares: list[float] = []

    def tell(text: str, *, share: float | None = None) -> None:
        assert share is not None
        shares.append(share)

    stage = Stage(tell, 0.2, 0.6, 10.0)
    stage("half", share=0.5)
    assert shares == [pytest.approx(0.4)]
    for _ in range(100):
        stage("step")
    assert shares[1] == pytest.approx(0.2)
    assert shares[1:] == sorted(shares[1:])
    assert 0.59 < shares[-1] < 0.6


def test_the_time_left_is_told_in_long_steps() -> None:
    """Tell it from the mean speed so far, also when nothing was done for minutes."""
    clock = [0.0]
    bar = _bar(Console(file=io.StringIO(), force_terminal=True))
    bar.get_time = lambda: clock[-1]
    task = bar.add_task("work", total=1.0)
    for seconds, share in ((0.0, 0.1), (60.0, 0.2), (300.0, 0.2)):
        clock.append(seconds)
        bar.update(task, completed=share)
    # 0.1 of it took 60 s, and 0.8 is left.
    assert bar.tasks[task].time_remaining == pytest.approx(480.0, abs=1.0)
