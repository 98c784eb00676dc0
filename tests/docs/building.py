"""Builds the documentation site as `make docs` does."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

from tests.docs.pages import ROOT


def build(folder: Path, executed: Path, *, root: Path = ROOT) -> subprocess.CompletedProcess[str]:
    """What the build of a site ends with.

    Args:
        folder: of the site.
        executed: that of the executed notebooks.
        root: where mkdocs.yml is, and the folder of documents.
    """
    environment = os.environ | {"NO_MKDOCS_2_WARNING": "1", "EXECUTED_NOTEBOOKS": str(executed)}
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", str(folder)]
    return subprocess.run(command, cwd=root, capture_output=True, text=True, env=environment)


def built(folder: Path, executed: Path) -> Path:
    """The site; a broken link or anchor is an error."""
    done = build(folder, executed)
    assert done.returncode == 0, done.stderr
    return folder
