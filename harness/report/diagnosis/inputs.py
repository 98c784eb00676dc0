"""Section on the inputs: recordings, rig, reading noise, declared effects, findings, and the command."""

from __future__ import annotations

import math
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
    context = {
        "origin": account.case.origin,
        "recordings": _recordings(account),
        "rig": _rig(account),
        "declared": [(one.effect.name, list(one.values.items())) for one in account.diagnosis.problem.declared],
        "noise": length(math.sqrt(account.diagnosis.problem.reading_variance), 2),
        "findings": account.case.findings,
        "versions": account.record.inputs.versions,
        "command": account.command,
    }
    return Section("inputs", "Inputs", "Inputs", "diagnosis/inputs.html", context)


def _recordings(account: Account) -> Table:
    columns = [Column("recording", text=True), Column("length", "s"), Column("positions"), Column("SHA-256", text=True)]
    rows = []
    for one in account.diagnosis.problem.recordings:
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
    return Table("Recordings used for identification", columns, rows)


def _rig(account: Account) -> Table:
    columns = [Column("quantity", text=True), Column("value"), Column("unit", text=True), Column("status", text=True)]
    known = account.case.rig
    values = asdict(account.diagnosis.problem.rig)
    rows = [
        Row((name.replace("_", " "), number(values[name], 4), unit, _status(getattr(known, name) is not None)))
        for name, unit in _UNITS.items()
    ]
    return Table("Rig without the effects found", columns, rows)


def _status(given: bool) -> str:
    return "given" if given else "estimated or assumed"
