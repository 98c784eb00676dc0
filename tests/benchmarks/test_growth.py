"""Growth of the time of a diagnosis: cases of growing size, and what the page says of measured times."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

from benchmarks.growth.cases import Size, write_sizes
from benchmarks.growth.measure import Time, run
from benchmarks.growth.page import page, summary
from benchmarks.growth.rows import Row, Rows
from harness.recording import load_case

SOURCE = "0123456789ab"


def rows_of(what: str, exponent: float) -> list[Row]:
    """Times that grow with this power of the size, from 5 s."""
    sizes = 2.0 ** np.arange(1, 5)
    return [Row(what, size, 0, 5.0 * (size / 2.0) ** exponent, 4.0 * size, SOURCE) for size in sizes.tolist()]


@pytest.mark.slow
def test_a_smaller_case_is_the_beginning_of_a_larger_one(tmp_path: Path) -> None:
    """List as many recordings as asked for, each as long as asked for, those of the larger case among them."""
    sizes = [Size(2, 16.0), Size(3, 16.0), Size(1, 6.0), Size(1, 9.0)]
    cases = {size: load_case(path) for size, path in write_sizes(tmp_path, sizes).items()}
    for size, case in cases.items():
        assert len(case.identify) == size.recordings
        for name in case.identify:
            time = case.recordings[name].time
            assert time[-1] - time[0] == pytest.approx(size.length, abs=0.011)  # a reading every 10 ms
    (few, many), (short, long) = ([cases[size] for size in pair] for pair in (sizes[:2], sizes[2:]))
    assert many.identify[:2] == few.identify
    (name,) = long.identify
    count = len(short.recordings[name].time)
    np.testing.assert_array_equal(short.recordings[name].position, long.recordings[name].position[:count])


def test_time_is_that_of_all_processes_of_a_command() -> None:
    """Count the processor time of a child of the command as well."""
    busy = "import time\nwhile time.process_time() < 0.5: pass"
    parent = f"import subprocess, sys; subprocess.run([sys.executable, '-c', {busy!r}], check=True)"
    taken = run([sys.executable, "-c", parent])
    assert taken.cpu >= 0.5
    with pytest.raises(RuntimeError, match="ended with 7"):
        run([sys.executable, "-c", "raise SystemExit(7)"])


def test_a_measurement_is_made_once(tmp_path: Path) -> None:
    """Take what a file has of the same sources and measure again what it has of others."""
    path = tmp_path / "times.jsonl"
    for cpu in (3.0, 4.0):
        assert Rows(path, SOURCE).measured("length", 16.0, 0, lambda cpu=cpu: Time(cpu, 1.0)).cpu == 3.0
    assert Rows(path, "another").measured("length", 16.0, 0, lambda: Time(5.0, 1.0)).cpu == 5.0


@pytest.mark.parametrize("exponent", [1.0, 1.4])
def test_the_page_gives_multiples_and_the_exponent(exponent: float) -> None:
    """Find the exponent with which times were made, and multiples of the smallest size."""
    told = summary([*rows_of("recordings", exponent), *rows_of("length", 1.0)], SOURCE)
    assert told["recordings"]["exponent"] == pytest.approx(exponent, rel=1e-12)
    assert told["recordings"]["exponent_of_largest"] == pytest.approx(exponent, rel=1e-12)
    assert told["recordings"]["wall"] == [1.0, 2.0, 4.0, 8.0]
    text = page(told, "")
    assert f"Exponent of the processor time: {exponent:.2f};" in text
    assert f"| 16 | {8.0**exponent:.2f} × | 8.00 × |" in text
    assert "sysid" not in text


def test_the_ratio_to_another_fit_is_that_of_pairs() -> None:
    """Divide times that were measured one after the other, and take the median."""
    ours = [Row("diagnose", 0.0, number, cpu, 1.0, SOURCE) for number, cpu in enumerate((10.0, 30.0, 90.0))]
    theirs = [Row("sysid", 0.0, number, cpu, 1.0, SOURCE) for number, cpu in enumerate((10.0, 10.0, 10.0))]
    told = summary([*ours, *theirs], SOURCE)
    assert told["sysid"] == {"pairs": 3, "cpu_ratio": 3.0}
    assert "On the case `viscous`, `harness diagnose` took 3.0 times" in page(told, "viscous")
