"""Where HARNESS_REQUIRE_ALL=1 stands in the environment, no test is skipped unnoticed."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.required import OPTIONAL, VARIABLE

ROOT = Path(__file__).resolve().parents[1]
TESTS = f'''
import pytest

@pytest.fixture
def browser():
    pytest.skip("chromium is not installed")

def test_that_runs(): pass
def test_that_needs_a_browser(browser): pass
def test_that_imports(): pytest.importorskip("no_such_package")
@pytest.mark.skipif(True, reason="the folder ../shared is absent")
def test_of_shared_data(): pass
@pytest.mark.skipif(True, reason="{next(iter(OPTIONAL))}")
def test_of_what_may_be_absent(): pass
@pytest.mark.xfail
def test_that_is_expected_to_fail(): assert False
'''


def summary(folder: Path, value: str | None) -> list[str]:
    """Lines of pytest's short summary for two modules with tests that skip."""
    (folder / "test_made.py").write_text(TESTS)
    (folder / "test_module.py").write_text("import pytest\npytest.importorskip('no_such_package')\n")
    environment = {key: one for key, one in os.environ.items() if key != VARIABLE} | {"PYTHONPATH": str(ROOT)}
    if value is not None:
        environment[VARIABLE] = value
    options = ["-p", "tests.required", "-p", "no:cacheprovider", "--continue-on-collection-errors", "-ra", "-q"]
    command = [sys.executable, "-m", "pytest", *options, str(folder)]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, env=environment)
    assert done.returncode in (0, 1), done.stderr
    return done.stdout.splitlines()


@pytest.mark.slow
def test_every_skip_fails_by_name_except_those_listed(tmp_path: Path) -> None:
    """Say of each test and module that did not run what it lacks, and fail for it."""
    lines = summary(tmp_path, "1")
    failed = [line for line in lines if line.startswith(("FAILED ", "ERROR "))]
    for name in ("test_that_needs_a_browser", "test_that_imports", "test_of_shared_data", "test_module.py"):
        assert any(name in line for line in failed), name
    assert len(failed) == 4
    assert any("chromium is not installed" in line for line in lines)
    assert sum(line.startswith("SKIPPED") for line in lines) == 1


@pytest.mark.slow
@pytest.mark.parametrize("value", [None, "0"])
def test_on_other_machines_they_are_skipped(tmp_path: Path, value: str | None) -> None:
    """Skip and say why, as long as nobody asks for everything."""
    lines = summary(tmp_path, value)
    assert not [line for line in lines if line.startswith(("FAILED ", "ERROR "))]
    assert sum(line.startswith("SKIPPED") for line in lines) == 5


def test_ci_asks_for_everything() -> None:
    """Set the variable before the first stage of .ci/run."""
    script = (ROOT / ".ci" / "run").read_text(encoding="utf-8")
    assert script.index(f"export {VARIABLE}=${{{VARIABLE}-1}}") < script.index("stage make")
