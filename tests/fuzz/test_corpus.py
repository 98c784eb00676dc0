"""Inputs that were kept: each has the outcome that stands in the table, a result or one message."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest

from benchmarks.fuzz.corpus import SUFFIXES, TABLE, every, given_of, place_in
from benchmarks.fuzz.doors import seed
from benchmarks.fuzz.foreign import BINARIES, BOOK, TEXTS
from benchmarks.fuzz.properties import INPUTS, outcome_of

CORPUS = Path(__file__).parent / "corpus"


def table() -> dict[str, tuple[int, str]]:
    """Exit code and place by file."""
    with (CORPUS / TABLE).open(encoding="utf-8", newline="") as file:
        return {row["file"]: (int(row["code"]), row["place"]) for row in csv.DictReader(file)}


@pytest.mark.slow
@pytest.mark.parametrize("kind", INPUTS)
def test_every_kept_input_has_its_outcome(kind: str) -> None:
    """End with the exit code of the table, and with one message that names the same place."""
    expected = {file: made for file, made in table().items() if file.startswith(f"{kind}/")}
    found = {}
    for file in expected:
        made = outcome_of(kind, given_of(kind, (CORPUS / file).read_bytes()))
        found[file] = made.code, place_in(made.message)
    assert found == expected


def test_the_corpus_is_what_the_script_makes() -> None:
    """Keep exactly the files that `python -m benchmarks.fuzz.corpus` writes, at least a hundred."""
    made = {f"{kind}/{name}{SUFFIXES[kind]}": content for kind, name, content in every()}
    kept = {one.relative_to(CORPUS).as_posix(): one.read_bytes() for one in CORPUS.glob("*/*") if one.is_file()}
    assert kept == made
    assert table().keys() == made.keys()
    assert len(made) >= 100


@pytest.mark.slow
def test_the_seeds_are_good() -> None:
    """Give a result for what all changes begin with."""
    for kind, name in (
        ("csv", "rec_01.csv"),
        ("rig", "rig.toml"),
        ("diagnosis", "diagnosis.json"),
        ("effects", "mine.py"),
        ("sweep", "sweep.toml"),
        ("settings", "tuned.toml"),
        ("mjcf", "own.xml"),
        ("urdf", "own.urdf"),
        *(("import", one) for one in (*TEXTS, *BINARIES, BOOK)),
    ):
        assert outcome_of(kind, seed(name)).code == 0, name
