"""How to get this report again: the command, and the manifest's hashes, versions and seed."""

from __future__ import annotations

from collections.abc import Mapping

from harness.formatting import NONE, brief
from harness.report.comparison.subject import Subject
from harness.report.page import Section

_SHOWN_ELSEWHERE = ("settings",)  # rig and estimates under Inputs, parameters under Engines


def section(subject: Subject) -> Section:
    """The manifest."""
    shown = {key: value for key, value in subject.manifest.items() if key not in _SHOWN_ELSEWHERE}
    context = {"command": subject.command, "entries": flat(shown)}
    return Section("reproduce", "How to reproduce this report", "Reproduce", "comparison/reproduce.html", context)


def flat(manifest: Mapping[str, object], prefix: str = "") -> list[tuple[str, str]]:
    """Names such as `versions.numpy` and their values as texts, of a nested mapping."""
    entries: list[tuple[str, str]] = []
    for key, value in manifest.items():
        name = f"{prefix}{key}"
        if isinstance(value, Mapping):
            entries += flat(value, f"{name}.")
        else:
            entries.append((name, _text(value)))
    return entries


def _text(value: object) -> str:
    if isinstance(value, list | tuple):
        return ", ".join(map(_text, value)) or NONE
    if value is None:
        return NONE
    return brief(value, 6) if isinstance(value, float) else str(value)
