"""Sections on the inputs (rig, sensors, declared effects, findings) and on how to reproduce the report."""

import math
from collections.abc import Mapping

from harness.formatting import NONE, brief, length, listed, number, plus_minus
from harness.identify.rig_completion import RigEstimate
from harness.report.comparison.subject import Subject
from harness.report.page import Section
from harness.report.tables import Table, texts

_QUANTITIES = {  # field of Rig: name, unit as printed, factor to it
    "mass": ("m, ball mass", "kg", 1.0),
    "inertia": ("J, ball inertia", "kg m²", 1.0),
    "radius": ("R, ball radius", "mm", 1e3),
    "rolling_radius": ("r, rolling radius", "mm", 1e3),
    "eccentricity": ("h, pivot to edge plane", "mm", 1e3),
    "gravity": ("g, gravity", "m/s²", 1.0),
    "level_angle": ("α₀, level angle", "deg", math.degrees(1.0)),
    "friction_coefficient": ("f_b of the friction models", "by reading", 1.0),
    "transition_velocity": ("v_t of the friction models", "mm/s", 1e3),
}
_ESTIMATED = {  # beginning of an estimate's name: field of Rig
    "eccentricity": "eccentricity",
    "level angle": "level_angle",
    "rolling radius": "rolling_radius",
    "inertia": "inertia",
    "gravity": "gravity",
}


def inputs(subject: Subject) -> Section:
    """The inputs."""
    setting = subject.study.setting
    context = {
        "rig": _rig(subject),
        "sensors": _sensors(subject),
        "start": setting.start,
        "start_how": _start_how(subject),
        "declared": [(one.name, list(one.parameters.items())) for one in setting.case.declared],
        "findings": setting.case.findings,
        "origin": setting.case.origin,
    }
    return Section("inputs", "Inputs", "Inputs", "comparison/inputs.html", context)


def _rig(subject: Subject) -> Table:
    setting = subject.study.setting
    estimates = {_field(one): one for one in setting.estimates}
    rows = []
    ratio = estimates.get("")
    if ratio is not None:
        rows.append((ratio.name, plus_minus(ratio.value, ratio.std), "", "estimated", ratio.how))
    for name, (title, unit, factor) in _QUANTITIES.items():
        value = getattr(setting.rig, name) * factor
        estimate = estimates.get(name)
        text = number(value, 4) if estimate is None else plus_minus(value, estimate.std * factor)
        rows.append((title, text, unit, *_status(subject, name, estimate)))
    columns = [*texts("quantity"), "value", *texts("unit", "status", "how")]
    scenes = [engine.scene_file for engine, _ in subject.study.engines if engine.scene_file]
    title = f"Rig of the models; that of {listed(scenes)} is in the file" if scenes else "Rig used by every source"
    return Table(title, columns, rows)


def _field(estimate: RigEstimate) -> str:
    """The field of `Rig` that an estimate refers to; empty for the rolling ratio, which combines several."""
    return next((name for start, name in _ESTIMATED.items() if estimate.name.startswith(start)), "")


def _status(subject: Subject, name: str, estimate: RigEstimate | None) -> tuple[str, str]:
    setting = subject.study.setting
    if estimate is not None:
        if math.isfinite(estimate.std):
            return "estimated", estimate.how
        return "assumed", estimate.how.removeprefix("assumed: ")
    if name in ("friction_coefficient", "transition_velocity"):
        return "assumed", "the paper's Table 1, fitted to another rig"
    if name == "level_angle" and setting.choices.level_angle is not None:
        return "given", "on the command line"
    if name in setting.case.rig_from:
        return "given", setting.case.rig_from[name]
    if getattr(setting.case.rig, name) is not None:
        return "given", "rig.toml" if setting.case.sha256 else "the paper's Table 1 (there is no rig.toml)"
    if name == "level_angle":
        return "assumed", "zero of the recorded angle"
    return "assumed", "the ball's motion depends only on the rolling ratio K"


def _sensors(subject: Subject) -> Table:
    setting = subject.study.setting
    declared, drive, ball = setting.case.sensors, setting.drive.sensor, setting.ball
    step = "given" if declared.angle_resolution else "inferred from the readings"
    degrees = number(math.degrees(drive.resolution)) + "°" if drive.resolution else "continuous"
    noise = f"{number(math.degrees(drive.noise), 2)}°"
    rows = [
        ("angle, resolution", degrees, step),
        ("angle, noise σ", noise, "estimated" if drive.estimated else "given"),
        ("position, noise σ", length(ball.noise, 2), "estimated" if ball.noise_estimated else "given"),
    ]
    if declared.position_resolution:
        rows.append(("position, resolution", length(declared.position_resolution), "given"))
    return Table("Sensor models", [*texts("sensor"), "value", *texts("status")], rows)


def _start_how(subject: Subject) -> str:
    setting = subject.study.setting
    if setting.choices.start is not None:
        return "as given"
    first = int(subject.whole.first[0])
    std = [math.sqrt(max(float(value), 0.0)) for value in setting.ball.state_covariance(first).diagonal()]
    return f"estimated: ± {length(std[0], 2)} and ± {number(1e3 * std[1], 2)} mm/s"


def reproduce(subject: Subject) -> Section:
    """The command, and the manifest's hashes, versions and seed."""
    # Of the settings, rig and estimates are under Inputs, parameters under Engines.
    shown = {key: value for key, value in subject.manifest.items() if key != "settings"}
    context = {"command": subject.command, "entries": flat(shown)}
    return Section("reproduce", "How to reproduce this report", "Reproduce", "comparison/reproduce.html", context)


def flat(manifest: Mapping[str, object], prefix: str = "") -> list[tuple[str, str]]:
    """Flattens a nested mapping to dotted names such as `versions.numpy` and values as text."""
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
