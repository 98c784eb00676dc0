"""What produced a result: digests of the installed code and of the result, versions of the software under it."""

import ast
import hashlib
import json
import sys
from collections.abc import Iterable, Mapping
from contextlib import suppress
from importlib.metadata import version
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
PACKAGES = ("analytic", "harness", "mjcf", "urdf")
_NUMERICAL = ("ball-beam-harness", "numpy", "scipy", "numba")
_DIGITS = 12  # of the digest of the code

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

    It changes with the code, and not with comments, docstrings or layout. Reading all syntax trees takes a second: the
    digest is kept in `__pycache__`, beside what it was made of, where that folder can be written.
    """
    modules = [path for package in packages for path in sorted((root / package).rglob("*.py"))]
    named = [(path.relative_to(root).as_posix(), path.read_bytes()) for path in modules]
    made_of = hashlib.sha256(sys.version.encode() + b"".join(b"%s\n%s\n" % (n.encode(), c) for n, c in named))
    kept = root / "harness" / "__pycache__" / "code_digest.txt"
    if (known := _kept_digest(kept, made_of.hexdigest())) is not None:
        return known
    total = hashlib.sha256()
    for name, content in named:
        total.update(f"{name}\n{_code(content)}\n".encode())
    digest = total.hexdigest()[:_DIGITS]
    with suppress(OSError):  # not installed for this user to write
        kept.parent.mkdir(exist_ok=True)
        kept.write_text(f"{made_of.hexdigest()} {digest}", encoding="ascii")
    return digest


def _kept_digest(kept: Path, made_of: str) -> str | None:
    """The digest that was kept for just these sources, if it was written whole."""
    try:
        of, digest = kept.read_text(encoding="ascii").split()
    except (OSError, ValueError):
        return None
    return digest if of == made_of and len(digest) == _DIGITS else None


def _code(content: bytes) -> str:
    """A module's syntax tree as text, without docstrings."""
    tree = ast.parse(content)
    for node in ast.walk(tree):
        body = getattr(node, "body", None)
        if isinstance(body, list):
            node.body = [one for one in body if not _is_text(one)]  # type: ignore[attr-defined]
    return ast.dump(tree)


def _is_text(node: ast.AST) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)
