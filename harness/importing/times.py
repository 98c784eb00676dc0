"""The times of a group's rows: a column, the file's own sampling interval, or a rate given by the user."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from analytic.motion import FloatArray
from harness.importing.choices import Ambiguity, Choice, Chosen, Options, parse_chosen
from harness.importing.columns import named, range_of
from harness.importing.distinct import distinct
from harness.importing.signals import Group, Signal, counts_rows, is_known, unit_of
from harness.importing.words import factor_of, read_name


@dataclass(frozen=True, eq=False)
class Times:
    """Times of the rows of a group.

    Attributes:
        name: of the column; empty if no column holds them.
        values: shape (n,), in a unit still to be multiplied by the factor.
        unit: as written, empty if unknown.
        factor: to seconds; `None` if the unit is not known.
        evidence: where they come from, in words.
        unit_from: where the unit comes from, in words.
        chosen: the user's choice, if it was one.
    """

    name: str
    values: FloatArray
    unit: str
    factor: float | None
    evidence: str
    unit_from: str
    chosen: Chosen | None = None


def times_of(path: Path, group: Group, groups: Sequence[Group], options: Options) -> Times:
    """The times of a group.

    Raises:
        Ambiguity: several columns may be the time, or none is called so.
        InputError: the user chose a column that is not there.
    """
    count = len(group.rows)
    if options.time is not None:
        names = tuple(name for one in groups for s in one.signals for name in (s.name, one.qualified(s)))
        chosen = parse_chosen("time", options.time, names)
        here = [one for one in group.signals if chosen.column in (one.name, group.qualified(one))]
        signal = here[0] if here else named(path, chosen.column, groups, option="--time")[1]
        if len(signal.values) == count:
            return _of_signal(signal, chosen, "--time")
    places = np.arange(count, dtype=np.float64) if group.places is None else group.places.astype(np.float64)
    if options.rate is not None:
        return Times("", places / options.rate, "s", 1.0, "--rate", f"{options.rate:g} Hz given")
    if group.time is not None:
        signal = next(one for one in group.signals if one.name == group.time)
        return _of_signal(signal, None, signal.unit_from or "the format")
    matches = [one for one in group.signals if read_name(group.own_name(one)).kind == "time" and is_known(one)]
    if group.step is not None:  # what counts the rows beside it is no time
        matches = [one for one in matches if _unit(one)[0] or not counts_rows(one.values)]
    if len(matches) > 1:
        with_values = [one for one in matches if _rises(one)]
        several = [(group, one) for one in matches]
        matches = with_values if len(with_values) == 1 else [one for _, one in distinct("time", several)]
    if len(matches) == 1:
        return _of_signal(matches[0], None, "its name")
    if not matches and group.step is not None:
        start = group.start
        values = start + group.step * places
        return Times("", values, "s", 1.0, f"'{group.step_from}' in the file", f"{group.step:g} s")
    rising = matches or [one for one in group.signals if _rises(one)]
    choices = tuple(
        Choice({"time": group.qualified(one)}, f"--time '{group.qualified(one)}'", f"rises, {range_of(one)}")
        for one in rising[:6]
    )
    which = f"{len(matches)} columns may be the time." if matches else "no column is called the time."
    raise Ambiguity(f"{path}: {which}", choices, "If no column holds it, give the sampling rate: --rate 100 (Hz).")


def _of_signal(signal: Signal, chosen: Chosen | None, evidence: str) -> Times:
    name = signal.name
    if chosen is not None and chosen.unit:
        values = chosen.gain * signal.values + chosen.offset
        return Times(name, values, chosen.unit, chosen.factor, evidence, "--time", chosen)
    unit, source = _unit(signal)
    factor = factor_of("time", unit) if unit else None
    return Times(name, signal.values, unit if factor else "", factor, evidence, source if factor else "")


def _unit(signal: Signal) -> tuple[str, str]:
    """The unit of a time and where it is written, also where its name is no symbol but `seconds`."""
    unit, source = unit_of(signal)
    seconds = signal.name.casefold() in ("second", "seconds", "sekunden", "secondes")
    return unit or ("s" if seconds else ""), source


def _rises(signal: Signal) -> bool:
    known = signal.values[np.isfinite(signal.values)]
    return len(known) > 2 and bool(np.all(np.diff(known) >= 0.0)) and float(known[-1]) > float(known[0])
