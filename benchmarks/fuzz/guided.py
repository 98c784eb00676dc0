"""`python -m benchmarks.fuzz.guided KIND SECONDS`: one kind of input, guided by the code that it reaches."""

from __future__ import annotations

import sys
from collections import Counter
from pathlib import Path

KEPT = Path("build/fuzz")
"""Inputs that reached new code, as bytes for hypothesis; they are where the next run begins."""


def main(kind: str, seconds: int) -> None:
    """Fuzz until the time is over or something breaks; libFuzzer ends the process."""
    import atexit

    import atheris

    with atheris.instrument_imports(include=["harness.recording", "harness.cli", "harness.api", "harness.identify"]):
        from benchmarks.fuzz.__main__ import table_row
        from benchmarks.fuzz.properties import property_of

    seen: Counter[str] = Counter()
    folder = KEPT / kind
    folder.mkdir(parents=True, exist_ok=True)
    one = property_of(kind, seen, database=None).hypothesis.fuzz_one_input  # type: ignore[attr-defined]
    atexit.register(lambda: print(table_row(kind, seen), flush=True))
    options = [f"-max_total_time={seconds}", "-timeout=30", "-rss_limit_mb=4096", "-max_len=4096", "-verbosity=0"]
    atheris.Setup([sys.argv[0], str(folder), *options, f"-artifact_prefix={KEPT}/{kind}-"], one)
    atheris.Fuzz()


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]))
