"""The recording that ships with the package: the paper's protocol on the virtual rig.

`python -m harness.simulator.bundled` writes it anew, byte for byte the same.
"""

from __future__ import annotations

import argparse
import json
import math
from importlib.resources import files
from pathlib import Path

from analytic.effects import ROLLING_RESISTANCE as RESISTANCE
from analytic.rig import Rig
from harness.simulator.case_folder import ORIGIN
from harness.simulator.plant import Plant, Run
from harness.simulator.protocol import Controller, Protocol, Record, Sensors, perform, recording_text
from harness.simulator.servo import Servo

# The paper fitted α₀ = −0.16° to its own rig; c is what rolling resistance of steel on an aluminium edge may be.
ROLLING_RESISTANCE = 0.0035
LEVEL_ANGLE = math.radians(-0.16)

# Start and travel as in the paper: out by about 0.25 m one way and back by as much, within the laser's 0.2–0.6 m.
PROTOCOLS = {
    "rec_01.csv": Protocol(0.36, ((1.0, 0.28), (3.8, 0.53), (7.0, 0.28), (10.2, 0.50)), 14.0),
    "rec_02.csv": Protocol(0.36, ((0.8, 0.52), (3.9, 0.27), (7.2, 0.52), (10.4, 0.33)), 14.0),
    "rec_03.csv": Protocol(0.36, ((0.9, 0.27), (3.6, 0.40), (6.2, 0.53), (9.3, 0.28), (12.2, 0.36)), 14.5),
}
FIRST_SEED = 20230202  # the paper's year, month and day; each further recording counts on

LASER_RMS = 0.0006  # √((0.3² + 0.8²)/2) mm: the ball spends about as long on either side of 0.4 m


def perform_all() -> dict[str, tuple[Run, Record]]:
    """What happened and what was recorded in every experiment, by file name."""
    plant = Plant(rig=Rig(level_angle=LEVEL_ANGLE), rolling_resistance=ROLLING_RESISTANCE)
    return {
        name: perform(protocol, plant, Servo(), Controller(), Sensors(), FIRST_SEED + number)
        for number, (name, protocol) in enumerate(PROTOCOLS.items())
    }


def rig_text() -> str:
    """The bundled `rig.toml`: Table 1 of the paper, the sensors, and nothing of what is hidden."""
    rig = Rig()
    return f"""\
# Simulated, not measured: the paper's protocol on a virtual rig. See README.md; truth.json says what acts in it.
# Values: Table 1 of Gembalczyk, Domogała, Leśniowski, Actuators 2023, 12(2), 59, doi 10.3390/act12020059.
origin = "{ORIGIN}"

[ball]
mass_kg = {rig.mass}
inertia_kg_m2 = {rig.inertia}
radius_m = {rig.radius}

[beam]
rolling_radius_m = {rig.rolling_radius}
eccentricity_m = {rig.eccentricity}
level_angle_rad = {LEVEL_ANGLE:.7f}  # initial beam deflection of −0.16°

[environment]
gravity_m_s2 = {rig.gravity}

[sensors]
angle_resolution_rad = {Sensors().encoder.resolution:.12f}  # 1024 P/R, 4096 counts a turn
position_noise_m = {LASER_RMS}  # 0.3 mm below 0.4 m and 0.8 mm above, root mean square
position_resolution_m = {Sensors().laser.resolution}

[recordings]
identify = ["rec_01.csv", "rec_02.csv"]
predict = ["rec_03.csv"]
"""


def truth_text() -> str:
    """What acts in the recordings beyond the rig that `rig.toml` declares."""
    truth = {
        "origin": ORIGIN,
        "effects": [{"name": RESISTANCE.name, "parameters": {"coefficient": ROLLING_RESISTANCE}}],
        "unlisted": None,
        "declared": [],
    }
    return json.dumps(truth, indent=2) + "\n"


def case_files() -> dict[str, str]:
    """Text of every generated file of the case, by name."""
    recordings = {name: recording_text(record) for name, (_, record) in perform_all().items()}
    return {"rig.toml": rig_text(), "truth.json": truth_text(), **recordings}


def case_folder() -> Path:
    """Where the bundled case lies."""
    return Path(str(files("harness") / "data" / "paper_protocol"))


def main() -> None:
    """Write the case."""
    parser = argparse.ArgumentParser(prog="python -m harness.simulator.bundled", description=__doc__)
    parser.add_argument("--out", type=Path, default=case_folder(), help="folder to write to (default: the package's)")
    folder: Path = parser.parse_args().out
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in case_files().items():
        (folder / name).write_text(text, encoding="utf-8", newline="\n")


if __name__ == "__main__":
    main()
