"""The memory of a command and of what it starts, and what the page says of it."""

from __future__ import annotations

import sys

import pytest

from benchmarks.growth.memory import SHAPES, Peak, Told, peak_of, section

_HELD = 200_000_000  # bytes; Python itself takes some 10 MB
_HOLD = f"import time; held = b'x' * {_HELD}; time.sleep(0.5)"


def test_the_memory_of_a_process_is_its_peak() -> None:
    """Count what a process held for a while, and little else."""
    peak = peak_of([sys.executable, "-c", f"held = b'x' * {_HELD}; del held"])
    assert _HELD < peak.largest < 1.2 * _HELD
    assert peak.together >= peak.largest


def test_processes_that_it_starts_count_together() -> None:
    """Add what two processes hold at the same time."""
    start = f"import subprocess, sys; subprocess.run([sys.executable, '-c', {_HOLD!r}], check=True)"
    peak = peak_of([sys.executable, "-c", f"held = b'x' * {_HELD}; {start}"])
    assert _HELD < peak.largest < 1.2 * _HELD
    assert 2 * _HELD < peak.together < 2.4 * _HELD


def test_a_command_that_fails_is_told() -> None:
    """Raise with its last words where a command comes to no result."""
    with pytest.raises(RuntimeError, match=r"ended with 1: .*no such thing"):
        peak_of([sys.executable, "-c", "raise SystemExit('no such thing')"])


def test_the_page_sets_the_estimate_beside_the_peak() -> None:
    """Write both in MB, tell what was not run, and notice a command that took more than it said."""
    told = Told("run", SHAPES[0], 1600, 7e8, Peak(500_000_000, 600_000_000))
    text = section([told, Told("run", SHAPES[3], 64_000, 2.8e10, None)])
    assert "| `run` | 2 × 16 s at 100 Hz | 1600 | 500 | 600 | 700 |" in text
    assert "| `run` | 1 × 640 s at 100 Hz | 64000 | not run | not run | 28000 |" in text
    assert not told.exceeded
    assert Told("run", SHAPES[0], 1600, 5e8, told.peak).exceeded
