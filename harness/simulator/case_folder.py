"""A simulated experiment as a case folder: `rig.toml`, recordings, and the truth beside them."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from analytic.effects import ECCENTRIC_PIVOT
from harness.simulator.effects import UNLISTED, Effects
from harness.simulator.experiment import Experiment, SimulatedRecording
from harness.simulator.imperfections import Imperfections
from harness.simulator.protocol import Record, recording_text

ORIGIN = "simulated by harness.simulator (rigid bodies in contact, not one of the models under test); no measurement"
IMPERFECT = "; the record is spoilt on purpose"
KNOWN_UNTIL = 1.5  # positions of a recording to predict are blank after this [s]


def rig_text(experiment: Experiment) -> str:
    """`rig.toml`: what is declared, and nothing of what is hidden: where a hidden pivot is, it leaves open."""
    rig, sensors = experiment.rig, experiment.sensors
    noise = f"angle_noise_rad = {experiment.angle_noise:.9g}\n" if experiment.angle_noise > 0.0 else ""
    declared = "".join(
        f'[[declared]]\nname = "{name}"\n' + "".join(f"{key} = {value!r}\n" for key, value in values.items()) + "\n"
        for name, values in experiment.declared.items()
    )
    eccentricity = "" if ECCENTRIC_PIVOT.name in experiment.hidden else f"eccentricity_m = {rig.eccentricity!r}\n"
    level = f"level_angle_rad = {rig.level_angle!r}\n" if rig.level_angle else ""
    names = _names(experiment)
    identify, predict = names[: experiment.identify], names[experiment.identify :]
    return f"""\
origin = "{_origin(experiment)}"

[ball]
mass_kg = {rig.mass!r}
inertia_kg_m2 = {rig.inertia!r}
radius_m = {rig.radius!r}

[beam]
rolling_radius_m = {rig.rolling_radius!r}
{eccentricity}{level}
[environment]
gravity_m_s2 = {rig.gravity!r}

[sensors]
angle_resolution_rad = {sensors.encoder.resolution:.12f}
{noise}position_noise_m = {experiment.position_noise!r}
position_resolution_m = {experiment.position_resolution!r}

{declared}[recordings]
identify = {json.dumps(identify)}
predict = {json.dumps(predict)}
"""


def truth(experiment: Experiment) -> dict[str, object]:
    """What acts: hidden `effects`, what the `unlisted` one depends on most and its law, and what is declared.

    Where the record is imperfect, also how (`Imperfections`), and how it was sampled.
    """
    return {
        "origin": _origin(experiment),
        "effects": _listed(experiment.hidden),
        "unlisted": next((UNLISTED[name].depends_on[0] for name in experiment.unlisted), None),
        "unlisted_effects": [
            {**entry, "depends_on": list(UNLISTED[str(entry["name"])].depends_on)}
            for entry in _listed(experiment.unlisted)
        ],
        "declared": _listed(experiment.declared),
        **({} if experiment.imperfections is None else _imperfect(experiment, experiment.imperfections)),
        "seed": experiment.seed,
    }


def write_case(
    folder: Path, experiment: Experiment, recordings: Sequence[SimulatedRecording] | None = None
) -> Sequence[SimulatedRecording]:
    """Write a case that `harness.recording.load_case` reads.

    Args:
        folder: made if it does not exist.
        experiment: what is to be recorded.
        recordings: those of the experiment, when they have been made; they are carried out otherwise.

    Returns:
        The recordings.

    Raises:
        InputError: see `Experiment.recordings`.
    """
    recordings = experiment.recordings() if recordings is None else recordings
    folder.mkdir(parents=True, exist_ok=True)
    files = {"rig.toml": rig_text(experiment), "truth.json": json.dumps(truth(experiment), indent=1) + "\n"}
    for number, (name, one) in enumerate(zip(_names(experiment), recordings, strict=True)):
        if number < experiment.identify:
            files[name] = recording_text(one.record)
        else:
            known = np.where(one.record.time <= KNOWN_UNTIL + 1e-9, one.record.position, np.nan)
            files[name] = recording_text(Record(one.record.time, one.record.angle, known))
            files[name.replace(".csv", "_true.csv")] = _true_text(one)
    for name, text in files.items():
        (folder / name).write_text(text, encoding="utf-8", newline="\n")
    return recordings


def _origin(experiment: Experiment) -> str:
    return ORIGIN if experiment.imperfections is None else ORIGIN + IMPERFECT


def _imperfect(experiment: Experiment, imperfections: Imperfections) -> dict[str, object]:
    sampled = {
        "rate": experiment.rate,
        "position_noise": experiment.position_noise,
        "position_resolution": experiment.position_resolution,
    }
    return {"imperfections": imperfections.described(), "sampling": sampled}


def _names(experiment: Experiment) -> list[str]:
    return [f"rec_{number + 1:02d}.csv" for number in range(experiment.identify + experiment.predict)]


def _listed(effects: Effects) -> list[dict[str, object]]:
    return [{"name": name, "parameters": dict(values)} for name, values in effects.items()]


def _true_text(one: SimulatedRecording) -> str:
    lines = ["time_s,ball_position_m"]
    lines += [f"{t:.4f},{s:.6f}" for t, s in zip(one.record.time, one.noiseless, strict=True)]
    return "\n".join(lines) + "\n"
