"""Units of time, angle and position of one recording: as written, or those with which the ball moves by the angle."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from analytic.motion import FloatArray
from harness.importing.choices import Linkage, Options
from harness.importing.columns import Found
from harness.importing.physics import Evidence, evidence_of
from harness.importing.times import Times
from harness.importing.units import Scale, resolve
from harness.importing.words import Role


def scales_of(
    path: Path,
    times: Times,
    position_times: Times,
    angle_at: Found,
    position_at: Found | None,
    written: Mapping[Role, Scale | None],
    linkage: Linkage | None,
    options: Options,
) -> dict[Role, Scale]:
    """Units of time, angle and position, as written or from the data.

    Args:
        position_times: times of the position's rows, where these are others.
        written: what the file or the user says; `None` where neither says a unit.

    Raises:
        Ambiguity: the data allow no unit, or several.
    """
    known: dict[Role, Scale | None] = {
        "time": None if times.factor is None else Scale(times.unit, times.factor, times.unit_from),
        **written,
    }
    if all(known.values()):
        return {role: scale for role, scale in known.items() if scale is not None}
    values: dict[Role, FloatArray] = {"time": times.values, "angle": angle_at.signal.values}
    names: dict[Role, str] = {"time": times.name, "angle": angle_at.name}
    if position_at is not None:
        values["position"], names["position"] = position_at.signal.values, position_at.name
    values = {role: values[role] if scale is None else scale.applied(values[role]) for role, scale in known.items()}

    def evidence(angle: FloatArray) -> Evidence:
        """The acceleration against an angle in rad, with times and positions as they are."""
        if position_at is None:
            return Evidence(None)
        position = values["position"]
        if position_at.group is not angle_at.group:
            factor = 1.0 if known["time"] is None else known["time"].factor
            stamps = position_times.values * factor
            rising = np.isfinite(stamps) & np.isfinite(position)
            position = np.interp(values["time"], stamps[rising], position[rising]) if rising.any() else position[:0]
        if len(position) != len(values["time"]):
            return Evidence(None)
        beam = angle if linkage is None else linkage.beam(angle)
        return evidence_of(values["time"], beam, position, gravity=options.gravity)

    return resolve(path, names, values, known, evidence, shaft=linkage is not None)
