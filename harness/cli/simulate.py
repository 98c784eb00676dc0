"""`harness simulate`: a case of the virtual rig, with a known truth, perfect or with imperfections of its record."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from pathlib import Path

from harness.api.writing import all_or_nothing
from harness.cli.options import number_in
from harness.errors import InputError

Values = dict[str, dict[str, float]]


def simulate_case(
    folder: Path,
    *,
    hidden: Iterable[str],
    declared: Iterable[str],
    imperfect: bool,
    imperfections: Sequence[str],
    duration: float,
    seed: int,
    force: bool = False,
) -> str:
    """Write a simulated case and say what it is.

    Args:
        folder: to write into; it must not exist, or be empty.
        hidden, declared: effects that act, as texts "NAME.PARAMETER=VALUE".
        imperfect: whether the record has imperfections, of kinds that are drawn where none is asked for.
        imperfections: kinds of them.
        duration: of each recording [s].
        seed: of everything random.
        force: write into a folder that is not empty, and replace files there.

    Raises:
        InputError: something cannot be read or simulated; nothing has been written then.
    """
    from harness.simulator import UNLISTED, Experiment, with_imperfections, write_case

    acting = _values(hidden, "--hide")
    experiment = Experiment(
        hidden={name: values for name, values in acting.items() if name not in UNLISTED},
        unlisted={name: values for name, values in acting.items() if name in UNLISTED},
        declared=_values(declared, "--declare"),
        duration=duration,
        play_start=None,
        seed=seed,
    )
    if imperfect or imperfections:
        experiment = with_imperfections(experiment, imperfections, seed=seed)
    with all_or_nothing(folder, force=force) as scratch:
        if not force and any(one != scratch.parent for one in folder.iterdir()):
            raise InputError(f"{folder} exists and is not an empty folder; name another one with --out, or use --force")
        recordings = write_case(scratch, experiment)
    return f"simulated case: {folder} ({len(recordings)} recordings; truth.json says what acts in them)"


def _values(texts: Iterable[str], option: str) -> Values:
    """`NAME.PARAMETER=VALUE` … as values by parameter by name."""
    made: Values = {}
    for text in texts:
        found = re.fullmatch(r"\s*(\w+)\.(\w+)\s*=\s*(\S+)\s*", text)
        try:
            value = number_in(found[3]) if found else None
        except ValueError:
            value = None
        if found is None or value is None:
            raise InputError(f"{option} {text!r} is not NAME.PARAMETER=VALUE with a number in SI units.")
        if found[2] in made.setdefault(found[1], {}):
            raise InputError(f"{option}: {found[1]}.{found[2]} is given twice; give it once.")
        made[found[1]][found[2]] = value
    return made
