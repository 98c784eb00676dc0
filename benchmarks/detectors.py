"""`python -m benchmarks.detectors`: how often the checks of a recording raise a false alarm, and what they notice.

Writes the section "Detectors" of `docs/reliability.md`. Clean recordings are those of the blind trials, with and
without effects and with imperfections of real rigs, and the measured ones of the folders that are given. Faults are put
into them at a random place; every recording goes the way of anybody's, through a CSV file.
"""

from __future__ import annotations

import tempfile
import zlib
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import click
import numpy as np
from scipy.stats import binomtest

from analytic.motion import FloatArray
from benchmarks.calibration.pose import experiment_of
from benchmarks.calibration.trials import RIG, plan
from benchmarks.sections import put
from harness.errors import InputError
from harness.recording import KnownRig, Sensors, load_case, load_recording
from harness.recording.known_rig import known_rig_of

DOCS = Path("docs/reliability.md")
FAULTY = 120
"""Simulated recordings that each fault is put into."""

# What cannot be a false alarm: it says what is there, or what the rig file has not.
DETECTORS = (
    *("stuck-position", "zeros", "clipped", "jump", "lost-rows", "stuck-angle", "end-stop", "push"),
    *("position-noise", "angle-noise", "rate", "angle-sign", "swapped-columns"),
    *("angle-unit", "position-unit", "time-unit", "units"),
)


@dataclass(frozen=True)
class Sample:
    """A recording with what is known of its rig; arrays of shape (n,)."""

    source: str
    time: FloatArray
    angle: FloatArray
    position: FloatArray
    rig: KnownRig
    sensors: Sensors

    def part(self, seconds: float, generator: np.random.Generator) -> slice:
        """A stretch of this length at a random place, away from the ends."""
        length = round(seconds / float(np.median(np.diff(self.time))))
        first = int(generator.uniform(0.2, 0.75) * (len(self.time) - length))
        return slice(first, first + length)


Change = Callable[[Sample, np.random.Generator], Sample]


def simulated(trials: int) -> Iterator[Sample]:
    """Recordings of as many blind trials with the virtual rig, of every study in turn."""
    planned = [one for one in plan(("null", "confusion", "imperfect"), seeds=2, count=60) if one.plant == RIG]
    order = np.random.default_rng(1).permutation(len(planned))
    for trial in [planned[i] for i in order[:trials]]:
        experiment = experiment_of(trial)
        sensors = Sensors(
            angle_resolution=2.0 * np.pi / experiment.counts,
            position_noise=experiment.position_noise,
            position_resolution=experiment.position_resolution,
        )
        try:
            every = experiment.recordings(None)
        except InputError:  # the ball leaves the beam whatever the moves: a trial without an outcome
            continue
        kind = "simulated, imperfect" if trial.imperfection else "simulated"
        for one in every:
            made = one.record
            yield Sample(kind, made.time, made.angle, made.position, known_rig_of(experiment.rig), sensors)


def measured(folders: Sequence[Path]) -> Iterator[Sample]:
    """All recordings with positions of the cases in these folders."""
    for folder in folders:
        for path in sorted(one for one in folder.iterdir() if (one / "rig.toml").exists()):
            case = load_case(path)
            for name in case.identify:
                one = case.recordings[name]
                yield Sample(f"{folder.name}/{path.name}", one.time, one.angle, one.position, case.rig, case.sensors)


def codes(sample: Sample, folder: Path) -> set[str]:
    """Codes of what is found in a recording."""
    file = folder / "rec.csv"
    table = np.column_stack((sample.time, sample.angle, sample.position))
    np.savetxt(file, table, fmt="%.9g", delimiter=",", header="time_s,beam_angle_rad,ball_position_m", comments="")
    return {one.code for one in load_recording(file, rig=sample.rig, sensors=sample.sensors).findings}


def _value(channel: str, seconds: float, value: float | None) -> Change:
    def change(one: Sample, generator: np.random.Generator) -> Sample:
        part, values = one.part(seconds, generator), getattr(one, channel).copy()
        known = values[part.start - 1 :][np.isfinite(values[part.start - 1 :])]
        values[part] = known[0] if value is None else value
        return replace(one, **{channel: values})

    return change


def _jump(size: float, seconds: float | None) -> Change:
    def change(one: Sample, generator: np.random.Generator) -> Sample:
        part, position = one.part(seconds or 0.0, generator), one.position.copy()
        position[part.start : part.stop if seconds else None] += size * generator.choice((-1.0, 1.0))
        return replace(one, position=position)

    return change


def _clip(share: float) -> Change:
    def change(one: Sample, generator: np.random.Generator) -> Sample:
        position = one.position
        if generator.uniform() < 0.5:
            return replace(one, position=np.minimum(position, np.nanquantile(position, 1.0 - share)))
        return replace(one, position=np.maximum(position, np.nanquantile(position, share)))

    return change


def _lose(seconds: float) -> Change:
    def change(one: Sample, generator: np.random.Generator) -> Sample:
        part = one.part(seconds, generator)
        angle, position = np.delete(one.angle, part), np.delete(one.position, part)
        return replace(one, time=one.time[: len(angle)], angle=angle, position=position)

    return change


def _stops(share: float) -> Change:
    def change(one: Sample, generator: np.random.Generator) -> Sample:
        """The ball anew, under the same angle, between stops within which it was for this share of the readings."""
        low, high = np.nanquantile(one.position, (0.5 - 0.5 * share, 0.5 + 0.5 * share))
        speed, s = 0.0, float(np.clip(one.position[np.isfinite(one.position)][0], low, high))
        path = np.empty_like(one.time)
        for i, step in enumerate(np.diff(one.time, prepend=one.time[0])):
            speed += 0.6 * 9.81 * float(one.angle[i]) * step  # K g α, K of some rolling ball
            s += speed * step
            path[i] = s = float(np.clip(s, low, high))
            if (s == low and speed < 0.0) or (s == high and speed > 0.0):
                speed *= -0.3 if abs(speed) > 0.02 else 0.0
        noisy = path + generator.normal(0.0, one.sensors.position_noise or 3e-4, len(path))
        resolution = one.sensors.position_resolution
        return replace(one, position=np.round(noisy / resolution) * resolution if resolution else noisy)

    return change


def _push(size: float) -> Change:
    def change(one: Sample, generator: np.random.Generator) -> Sample:
        """The ball's velocity changes at once, and the change dies away within half a second or so."""
        since = np.maximum(one.time - one.time[one.part(0.0, generator).start], 0.0)
        moved = 0.5 * (1.0 - np.exp(-since / 0.5))
        return replace(one, position=one.position + size * generator.choice((-1.0, 1.0)) * moved)

    return change


def _declare(factor: float | None, value: float = 0.0) -> Change:
    def change(one: Sample, _: np.random.Generator) -> Sample:
        noise = value if factor is None else factor * (one.sensors.position_noise or 0.0)
        return replace(one, sensors=replace(one.sensors, position_noise=noise or None))

    return change


FAULTS: Mapping[str, tuple[Change, frozenset[str]]] = {
    "position 0 for 0.3 s": (_value("position", 0.3, 0.0), frozenset({"zeros", "jump"})),
    "position 0 for 0.6 s": (_value("position", 0.6, 0.0), frozenset({"zeros"})),
    "position stuck 0.6 s": (_value("position", 0.6, None), frozenset({"stuck-position", "clipped"})),
    "position stuck 1.2 s": (_value("position", 1.2, None), frozenset({"stuck-position", "clipped"})),
    "position stuck 2.4 s": (_value("position", 2.4, None), frozenset({"stuck-position", "clipped"})),
    "angle stuck 1.2 s": (_value("angle", 1.2, None), frozenset({"stuck-angle"})),
    "angle stuck 2.4 s": (_value("angle", 2.4, None), frozenset({"stuck-angle"})),
    "jump of 25 mm, lasting": (_jump(0.025, None), frozenset({"jump"})),
    "jump of 50 mm, lasting": (_jump(0.05, None), frozenset({"jump"})),
    "jump of 50 mm for 2 s": (_jump(0.05, 2.0), frozenset({"jump"})),
    "jump of 100 mm, lasting": (_jump(0.1, None), frozenset({"jump"})),
    "clipped, 10 % of the readings": (_clip(0.1), frozenset({"clipped"})),
    "clipped, 25 % of the readings": (_clip(0.25), frozenset({"clipped"})),
    "end stops at the inner 80 % of the readings": (_stops(0.8), frozenset({"end-stop"})),
    "push by 0.2 m/s": (_push(0.2), frozenset({"push"})),
    "push by 0.4 m/s": (_push(0.4), frozenset({"push", "end-stop"})),
    "0.5 s of rows lost, renumbered": (_lose(0.5), frozenset({"lost-rows", "jump"})),
    "1 s of rows lost, renumbered": (_lose(1.0), frozenset({"lost-rows", "jump"})),
    "rate × 1.2": (lambda one, _: replace(one, time=one.time / 1.2), frozenset({"rate"})),
    "rate ÷ 1.2": (lambda one, _: replace(one, time=one.time * 1.2), frozenset({"rate"})),
    "declared noise × 10": (_declare(10.0), frozenset({"position-noise"})),
    "declared noise ÷ 10": (_declare(0.1), frozenset({"position-noise"})),
    "declared noise 1000 m": (_declare(None, 1000.0), frozenset({"position-noise"})),
    "sign of the angle": (lambda one, _: replace(one, angle=-one.angle), frozenset({"angle-sign"})),
    "angle and position exchanged": (
        lambda one, _: replace(one, angle=np.nan_to_num(one.position), position=one.angle),
        frozenset({"swapped-columns"}),
    ),
    "angle in degrees": (lambda one, _: replace(one, angle=np.degrees(one.angle)), frozenset({"angle-unit"})),
    "position in mm": (lambda one, _: replace(one, position=1e3 * one.position), frozenset({"position-unit"})),
    "time in ms": (lambda one, _: replace(one, time=1e3 * one.time), frozenset({"time-unit"})),
}
"""By name: what is done to a recording, and which codes notice it."""


def noticed(name: str, samples: Sequence[Sample], folder: Path) -> tuple[int, int]:
    """Recordings in which a fault is noticed, of how many it can be put into."""
    change, expected = FAULTS[name]
    found = tried = 0
    for number, one in enumerate(samples):
        if "noise" in name and one.sensors.position_noise is None:
            continue
        generator = np.random.default_rng((zlib.crc32(name.encode()), number))
        tried += 1
        found += bool(expected & codes(change(one, generator), folder))
    return found, tried


def false_alarms(samples: Sequence[Sample], folder: Path) -> list[str]:
    """A row of the table for each source: recordings, those with an alarm, the bound of their share, the codes."""
    alarms: dict[str, list[set[str]]] = {}
    for one in samples:
        alarms.setdefault(one.source, []).append(codes(one, folder) & set(DETECTORS))
    rows = []
    groups = alarms | {"all": [one for each in alarms.values() for one in each]}
    for name, each in groups.items():
        count = sum(map(bool, each))
        high = binomtest(count, len(each)).proportion_ci(0.9).high
        which = Counter(code for one in each for code in one)
        said = ", ".join(f"`{code}` {number}" for code, number in sorted(which.items())) or "–"
        rows.append(f"| {name} | {len(each)} | {count} | {high:.2%} | {said} |")
    return rows


def section(false: Sequence[str], power: Sequence[str]) -> str:
    """The section of `docs/reliability.md`."""
    return _TEXT.format(false="\n".join(false), power="\n".join(power))


@click.command()
@click.option("--trials", default=280, show_default=True, help="Blind trials whose recordings are the clean ones.")
@click.option(
    "--recordings",
    "folders",
    multiple=True,
    type=click.Path(path_type=Path, exists=True, file_okay=False),
    help="Folder of cases that were measured, or are otherwise known to be sound; repeatable.",
)
@click.option("--out", type=click.Path(path_type=Path), default=DOCS, show_default=True, help="Page to write into.")
def main(trials: int, folders: Sequence[Path], out: Path) -> None:
    """Measure false alarms and power of the detectors, and write the tables."""
    virtual, real = list(simulated(trials)), list(measured(folders))
    ordinary = [one for one in virtual if one.source == "simulated"][:FAULTY]
    with tempfile.TemporaryDirectory(prefix="detectors-") as name:
        folder = Path(name)
        false = false_alarms([*virtual, *real], folder)
        power = []
        for fault in FAULTS:
            cells = [_share(*noticed(fault, samples, folder)) for samples in (ordinary, real)]
            power.append(f"| {fault} | {' | '.join(cells)} |")
            click.echo(power[-1], err=True)
    page = out.read_text(encoding="utf-8") if out.exists() else ""
    out.write_text(put("detectors", section(false, power), page, title="Reliability"), encoding="utf-8")


def _share(found: int, tried: int) -> str:
    return f"{found / tried:.0%} of {tried}" if tried else "–"


_TEXT = """\
## Detectors

Made by `python -m benchmarks.detectors`. What each of them looks at, with its threshold, is in the head of its module
in `harness/recording/` (`frozen`, `jumps`, `stuck_angle`, `end_stops`, `pushes`, `noise`, `rate`, `plausibility`).

**False alarms** on clean recordings: of the blind trials of the [calibration](calibration.md), with and without effects
of the catalogue and unlisted ones, with imperfections of real rigs (lags, drop-outs, spikes, worn tracks, uneven
stamps, coloured noise, commanded angles), and on measured ones. The bound is that of the share's one-sided 95 %
interval.

| recordings of | recordings | with an alarm | share below | codes |
|---|---|---|---|---|
{false}

**Power**: recordings in which a fault of this size, at a random place, is noticed by its name. A place where the ball
rests hides most faults. Of the measured recordings 25 are of 8 s at 19 Hz and ten have a noise of 8 mm, where jumps of
centimetres are within what ball and sensor do; most of them record a command, which may rest and step, so that a stuck
angle cannot be told; and of none is the rolling radius known, without which no rate can be.

| fault | simulated | measured |
|---|---|---|
{power}

**Not detectable** in a recording alone, and therefore not looked for:

- *Both axes flipped*, s → −s and α → −α: the equations stay the same.
- *Another origin of the position*: s enters the motion through s α̇² only; 10 cm change the acceleration by 1 mm/s² at
  0.1 rad/s. `length_m` in `rig.toml` bounds where the ball can be, and positions beyond it are named.
- *A rate, or a gain of a sensor*, where the rolling radius is not known; where it is known, the two look alike.
- *A sensor stuck while the ball rests*, or up to the end of the recording while the angle is concerned.
"""


if __name__ == "__main__":
    main()
