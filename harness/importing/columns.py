"""Which signal is which quantity: as the user chose, or as exactly one name says; otherwise an `Ambiguity`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from harness.errors import InputError
from harness.importing.choices import NONE, Ambiguity, Choice, Chosen, Options, parse_chosen
from harness.importing.distinct import distinct, known_values
from harness.importing.signals import Group, Signal, counts_rows, is_known
from harness.importing.words import VOLTS, Kind, Role, factor_of, is_input, read_name, unit_key
from harness.recording.findings import abbreviated, quoted

MOST_CHOICES = 12


@dataclass(frozen=True, eq=False)
class Found:
    """A signal that is a quantity.

    Attributes:
        group: in which it is.
        signal: the signal.
        chosen: the user's choice; `None` if it was found by its name.
        evidence: why it is this quantity, in words.
    """

    group: Group
    signal: Signal
    chosen: Chosen | None
    evidence: str

    @property
    def name(self) -> str:
        """The signal's name with that of its group."""
        return self.group.qualified(self.signal)


def find(
    path: Path, role: Role, groups: Sequence[Group], options: Options, *, taken: Signal | None = None
) -> Found | None:
    """The signal of the angle or the position; `None` if the user says that there is none.

    Args:
        taken: a signal that is another quantity already, which is not offered.

    Raises:
        Ambiguity: several may be it, or none says so by its name.
        InputError: the user chose a column that is not there.
    """
    text = getattr(options, role)
    every = [(group, signal) for group in groups for signal in group.signals]
    if text == NONE and role == "position":
        return None
    if text is not None:
        names = (*(s.name for _, s in every), *(g.qualified(s) for g, s in every))
        chosen = parse_chosen(role, text, names)
        group, signal = named(path, chosen.column, groups, option=f"--{role}")
        return Found(group, signal, chosen, f"--{role}")
    kinds = [(group, signal, _kind(group, signal)) for group, signal in every if signal is not taken]
    matches = distinct(role, [(group, signal) for group, signal, kind in kinds if kind == role])
    shafts = distinct(role, [(group, signal) for group, signal, kind in kinds if kind == "shaft"])
    if role == "angle" and options.linkage is not None and shafts:  # it turns the shaft's angle into the beam's
        matches, shafts = shafts, []
        if len(matches) == 1:
            return _shaft(path, *matches[0], options)
    blank = [group.qualified(signal) for group, signal in matches if not is_known(signal)]
    if blank:
        known = [(group, signal) for group, signal, _ in kinds if is_known(signal)]
        called = [one for one in matches if is_known(one[1])]
        left = called or [one for one in known if _kind(*one) != "time" and _varies(one[1])]
        none = " Where the recording has no positions, give --position none." if role == "position" else ""
        raise Ambiguity(
            f"{path}: {quoted(blank[:1])} is the {_WORDS[role]} by its name, but has no value.",
            _choices(role, left),
            f"Where it holds formulas, open the file in the spreadsheet program and save it, with their values.{none}",
        )
    if len(matches) == 1:
        return Found(*matches[0], None, "its name")
    if role == "angle" and not matches and len(shafts) == 1:
        return _shaft(path, *shafts[0], options)
    if matches:
        question = f"{path}: {len(matches)} columns may be the {_WORDS[role]}."
        raise Ambiguity(question, _choices(role, matches))
    if role == "angle" and shafts:
        angles = quoted([group.qualified(signal) for group, signal in shafts][:MOST_CHOICES])
        raise Ambiguity(
            f"{path}: no column is called the {_WORDS[role]}; {angles} may be it, or that of the servo or motor.",
            _choices(role, shafts),
            f"If a crank turns the beam, add {_LINKAGE}.",
        )
    left = [(group, signal) for group, signal, kind in kinds if kind is None and _varies(signal)]
    # What is called something else is offered after it, as names may mislead.
    left += [(group, signal) for group, signal, kind in kinds if kind not in (None, "time") and _varies(signal)]
    question = (
        f"{path}: no column is called the {_WORDS[role]}; it has {quoted([g.qualified(s) for g, s in every][:20])}."
    )
    if not left:
        raise InputError(f"{question} None of them changes, so that none can be it. Record the {role}.")
    advice = "Where the recording has no positions, give --position none." if role == "position" else ""
    volts = next((signal for _, signal in left if is_input(signal.name) or unit_key(signal.unit) in VOLTS), None)
    if volts is not None:
        unit = "deg" if role == "angle" else "cm"
        advice += f" What is in V needs a calibration too: --{role} '{volts.name}:2.5 {unit}/V+0.1'."
    raise Ambiguity(question, _choices(role, left), advice.strip())


_WORDS = {"time": "time", "angle": "beam's angle", "position": "ball's position"}
_LINKAGE = "--linkage r=RADIUS,L=LEVER in m, such as r=0.025,L=0.4"


def _kind(group: Group, signal: Signal) -> Kind | None:
    if signal.name == group.time:
        return "time"
    return read_name(group.own_name(signal)).kind or _kind_of_group(group, signal)


def _kind_of_group(group: Group, signal: Signal) -> Kind | None:
    """What the name of a topic or structure with one signal besides the time says."""
    others = [one for one in group.signals if one.name != group.time]
    return read_name(group.name).kind if group.name and len(others) == 1 and others[0] is signal else None


def _shaft(path: Path, group: Group, signal: Signal, options: Options) -> Found:
    """The angle of a shaft, which is the beam's only if the user says so."""
    name = group.qualified(signal)
    if options.linkage is not None:
        return Found(group, signal, None, "its name, with --linkage")
    unit = read_name(signal.name).unit or signal.unit
    if not unit.isalpha() or factor_of("angle", unit) is None:
        unit = "deg"
    as_beam = Choice({"angle": name}, f"--angle '{name}'", "it is the beam's angle")
    raise Ambiguity(
        f"{path}: '{name}' may be the angle of the servo or motor, and not that of the beam.",
        (as_beam,),
        f"If a crank turns the beam, give {_LINKAGE}. If the beam turns in "
        "proportion to it, give the ratio as the gain of --angle COLUMN:GAIN UNIT/READING, such as "
        f"--angle '{name}:0.0625 {unit}/{unit}'.",
    )


def named(path: Path, text: str, groups: Sequence[Group], *, option: str) -> tuple[Group, Signal]:
    """The signal of a name or number.

    Raises:
        InputError: there is none, or there are several.
    """
    every = [(group, signal) for group in groups for signal in group.signals]
    for case in (str, str.casefold):  # as written first
        matches = [
            (group, signal)
            for group, signal in every
            if case(text) in (case(signal.name), case(group.qualified(signal)))
        ]
        if len(matches) == 1:
            return matches[0]
        if matches:
            names = quoted([group.qualified(signal) for group, signal in matches][:MOST_CHOICES])
            raise InputError(f"{path}: {option}: '{text}' is in several groups: {names}. Write one of these.")
    renamed = [(group, signal) for group, signal in every if text == signal.written]  # `1` for what is called CH1
    if len(renamed) == 1:
        return renamed[0]
    if text.isdecimal() and 1 <= int(text) <= len(every):
        return every[int(text) - 1]
    names = abbreviated([f"'{group.qualified(signal)}'" for group, signal in every], most=20)
    raise InputError(f"{path}: {option}: there is no column '{text}'. It has {names}; a number counts them from 1.")


def _choices(role: Role, signals: Sequence[tuple[Group, Signal]]) -> tuple[Choice, ...]:
    return tuple(
        Choice({role: group.qualified(signal)}, f"--{role} '{group.qualified(signal)}'", range_of(signal))
        for group, signal in signals[:MOST_CHOICES]
    )


def range_of(signal: Signal) -> str:
    """Range and count of the values, in words."""
    known = known_values(signal)
    if not len(known):
        return "blank"
    unit = f" {signal.unit}" if signal.unit else ""
    return f"{known.min():.4g} to {known.max():.4g}{unit}, {len(known)} values"


def _varies(signal: Signal) -> bool:
    """Whether a column's values change, by more than a count of the rows does."""
    known = known_values(signal)
    return len(np.unique(known)) > 1 and not counts_rows(known)
