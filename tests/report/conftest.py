"""What the tests of pages in a browser share; each module has a fixture `page`, the file."""

from __future__ import annotations

import pytest

from tests.report import browser


@pytest.fixture(scope="module")
def chromium():
    """One browser for all tests of a module."""
    with browser.chromium() as one:
        yield one


@pytest.fixture
def driver(chromium, page):
    """The report, freshly opened at 1000 pixels, light; no script may complain."""
    yield browser.opened(chromium, page)
    assert browser.complaints(chromium) == []
