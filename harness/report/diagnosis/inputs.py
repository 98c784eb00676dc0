"""What went in: recordings, rig, sensors, declared effects, findings, and what repeats the diagnosis."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict

from harness.formatting import length, number
from harness.report.diagnosis.account import Account
from harness.report.page import Section
from harness.report.tables import Column, Row, Table

_UNITS = {
    "mass": "kg",
    "inertia": "kg m²",
    "radius": "m",
    "rolling_radius": "m",
    "eccentricity": "m",
    "gravity": "m/s²",
    "level_angle": "rad",
}


def section(account: Account) -> Section:
    """The inputs."""
    inputs = account.record.get("inputs")
    stated = inputs if isinstance(inputs, Mapping) else {}
    context = {
        "origin": account.case.origin,
        "recordings": _recordings(account),
        "rig": _rig(account),
        "declared": [(one.effect.name, list(one.values.items())) for one in account.diagnosis.problem.declared],
        "noise": length(math.sqrt(account.diagnosis.problem.noise), 2),
        "findings": account.case.findings,
        "versions": dict(stated.get("versions", {})),
        "command": account.command,
    }
    return Section("inputs", "Inputs", "Inputs", "diagnosis/inputs.html", context)


def _recordings(account: Account) -> Table:
    columns = [Column("recording", text=True), Column("length", "s"), Column("positions"), Column("SHA-256", text=True)]
    rows = []
    for one in account.diagnosis.problem.records:
        source = account.case.recordings[one.name]
        rows.append(
            Row(
                (
                    one.name,
                    number(float(one.time[-1] - one.time[0])),
                    str(int(source.known.sum())),
                    f"`{source.sha256[:16]}…`",
                )
            )
        )
    return Table("Recordings that were identified from", columns, rows)


def _rig(account: Account) -> Table:
    columns = [Column("quantity", text=True), Column("value"), Column("unit", text=True), Column("status", text=True)]
    known = account.case.rig
    values = asdict(account.diagnosis.problem.rig)
    rows = [
        Row((name.replace("_", " "), number(values[name], 4), unit, _status(getattr(known, name) is not None)))
        for name, unit in _UNITS.items()
    ]
    return Table("The rig, before anything was found", columns, rows)


def _status(given: bool) -> str:
    return "given" if given else "estimated or assumed"
