from __future__ import annotations

import sys
import tomllib
from pathlib import Path

import pytest

from harness.provenance import PACKAGES, ROOT, code_digest, versions


def package(root: Path) -> Path:
    """A product of one module."""
    module = root / "harness" / "verdict.py"
    module.parent.mkdir(parents=True)
    module.write_text('"""Verdict."""\nLIMIT = 1\n', encoding="utf-8")
    return module


def test_comments_and_docstrings_leave_the_digest_as_it_is(tmp_path: Path) -> None:
    """Keep the digest where only words and layout change."""
    module = package(tmp_path)
    before = code_digest(tmp_path)
    module.write_text('"""The verdict."""\n\nLIMIT = 1  # why\n', encoding="utf-8")
    assert code_digest(tmp_path) == before


@pytest.mark.parametrize("name", ["verdict.py", "report/wording.py", "new.py"])
def test_any_changed_or_new_module_changes_the_digest(tmp_path: Path, name: str) -> None:
    """Change the digest with the code of whichever module of the product."""
    package(tmp_path)
    before = code_digest(tmp_path)
    changed = tmp_path / "harness" / name
    changed.parent.mkdir(exist_ok=True)
    changed.write_text("LIMIT = 2\n", encoding="utf-8")
    assert code_digest(tmp_path) != before


def test_a_kept_digest_is_that_of_the_code(tmp_path: Path) -> None:
    """Read from `__pycache__` what was kept there of the same sources, and nothing that is spoilt or of others."""
    module = package(tmp_path)
    kept = module.parent / "__pycache__" / "code_digest.txt"
    fresh = code_digest(tmp_path)
    whole = kept.read_text(encoding="ascii")
    kept.write_text(whole.replace(fresh, "0" * len(fresh)), encoding="ascii")
    assert code_digest(tmp_path) == "0" * len(fresh)
    for spoilt in ("", whole[:-1], whole[1:]):
        kept.write_text(spoilt, encoding="ascii")
        assert code_digest(tmp_path) == fresh


def test_every_package_of_the_product_is_in_the_digest() -> None:
    """Take in each top-level package, and say the same digest twice."""
    assert all((ROOT / package / "__init__.py").exists() for package in PACKAGES)
    assert versions()["code"] == code_digest()


def test_no_module_has_the_name_of_one_of_the_standard_library() -> None:
    """Shadow nothing that Python ships, wherever a folder of ours stands on the path."""
    modules = [path for package in PACKAGES for path in (ROOT / package).rglob("*.py")]
    taken = {path.relative_to(ROOT).as_posix() for path in modules if path.stem in sys.stdlib_module_names}
    assert {name for name in taken if not name.endswith(("__init__.py", "__main__.py"))} == set()


def test_what_is_to_be_mutated_exists() -> None:
    """Name no module and no test in the configuration of `make mutants` that has moved."""
    config = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["mutation"]
    named = [name for target in config["targets"] for name in (*target["modules"], *target["tests"])]
    assert named
    assert [name for name in named if not (ROOT / name).exists()] == []
