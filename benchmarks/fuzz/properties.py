"""What is fuzzed: for each door a strategy of inputs, and the property that holds for whatever comes out."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from functools import partial
from typing import Any

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from benchmarks.fuzz.command_lines import command_lines, replaced_by
from benchmarks.fuzz.documents import diagnosis_files, rig_files, settings_files, sweep_files
from benchmarks.fuzz.doors import (
    CSV,
    DOORS,
    EFFECTS,
    FOREIGN,
    MJCF,
    RIG,
    SETTINGS,
    SWEEP,
    URDF,
    Outcome,
    outcome,
    seed,
    through_command,
)
from benchmarks.fuzz.foreign import foreign_files
from benchmarks.fuzz.python_files import effect_files
from benchmarks.fuzz.scenes import mjcf_files, urdf_files
from benchmarks.fuzz.tables import csv_files
from harness.identify.record import FILE

Property = Callable[[], None]
INPUTS = ("csv", "rig", "diagnosis", "effects", "options", "import", "sweep", "settings", "mjcf", "urdf")
_LISTED = (CSV, "rec_02.csv", "rec_03.csv")
SEEDS = {name: seed(name) for name in (CSV, RIG, EFFECTS, FILE, SWEEP, SETTINGS, MJCF)}


def strategy_of(kind: str) -> st.SearchStrategy:
    """Inputs of a kind: the changed file's bytes, or words."""
    return {
        "csv": csv_files,
        "rig": rig_files,
        "diagnosis": diagnosis_files,
        "effects": effect_files,
        "options": command_lines,
        "import": foreign_files,
        "sweep": sweep_files,
        "settings": settings_files,
        "mjcf": mjcf_files,
        "urdf": urdf_files,
    }[kind]()


def outcome_of(kind: str, given: bytes | list[str]) -> Outcome:
    """What comes out with this input of this kind, all else being good.

    Raises:
        Broken: it is neither a result nor one message.
    """
    if isinstance(given, list):
        return outcome(partial(through_command, words=given), SEEDS, replaced=replaced_by(given))
    if kind == "csv":
        return outcome(DOORS["csv"], {CSV: given})
    if kind == "rig":
        return outcome(
            DOORS["case"], {**dict.fromkeys(("rec_01.csv", "rec_02.csv", "rec_03.csv"), SEEDS[CSV]), RIG: given}
        )
    if kind == "diagnosis":
        return outcome(DOORS["diagnosis"], {CSV: SEEDS[CSV], FILE: given})
    if kind == "sweep":
        case = {f"case/{name}": SEEDS[CSV] for name in _LISTED}
        return outcome(DOORS["sweep"], {**case, f"case/{RIG}": SEEDS[RIG], SWEEP: given})
    if kind == "settings":
        return outcome(DOORS["settings"], {CSV: SEEDS[CSV], SETTINGS: given})
    if kind in ("mjcf", "urdf"):
        return outcome(DOORS["scene"], {MJCF if kind == "mjcf" else URDF: given})
    if kind == "import":
        return outcome(DOORS["import"], {FOREIGN: given})
    return outcome(DOORS["effects"], {EFFECTS: given})


def property_of(kind: str, seen: Counter[str], **options: Any) -> Property:
    """A test by hypothesis that tries inputs of a kind, and counts the outcomes in `seen`.

    Args:
        options: of `hypothesis.settings`.
    """

    @settings(deadline=None, suppress_health_check=list(HealthCheck), print_blob=True, **options)
    @given(strategy_of(kind))
    def every_input_has_a_result_or_one_message(given: bytes | list[str]) -> None:
        seen[outcome_of(kind, given).kind] += 1

    return every_input_has_a_result_or_one_message


def table_row(kind: str, seen: Counter[str]) -> str:
    """A line of the table of docs/reliability.md."""
    counts = " | ".join(str(seen[one]) for one in ("result", "no", "refused", "failed"))
    return f"| {kind} | {seen.total()} | {counts} |"
