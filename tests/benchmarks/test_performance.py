"""Times side by side: what is compared does the same work, and page, JSON and README say the same."""

from __future__ import annotations

import json
import shutil
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from benchmarks.growth.measure import Time
from benchmarks.performance import engines, in_c
from benchmarks.performance.commands import parts_of
from benchmarks.performance.page import SECTION, Line, in_readme, page, summary, table
from benchmarks.performance.pairs import Pair, pairs_of, spread
from benchmarks.performance.sampled import sampled, shares
from benchmarks.sections import marks
from harness.engines.catalogue import engine_of, parameters_of

ROOT = Path(__file__).resolve().parents[2]
needs_gcc = pytest.mark.skipif(shutil.which("gcc") is None, reason="gcc is not installed")
TOLD = ROOT / "docs" / "performance.json"


def test_both_are_timed_in_turn() -> None:
    """Time both as often, the first one alternating, and one call of each before that does not count."""
    calls: list[str] = []
    clock = iter(range(1000))
    made = pairs_of(lambda: calls.append("a"), lambda: calls.append("b"), 4, lambda: float(next(clock)))
    assert made == [Pair(1.0, 1.0)] * 4
    assert calls == ["a", "b", *"baabbaab"]


def test_each_time_is_kept_for_its_own_work() -> None:
    """Give what takes three times as long three times the time, whichever comes first."""
    now = 0.0

    def work(seconds: float) -> None:
        nonlocal now
        now += seconds

    made = pairs_of(lambda: work(3.0), lambda: work(1.0), 5, lambda: now)
    assert [one.ratio for one in made] == [3.0] * 5


def test_samples_are_of_threads_that_work() -> None:
    """Count the function that works, in whatever thread, and not the one that waits for it."""

    def busy() -> float:
        end, total = time.thread_time() + 0.3, 0.0
        while time.thread_time() < end:
            total += 1.0
        return total

    def waiting() -> float:
        with ThreadPoolExecutor(2) as pool:
            return pool.submit(busy).result()

    taken = sampled(waiting)
    assert max(taken, key=taken.__getitem__) == "test_performance.busy"
    # Of 0.3 s; the first look only begins to count, and so does the last one not see the end.
    assert 0.2 < taken["test_performance.busy"] < 0.32


def test_shares_are_of_all_processes() -> None:
    """Tell functions of the process itself beside all that the processes took which it forked."""
    text = shares({"imports": 1.0, "ekf.run": 3.0}, 6.0, 2.0)
    assert text == "25 % in processes of engines and pictures, 38 % in `ekf.run`, 12 % in `imports`"


def test_spread_is_median_and_quartiles() -> None:
    """Take the medians of the halves, with the middle value in both where the number is odd."""
    found = spread([5.0, 1.0, 4.0, 2.0, 3.0])
    assert (found.low, found.median, found.high) == (2.0, 3.0, 4.0)


@needs_gcc
@pytest.mark.parametrize("resistance", [0.0, 0.016])
def test_c_does_the_work_of_the_kernel(tmp_path: Path, resistance: float) -> None:
    """Find the same positions and velocities at every stamp, and balls at rest only where there is a resistance."""
    at_rest = in_c.Work(tmp_path, resistance).check()  # raises where they differ
    assert (at_rest > 0) == (resistance > 0.0)


def test_bare_loops_roll_as_the_engines_do() -> None:
    """Find the engine's ball in each bare loop: MuJoCo's bit for bit, PyBullet's but for the velocity of the chord."""
    seconds, stamps = 2.0, np.arange(0.0, 2.0, 0.01)

    def positions(name: str) -> np.ndarray:
        engine = engine_of(name)
        settings = parameters_of(engine, {"time_step": 1e-3})
        run = engine.run(engines.Rig(), engines.Swing(), engines._START, stamps, parameters=settings)
        return run.trajectory.position

    def along(centres: np.ndarray) -> np.ndarray:
        angle = engines.Swing().evaluate(1e-3 * np.arange(1, len(centres) + 1))
        return (centres[:, 0] * np.cos(angle) - centres[:, 2] * np.sin(angle))[9::10]  # at 10 ms, 20 ms …

    ours, loop = positions("mujoco"), along(engines.mujoco_loop(seconds))
    # Both are the same numbers; interpolation at a node rounds.
    np.testing.assert_allclose(loop[: len(ours) - 1], ours[1:], rtol=0.0, atol=1e-13)
    states = engines.mujoco_rollout(seconds)
    np.testing.assert_array_equal(along(states[:, 2:5]), loop)
    # The chord: a slip of ½ s α̇² dt at most, 0.36 m × (0.017 rad/s)² × 0.5 ms, for two seconds.
    bare = along(engines.pybullet_loop(seconds))
    np.testing.assert_allclose(bare[: len(ours) - 1], positions("pybullet")[1:], rtol=0.0, atol=1.1e-7)


def test_parts_of_a_diagnosis_are_told_from_its_progress() -> None:
    """Give each part the time from its line to the next, and the rest to what no line is about."""
    lines = ["[  1.0 s] drives and rig", "[  2.0 s] fit: none", "[  4.0 s] baselines: at rest", "[  9.0 s] report"]
    told = parts_of([Time(10.0, 10.0, "\n".join(lines))])
    assert told == "baselines 50 %, search 20 %, start and reading 10 %, imports and report 10 %"


LINES = [
    Line.times("ours over theirs", 1.1, [Pair(1.0, 1.0), Pair(1.2, 1.0), Pair(2.0, 1.0)], "What was run.", "Why."),
    Line.speed("speed of ours", 0.8, [Pair(1.0, 2.0)] * 3, "What else was run.", "Because."),
]


def test_the_page_says_whether_a_bound_is_reached() -> None:
    """Compare the median with the bound, upwards for a speed, and give a reason only where it is missed."""
    told = summary(LINES, ["a line: no compiler"], "0123456789ab")
    assert [line["reached"] for line in told["lines"]] == [False, True]
    text = page(told)
    assert "| ours over theirs | ≤ 1.1 | 1.20 (1.10 … 1.60) | missed |" in text
    assert "| speed of ours | ≥ 0.8 | 2.00 (2.00 … 2.00) | reached |" in text
    assert "What was run. Why." in text
    assert "Because." not in text
    assert "Not measured: a line: no compiler" in text


def test_the_readme_keeps_what_is_around_the_section() -> None:
    """Replace the section and nothing else."""
    begin, end = marks(SECTION)
    readme = f"# Title\n\nabove\n\n{begin}\nold\n{end}\n\n## Below\n"
    once = in_readme(summary(LINES, [], "0"), readme)
    assert once.startswith("# Title\n\nabove\n\n" + begin)
    assert once.endswith(end + "\n\n## Below\n")
    assert "old" not in once
    assert in_readme(summary(LINES, [], "0"), once) == once


def test_page_and_readme_are_those_of_the_json() -> None:
    """Find in docs and README what the committed JSON says."""
    told = json.loads(TOLD.read_text(encoding="utf-8"))
    assert (ROOT / "docs" / "performance.md").read_text(encoding="utf-8") == page(told)
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    assert in_readme(told, readme) == readme
    assert table(told) in readme
    for line in told["lines"]:
        found = spread(line["values"])
        assert len(line["values"]) >= 7
        assert (line["median"], line["low"], line["high"]) == (found.median, found.low, found.high)
        assert line["reached"] == ((found.median <= line["asked"]) == line["at_most"] or found.median == line["asked"])
