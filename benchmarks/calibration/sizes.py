"""How large each effect is in a trial: a middle size that matters on the paper's rig, and what grows with the size."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

import numpy as np

from analytic.effects import (
    ANGLE_GAIN,
    ANGLE_HOLD,
    ANGLE_LAG,
    ANGLE_NONLINEARITY,
    ANGLE_SERVO,
    BALL_IMBALANCE,
    BEAM_COMPLIANCE,
    CATALOGUE,
    CHANNEL_DELAY,
    CONTACT_SLIP,
    DIRECTIONAL_RESISTANCE,
    ECCENTRIC_PIVOT,
    LEVEL_DRIFT,
    LEVEL_ERROR,
    LEVEL_PER_RECORDING,
    LINKAGE_BACKLASH,
    POSITION_GAIN,
    POSITION_LAG,
    POSITION_NONLINEARITY,
    PRESLIDING_HYSTERESIS,
    QUADRATIC_DRAG,
    ROLLING_RADIUS,
    ROLLING_RESISTANCE,
    STRIBECK_FRICTION,
    TRACK_BUMP,
    TRACK_CURVATURE,
    VISCOUS_DAMPING,
    Effect,
)
from analytic.rig import Rig

SIZES = {"small": 0.3, "middle": 1.0, "large": 2.0}
"""Named sizes, as factors of the middle one."""
SPREAD = 0.2  # a size is drawn within ± this share

Interval = tuple[float, float]


@dataclass(frozen=True, kw_only=True)
class Scale:
    """How one effect is drawn.

    Attributes:
        middle: value at the middle size of every parameter that grows with it (SI).
        fixed: between which values the other parameters are drawn, whatever the size (SI).
        neutral: value of the growing parameters at which nothing acts (SI).
        signed: whether either sign can be.
        engines: whether the engines' scenes can show it; the virtual rig can show all.
    """

    middle: Mapping[str, float]
    fixed: Mapping[str, Interval] = field(default_factory=dict)
    neutral: float = 0.0
    signed: bool = False
    engines: bool = True

    def drawn(self, factor: float, generator: np.random.Generator) -> dict[str, float]:
        """Values at `factor` times the middle size, within ± `SPREAD`, with a random sign where it has one."""
        factor *= float(generator.uniform(1.0 - SPREAD, 1.0 + SPREAD))
        if self.signed and generator.integers(2):
            factor = -factor
        values = {name: self.at(factor, name) for name in self.middle}
        values |= {name: float(generator.uniform(*interval)) for name, interval in self.fixed.items()}
        return {name: float(f"{value:.6g}") for name, value in values.items()}

    def at(self, factor: float, name: str) -> float:
        """Value of a growing parameter at `factor` times the middle size."""
        return self.neutral + factor * (self.middle[name] - self.neutral)


_AMID: Interval = (0.28, 0.38)  # where the ball passes most often in the moves of `harness.simulator.moves` [m]

_OWN: Mapping[str, Scale] = {
    VISCOUS_DAMPING.name: Scale(middle={"coefficient": 0.03}),
    QUADRATIC_DRAG.name: Scale(middle={"coefficient": 0.2}),
    ROLLING_RESISTANCE.name: Scale(middle={"coefficient": 0.004}),
    DIRECTIONAL_RESISTANCE.name: Scale(middle={"coefficient_plus": 0.002, "coefficient_minus": 0.005}),
    STRIBECK_FRICTION.name: Scale(
        middle={"static_coefficient": 0.006, "kinetic_coefficient": 0.003}, fixed={"stribeck_velocity": (0.015, 0.03)}
    ),
    PRESLIDING_HYSTERESIS.name: Scale(middle={"coefficient": 0.004}, fixed={"stiffness": (15.0, 50.0)}),
    LEVEL_ERROR.name: Scale(middle={"angle": 0.005}, signed=True),
    LEVEL_PER_RECORDING.name: Scale(middle={"spread": 0.003}),
    LEVEL_DRIFT.name: Scale(middle={"rate": 5e-4}, signed=True),
    TRACK_CURVATURE.name: Scale(middle={"curvature": 0.06}, fixed={"centre": _AMID}, signed=True),
    TRACK_BUMP.name: Scale(middle={"height": 2e-4}, fixed={"centre": _AMID, "width": (0.015, 0.025)}, signed=True),
    BEAM_COMPLIANCE.name: Scale(middle={"compliance": 0.02}),
    BALL_IMBALANCE.name: Scale(middle={"offset": 5e-5}),
    # smaller only: a ball cannot roll on more than its radius
    ROLLING_RADIUS.name: Scale(middle={"radius": 0.0105}, neutral=Rig().rolling_radius),
    # In these moves the ball keeps its grip from about μ = 0.019 on. An engine's ball cannot be made to slide by a
    # force along the beam.
    CONTACT_SLIP.name: Scale(middle={"friction_coefficient": 0.012}, neutral=0.019, engines=False),
    ECCENTRIC_PIVOT.name: Scale(middle={"eccentricity": Rig().eccentricity}),
    ANGLE_GAIN.name: Scale(middle={"gain": 1.05}, neutral=1.0, signed=True),
    # the jolt of a gap that closes throws the ball off an engine's edges
    LINKAGE_BACKLASH.name: Scale(middle={"width": 0.0087}, engines=False),
    ANGLE_NONLINEARITY.name: Scale(middle={"square": 0.4, "cube": 4.0}),
    ANGLE_HOLD.name: Scale(middle={"interval": 0.12}),
    ANGLE_LAG.name: Scale(middle={"time_constant": 0.08}),
    ANGLE_SERVO.name: Scale(middle={"lag": 0.08}, fixed={"damping": (0.5, 0.9)}),
    CHANNEL_DELAY.name: Scale(middle={"delay": 0.05}, signed=True),
    POSITION_GAIN.name: Scale(middle={"gain": 1.04}, neutral=1.0, signed=True),
    POSITION_NONLINEARITY.name: Scale(middle={"square": 0.15, "cube": -0.1}, signed=True),
    POSITION_LAG.name: Scale(middle={"time_constant": 0.04}),
}


def usual(effect: Effect) -> Scale:
    """About the typical size: parameters with which the effect vanishes grow, the others stay."""
    first, *_ = effect.parameters
    growing = effect.strengths or {first.name}
    neutral = first.neutral(Rig()) if callable(first.neutral) else first.neutral
    return Scale(
        middle={one.name: one.typical for one in effect.parameters if one.name in growing},
        fixed={one.name: (one.typical, one.typical) for one in effect.parameters if one.name not in growing},
        neutral=neutral,
    )


class _Scales(Mapping[str, Scale]):
    """The scale of every effect of the catalogue, in its order; the usual one where it has none of its own."""

    def __getitem__(self, name: str) -> Scale:
        return _OWN.get(name) or usual(CATALOGUE[name])

    def __iter__(self) -> Iterator[str]:
        return iter(CATALOGUE)

    def __len__(self) -> int:
        return len(CATALOGUE)


SCALES = _Scales()

UNLISTED_SCALES: Mapping[str, Scale] = {
    "gust": Scale(middle={"force": 0.008}, fixed={"start": (3.0, 6.0), "end": (8.0, 13.0)}, signed=True),
    "settling_force": Scale(middle={"force": 0.008}, fixed={"time_constant": (2.0, 3.0)}, signed=True),
    "fading_resistance": Scale(middle={"coefficient": 0.006}, fixed={"time_constant": (4.0, 6.0)}),
    "rough_patch": Scale(middle={"coefficient": 0.01}, fixed={"start": (0.28, 0.31), "end": (0.33, 0.36)}),
    "force_hill": Scale(middle={"force": 0.01}, fixed={"start": (0.27, 0.30), "end": (0.34, 0.37)}, signed=True),
    "ripple_force": Scale(middle={"force": 0.01}, fixed={"wavelength": (0.03, 0.1)}, signed=True),
    "magnet": Scale(middle={"force": 0.01}, fixed={"centre": _AMID, "distance": (0.04, 0.06)}, signed=True),
    "cubic_spring": Scale(middle={"stiffness": 10.0}, fixed={"centre": _AMID}),
    "cubic_drag": Scale(middle={"coefficient": 0.8}),
    "cable_pull": Scale(middle={"force": 0.008}, fixed={"frequency": (50.0, 70.0)}, signed=True),
    "sticky_spot": Scale(middle={"coefficient": 0.015}, fixed={"width": (0.25, 0.35)}),
    "out_of_round": Scale(middle={"torque": 5e-5}, signed=True),
}
"""Every structure that no catalogue has."""

PAIRS = tuple(
    (one.name, other.name)
    for one, other in (
        (ROLLING_RESISTANCE, LEVEL_ERROR),
        (VISCOUS_DAMPING, LEVEL_ERROR),
        (ROLLING_RESISTANCE, CHANNEL_DELAY),
        (TRACK_CURVATURE, VISCOUS_DAMPING),
        (ANGLE_GAIN, LEVEL_ERROR),
        (LINKAGE_BACKLASH, ROLLING_RESISTANCE),
    )
)
"""Effects that act together."""

POWER = tuple(
    effect.name
    for effect in (
        ROLLING_RESISTANCE,
        VISCOUS_DAMPING,
        LEVEL_ERROR,
        TRACK_CURVATURE,
        ROLLING_RADIUS,
        ANGLE_GAIN,
        LINKAGE_BACKLASH,
        CHANNEL_DELAY,
        POSITION_GAIN,
        POSITION_LAG,
    )
)
"""Effects whose detection is followed down to sizes that may go unseen."""
POWER_ERRORS = (4.0, 6.0)
"""Their sizes there, in standard errors."""
