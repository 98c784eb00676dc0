"""What is known of an effect is known in one place: nobody else calls it by its name."""

from __future__ import annotations

import ast
import re
from functools import cache
from pathlib import Path

import pytest

from analytic.effects import CATALOGUE, Effect

ROOT = Path(__file__).resolve().parents[2]
FILES = [file for package in ("analytic", "harness", "mjcf", "urdf") for file in sorted((ROOT / package).rglob("*.py"))]
# Of the rig, not of the effect: the quantity r, which `Rig` and rig.toml call as the effect that says r is another.
QUANTITY = "rolling_radius"
QUANTITY_OF_THE_RIG = {
    "analytic/rig.py",
    "harness/api/importing.py",
    "harness/api/scene.py",
    "harness/engines/own_scene/checks.py",
    "harness/identify/rig_completion.py",
    "harness/recording/known_rig.py",
    "harness/report/comparison/inputs.py",
    "harness/tuning/estimate/free.py",
}


@cache
def literals(file: Path) -> tuple[str, ...]:
    """Strings of a module but its docstrings."""
    tree = ast.parse(file.read_text(encoding="utf-8"))
    described = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    return tuple(
        node.value
        for node in ast.walk(tree)
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in described
    )


@pytest.mark.parametrize("name", CATALOGUE)
def test_name_of_an_effect_stands_in_one_file(name: str) -> None:
    """Find the name as a word of a string in the file that defines the effect, and in no other."""
    word = re.compile(rf"\b{name}\b")
    said = {file.relative_to(ROOT).as_posix() for file in FILES if any(map(word.search, literals(file)))}
    if name == QUANTITY:
        assert said >= QUANTITY_OF_THE_RIG
        said -= QUANTITY_OF_THE_RIG
    (home,) = said
    assert home.startswith("analytic/effects/")


@pytest.mark.parametrize("effect", CATALOGUE.values(), ids=CATALOGUE)
def test_what_an_effect_says_of_others_can_be(effect: Effect) -> None:
    """Imitate it by two others of the catalogue, and have a phrase with every parameter."""
    for part in effect.relations.splits_into or ():
        assert CATALOGUE[part.name] is part
        assert part is not effect
    for parameter in effect.parameters:
        assert f"{{{parameter.name}}}" in effect.phrase
