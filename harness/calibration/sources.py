"""A digest of the code that makes a row, so that a row is made anew when what made it has changed."""

from __future__ import annotations

import ast
import hashlib
from collections.abc import Iterable
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
# What makes the data, what reads it, and what searches; of harness/identify, not what comes after the search.
_MAKERS = (
    "analytic",
    "harness/compare",
    "harness/engines",
    "harness/identify",
    "harness/prescribed.py",
    "harness/recording",
    "harness/smoothing",
    "harness/virtual_rig",
    "harness/ball_state.py",
    "harness/drive.py",
    "harness/calibration/pose.py",
)
_AFTER = {
    "contest.py",
    "depends.py",
    "diagnosis.py",
    "experiment.py",
    "forecast.py",
    "in_engines.py",
    "independence.py",
    "keep.py",
    "ledger.py",
    "profiles.py",
    "proposal.py",
    "reconsider.py",
    "rehearsal.py",
    "replay.py",
    "sentence.py",
    "separation.py",
    "trace.py",
    "verify.py",
    "yardsticks.py",
}


def digest(root: Path = ROOT) -> str:
    """Twelve hexadecimal digits that change with the code, and not with comments, docstrings or layout."""
    total = hashlib.sha256()
    for path in _files(root):
        total.update(f"{path.relative_to(root).as_posix()}\n{_code(path)}\n".encode())
    return total.hexdigest()[:12]


def _files(root: Path) -> Iterable[Path]:
    for name in _MAKERS:
        place = root / name
        for path in [place] if place.is_file() else sorted(place.rglob("*.py")):
            if not (name == "harness/identify" and path.name in _AFTER):
                yield path


def _code(path: Path) -> str:
    tree = ast.parse(path.read_text(encoding="utf-8"))
    for node in ast.walk(tree):
        body = getattr(node, "body", None)
        if isinstance(body, list):
            node.body = [one for one in body if not _is_text(one)]  # type: ignore[attr-defined]
    return ast.dump(tree)


def _is_text(node: ast.AST) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)
