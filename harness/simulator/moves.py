"""Random moves that show what acts: a quiet start, then steps, sweeps, shaking and rest in random order."""

from __future__ import annotations

import math

import numpy as np

from harness.simulator.protocol import Controller, Protocol
from harness.simulator.servo import Servo

NEAR, FAR = 0.20, 0.45  # between these the targets lie [m]; the ball overshoots by some centimetres
QUIET = 2.0  # s
SERVO = Servo(natural_frequency=14.0, damping=1.0, rate_limit=0.3, acceleration_limit=4.0)
DEFLECTION = math.radians(3.0)
SHAKING = math.radians(0.5)  # amplitude of the sum of sines, about, at strength 1

Places = list[tuple[float, float]]


def random_start(generator: np.random.Generator) -> float:
    """Where a ball may be put down [m]."""
    return round(float(generator.uniform(NEAR, FAR)), 3)


def random_controller(generator: np.random.Generator, deflection: float = DEFLECTION) -> Controller:
    """A controller of a student's tuning: some haste, some overshoot; the beam turns by `deflection` [rad] at most."""
    return Controller(
        gain=float(generator.uniform(0.60, 0.90)),
        damping=float(generator.uniform(0.36, 0.48)),
        filter_time=0.08,
        deflection_limit=deflection,
    )


def random_protocol(generator: np.random.Generator, start: float, duration: float) -> Protocol:
    """A protocol of this `duration` [s] for a ball that starts at `start` [m]."""
    targets: Places = []
    strength = [(0.0, 0.0), (0.3, 1.0)]
    time, here = min(QUIET, 0.25 * duration) * float(generator.uniform(0.7, 1.2)), start
    strength.append((time, 1.0))
    while time < duration:
        kind = str(generator.choice(("steps", "steps", "sweep", "shake", "rest")))
        end = time + float(generator.uniform(2.5, 6.0) if kind in ("steps", "sweep") else generator.uniform(1.5, 3.0))
        made, factor = _stretch(generator, kind, time, end, here)
        targets += made
        here = made[-1][1] if made else here
        strength += [(time + 0.3, factor), (end, factor)]
        time = end
    frequencies = np.exp(generator.uniform(math.log(1.5), math.log(9.0), 4)).tolist()
    phases = generator.uniform(0.0, 2.0 * math.pi, 4).tolist()
    shaking = tuple((SHAKING * math.sqrt(0.5), w, p) for w, p in zip(frequencies, phases, strict=True))
    return Protocol(start, tuple(targets), duration, shaking, tuple(strength))


def _stretch(generator: np.random.Generator, kind: str, begin: float, end: float, here: float) -> tuple[Places, float]:
    """Targets of one stretch, and how strong the shaking is in it."""
    places: Places = []
    if kind == "steps":
        time, place = begin, here
        while time < end:
            place = _elsewhere(generator, place)
            places.append((time, place))
            time += float(generator.uniform(1.2, 2.4))
        return places, 1.0
    if kind == "sweep":
        middle, width = float(generator.uniform(0.29, 0.36)), float(generator.uniform(0.06, 0.10))
        slow, fast = sorted(generator.uniform(0.8, 2.8, 2).tolist())
        sense = 1.0 if here < middle else -1.0
        for time in np.arange(begin, end, 0.05).tolist():
            since = time - begin
            turned = (slow + 0.5 * (fast - slow) * since / (end - begin)) * since
            places.append((time, middle + sense * width * math.sin(turned)))
        return places, 0.5
    return [], 2.0 if kind == "shake" else 0.1


def _elsewhere(generator: np.random.Generator, here: float) -> float:
    """A place at least 7 cm from `here`."""
    while True:
        place = float(generator.uniform(NEAR + 0.01, FAR - 0.01))
        if abs(place - here) > 0.07:
            return round(place, 3)
