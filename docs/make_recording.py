"""docs/recording.md: which motion, sensor and length shows which effect at which size. Takes minutes.

Each column is a simulated recording of the paper's rig without hidden effects, which `harness check` checks.
"""

from __future__ import annotations

import math
import tempfile
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import harness
from analytic.rig import Rig
from harness.simulator import Controller, Experiment, Plant, Protocol, SimulatedRecording, perform, write_case
from harness.simulator.moves import SERVO

HERE = Path(__file__).resolve().parent
STEPS = tuple((2.0 * k, (0.22, 0.42)[k % 2]) for k in range(1, 60))
SHAKING = tuple((math.radians(0.35), w, p) for w, p in ((1.7, 0.3), (3.1, 2.0), (5.3, 4.1), (8.3, 1.1)))
EFFECTS = (
    "viscous_damping", "rolling_resistance", "level_error", "track_curvature", "track_bump", "beam_compliance",
    "rolling_radius", "angle_gain", "position_gain", "channel_delay", "linkage_backlash", "ball_imbalance",
)  # fmt: skip


def swing(frequency: float) -> tuple[tuple[float, float], ...]:
    """Targets that swing by 8 cm about the middle at this frequency [rad/s]."""
    return tuple((0.05 * k, 0.32 + 0.08 * math.sin(frequency * 0.05 * k)) for k in range(20, 800))


@dataclass(frozen=True)
class Row:
    """A recording.

    Attributes:
        name: what it is.
        targets, shaking: of the protocol.
        duration: [s].
        sensors: arguments of the experiment.
    """

    name: str
    targets: tuple[tuple[float, float], ...] = STEPS
    shaking: tuple[tuple[float, float, float], ...] = ()
    duration: float = 16.0
    sensors: dict[str, Any] = field(default_factory=dict)


MOTIONS = (
    Row("ball held at one place", ()),
    Row("one step", STEPS[:1]),
    Row("a step every 2 s"),
    Row("slow swing, 0.8 rad/s", swing(0.8)),
    Row("fast swing, 2.5 rad/s", swing(2.5)),
    Row("steps, and the beam shaken", shaking=SHAKING),
)
RECORDS = (
    Row("**steps, shaken**: 16 s, 100 Hz, 40,000 counts, 0.3 mm", shaking=SHAKING),
    Row("half as long: 8 s", shaking=SHAKING, duration=8.0),
    Row("twice as long: 32 s", shaking=SHAKING, duration=32.0),
    Row("20 Hz", shaking=SHAKING, sensors={"rate": 20.0}),
    Row("encoder of 1,000 counts", shaking=SHAKING, sensors={"counts": 1_000}),
    Row("position noise of 3 mm", shaking=SHAKING, sensors={"position_noise": 3e-3, "position_resolution": 1e-3}),
)


def shares(row: Row) -> dict[str, float]:
    """Detection limit over typical size, by effect, once what the model lacks is explained [1]."""
    experiment = Experiment(identify=1, predict=0, duration=row.duration, **row.sensors)
    protocol = Protocol(0.32, row.targets, row.duration, row.shaking)
    controller = Controller(gain=0.7, damping=0.42, filter_time=0.08, deflection_limit=math.radians(3.0))
    run, written = perform(protocol, Plant(rig=Rig()), SERVO, controller, experiment.sensors, seed=1)
    none = run.position[:0]
    with tempfile.TemporaryDirectory() as folder:
        recording = SimulatedRecording(written, none, none, none, none, none, 1)
        write_case(Path(folder) / "case", experiment, [recording])
        table = harness.check(Path(folder) / "case").effects
    distance = table["limit_explained"] / table["typical"]
    return {name: float(value) for name, value in zip(table["effect"], distance, strict=True)}


def table(rows: tuple[Row, ...], found: list[dict[str, float]]) -> str:
    """Effects down, recordings across."""
    head = "| effect | " + " | ".join(row.name for row in rows) + " |\n|" + "---|" * (len(rows) + 1) + "\n"
    return head + "".join(
        f"| `{name}` | " + " | ".join(_percent(one.get(name, math.nan)) for one in found) + " |\n" for name in EFFECTS
    )


def _percent(share: float) -> str:
    if not math.isfinite(share) or share > 10.0:
        return "–"
    text = f"{100.0 * share:.2g} %" if share < 0.1 else f"{100.0 * share:.0f} %"
    return text if share <= 1.0 else f"**{text}**"


def main() -> None:
    """Check all recordings and write the page."""
    found = {}
    for row in (*MOTIONS, *RECORDS):
        print(row.name, flush=True)
        found[row.name] = shares(row)
    template = (HERE / "recording_template.md").read_text(encoding="utf-8")
    parts = {
        "motions": table(MOTIONS, [found[row.name] for row in MOTIONS]),
        "records": table(RECORDS, [found[row.name] for row in RECORDS]),
    }
    for name, part in parts.items():
        template = template.replace(f"<!-- {name} -->\n", part)
    (HERE / "recording.md").write_text(template, encoding="utf-8")


if __name__ == "__main__":
    main()
