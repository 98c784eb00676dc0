"""Where everything has to be there, a test that is skipped fails: `.ci/run` sets HARNESS_REQUIRE_ALL=1.

Without the variable a test that lacks a tool or a folder is skipped and says why, so that the tests run on any machine.
"""

from __future__ import annotations

import os
from collections.abc import Generator

import pytest

VARIABLE = "HARNESS_REQUIRE_ALL"
# What may be absent all the same: the beginning of a skip's reason, and why.
OPTIONAL = {
    "gcc is not installed": "a benchmark's programs in C; set-up and .ci/run promise to need no compiler",
}


def failure(skip: object) -> str | None:
    """What a skip fails with; `None` where it may stand.

    Args:
        skip: `longrepr` of the report of a skipped test or module: file, line and reason.
    """
    if os.environ.get(VARIABLE, "0") in ("", "0"):
        return None
    file, line, told = skip if isinstance(skip, tuple) else ("", 0, str(skip))
    reason = str(told).removeprefix("Skipped: ")
    if reason.startswith(tuple(OPTIONAL)):
        return None
    return f"{file}:{line}: skipped, which {VARIABLE} forbids: {reason}"


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """Let a skipped test fail; one that is expected to fail is no skip."""
    report = yield
    if report.skipped and not hasattr(report, "wasxfail") and (why := failure(report.longrepr)):
        report.outcome, report.longrepr = "failed", why
    return report


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report() -> Generator[None, pytest.CollectReport, pytest.CollectReport]:
    """Let a module that is skipped as a whole fail."""
    report = yield
    if report.skipped and (why := failure(report.longrepr)):
        report.outcome, report.longrepr = "failed", why
    return report
