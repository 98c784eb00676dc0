"""`python -m benchmarks.fuzz.guided KIND SECONDS`: one kind of input, guided by the code that it reaches."""

from __future__ import annotations

import sys
from collections import Counter
from pathlib import Path

import numpy as np

KEPT = Path("build/fuzz")
"""Inputs that reached new code, as bytes for hypothesis; they are where the next run begins."""
_BEGINNINGS, _LENGTH = 20, 2048  # files and bytes to begin with: hypothesis makes nothing of a few bytes
_OFTEN = 20  # inputs between two notes of what came out, as libFuzzer ends the process without another word


def counts_file(kind: str) -> Path:
    """Where a run notes its outcomes, as a line of a table."""
    return KEPT / f"{kind}.txt"


def main(kind: str, seconds: int) -> None:
    """Fuzz until the time is over or something breaks; libFuzzer ends the process."""
    import atheris

    with atheris.instrument_imports(include=["harness"]):
        from benchmarks.fuzz.properties import property_of, table_row

    seen: Counter[str] = Counter()
    folder = KEPT / kind
    folder.mkdir(parents=True, exist_ok=True)
    if not any(folder.iterdir()):
        generator = np.random.default_rng(0)
        for at in range(_BEGINNINGS):
            (folder / f"begin_{at:02d}").write_bytes(generator.bytes(_LENGTH))
    fuzz_one_input = property_of(kind, seen, database=None).hypothesis.fuzz_one_input  # type: ignore[attr-defined]

    def one(data: bytes) -> None:
        fuzz_one_input(data)
        if seen.total() % _OFTEN == 0:
            counts_file(kind).write_text(table_row(kind, seen), encoding="utf-8")

    options = [f"-max_total_time={seconds}", "-timeout=30", "-rss_limit_mb=4096", "-max_len=8192", "-len_control=0"]
    atheris.Setup([sys.argv[0], str(folder), *options, "-verbosity=0", f"-artifact_prefix={KEPT}/{kind}-"], one)
    atheris.Fuzz()


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]))
