"""How often `harness import` tells the units and the sign of measured recordings from the data alone.

    python -m benchmarks.import_units FOLDER

FOLDER holds cases. Each recording is offered in twelve combinations of units without any name of a unit, and once with
the angle reversed. Prints counts by case; docs/import.md cites them.
"""

from __future__ import annotations

import argparse
import itertools
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from analytic.motion import FloatArray
from harness.importing import Ambiguity, Group, Options, Signal, SourceFile, understand
from harness.importing.words import ROLES, UNITS
from harness.recording import load_case

COMBINATIONS = tuple(itertools.product(("s", "ms"), ("rad", "deg"), ("m", "cm", "mm")))
MOST_RECORDINGS = 8  # of a case


def offered(names: Sequence[str], columns: Sequence[FloatArray]) -> SourceFile:
    """A file with these columns, already read."""
    signals = tuple(Signal(name, values) for name, values in zip(names, columns, strict=True))
    return SourceFile(Path("offered"), "", "text", (Group("", signals, np.arange(1, len(columns[0]) + 1)),))


def units_told(columns: Sequence[FloatArray], units: Sequence[str]) -> str:
    """Whether the units are found, asked for, or wrong."""
    factors = [UNITS[role][unit] for role, unit in zip(ROLES, units, strict=True)]
    file = offered(("t", "angle", "x"), [values / factor for values, factor in zip(columns, factors, strict=True)])
    try:
        found = tuple(line.unit for line in understand([file], Options(keep_signs=True)).lines)
    except Ambiguity:
        return "units asked for"
    return "units right" if found == tuple(units) else "units wrong"


def sign_told(columns: Sequence[FloatArray], sign: float) -> str:
    """What is said of an angle multiplied by a sign."""
    time, angle, position = columns
    name = "right sign" if sign > 0.0 else "reversed sign"
    try:
        understood = understand([offered(("t_s", "angle_rad", "x_m"), (time, sign * angle, position))], Options())
    except Ambiguity:
        return f"{name} called reversed"
    return f"{name} {'called right' if understood.sign_checked else 'not checked'}"


def main() -> None:
    """Print counts by case, and of all."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    total: Counter[str] = Counter()
    for folder in sorted(one for one in parser.parse_args().folder.iterdir() if one.is_dir()):
        count: Counter[str] = Counter()
        for recording in list(load_case(folder).recordings.values())[:MOST_RECORDINGS]:
            columns = (recording.time, recording.angle, recording.position)
            count.update(units_told(columns, units) for units in COMBINATIONS)
            count.update(sign_told(columns, sign) for sign in (1.0, -1.0))
            count["recordings"] += 1
        print(f"{folder.name}: {dict(sorted(count.items()))}")
        total.update(count)
    print(f"all: {dict(sorted(total.items()))}")


if __name__ == "__main__":
    main()
