"""docs/api.md says what the docstrings say."""

from __future__ import annotations

import runpy
from pathlib import Path

import pytest

DOCS = Path(__file__).resolve().parents[2] / "docs"


def test_the_reference_is_up_to_date() -> None:
    """Have the page that `make docs` writes."""
    pytest.importorskip("griffe2md")
    assert (DOCS / "api.md").read_text(encoding="utf-8") == runpy.run_path(str(DOCS / "make_api.py"))["text"]()
