"""What produced a result: digests of the installed code and of the result, versions of the software under it."""

import ast
import hashlib
import json
from collections.abc import Iterable, Mapping
from importlib.metadata import version
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
PACKAGES = ("analytic", "harness", "mjcf", "urdf")
_NUMERICAL = ("ball-beam-harness", "numpy", "scipy", "numba")


SEAL = "sealed"
"""Key under which a result has the digest of its own content."""


def canonical(value: Any) -> str:
    """JSON content as one text: keys in order, no blanks, all digits of its numbers."""
    return json.dumps(value, sort_keys=True, ensure_ascii=False, separators=(",", ":"))


def seal_of(content: Mapping[str, Any]) -> str:
    """SHA-256 of JSON content without its seal, in canonical form."""
    rest = {key: value for key, value in content.items() if key != SEAL}
    return hashlib.sha256(canonical(rest).encode("utf-8", "surrogatepass")).hexdigest()


def versions() -> dict[str, str]:
    """Versions of the software that decides the numbers; this product also by the digest of its `code`."""
    return {**{name: version(name) for name in _NUMERICAL}, "code": code_digest()}


def code_digest(root: Path = ROOT, packages: Iterable[str] = PACKAGES) -> str:
    """Twelve hexadecimal digits of a SHA-256 over every module of these packages, by default of the product.

    It changes with the code, and not with comments, docstrings or layout.
    """
    total = hashlib.sha256()
    for package in packages:
        for path in sorted((root / package).rglob("*.py")):
            total.update(f"{path.relative_to(root).as_posix()}\n{_code(path)}\n".encode())
    return total.hexdigest()[:12]


def _code(path: Path) -> str:
    """The module's syntax tree as text, without docstrings."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    for node in ast.walk(tree):
        body = getattr(node, "body", None)
        if isinstance(body, list):
            node.body = [one for one in body if not _is_text(one)]  # type: ignore[attr-defined]
    return ast.dump(tree)


def _is_text(node: ast.AST) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)
