"""What all tests share; prints the table of validated accuracy when tests that establish it have run."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

from tests.posed import Posed, pose
from tests.required import pytest_make_collect_report, pytest_runtest_makereport
from tests.shared_data import SHARED

__all__ = ["pytest_make_collect_report", "pytest_runtest_makereport"]  # hooks, which pytest finds here by name

Establish = Callable[..., None]
_KEY = "accuracy"

# How long an example takes says how busy a machine is, and nothing of what is tested.
settings.register_profile("busy", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("busy")


@pytest.fixture(scope="session")
def shared() -> Path:
    """The folder ../shared with cases and recordings; tests that need it are skipped without."""
    if not SHARED.is_dir():
        pytest.skip("the folder ../shared is absent")
    return SHARED


@pytest.fixture
def establish(record_property: Callable[[str, object], None]) -> Establish:
    """Record one line of the table and hold the measured figure to its tolerance."""

    def one(quantity: str, reference: str, *, tolerance: float, measured: float, unit: str) -> None:
        record_property(_KEY, [quantity, reference, f"{tolerance:g} {unit}", f"{measured:.2g} {unit}"])
        assert measured <= tolerance, f"{quantity} against {reference}: {measured:.3g} {unit}, allowed {tolerance:g}"

    return one


@pytest.fixture(scope="session")
def plain(tmp_path_factory: pytest.TempPathFactory) -> Posed:
    """Nothing is hidden; a third recording is to be predicted."""
    return pose(tmp_path_factory.mktemp("plain") / "case", 0, predict=1)


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """One Markdown row a line, ready for the README."""
    reports = [*terminalreporter.stats.get("passed", []), *terminalreporter.stats.get("failed", [])]
    rows = [value for report in reports for key, value in report.user_properties if key == _KEY]
    if rows:
        terminalreporter.section("validated accuracy")
        terminalreporter.line("| quantity | reference | tolerance | measured |")
        terminalreporter.line("|---|---|---|---|")
        for row in rows:
            terminalreporter.line("| " + " | ".join(row) + " |")
