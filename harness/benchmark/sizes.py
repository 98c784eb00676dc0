"""How large each effect is in a trial: a middle size that matters on the paper's rig, and what grows with the size."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

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
    """

    middle: Mapping[str, float]
    fixed: Mapping[str, Interval] = field(default_factory=dict)
    neutral: float = 0.0
    signed: bool = False

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

SCALES: Mapping[str, Scale] = {
    "viscous_damping": Scale(middle={"coefficient": 0.03}),
    "quadratic_drag": Scale(middle={"coefficient": 0.2}),
    "rolling_resistance": Scale(middle={"coefficient": 0.004}),
    "directional_resistance": Scale(middle={"coefficient_plus": 0.002, "coefficient_minus": 0.005}),
    "stribeck_friction": Scale(
        middle={"static_coefficient": 0.006, "kinetic_coefficient": 0.003}, fixed={"stribeck_velocity": (0.015, 0.03)}
    ),
    "presliding_hysteresis": Scale(middle={"coefficient": 0.004}, fixed={"stiffness": (15.0, 50.0)}),
    "level_error": Scale(middle={"angle": 0.005}, signed=True),
    "track_curvature": Scale(middle={"curvature": 0.06}, fixed={"centre": _AMID}, signed=True),
    "track_bump": Scale(middle={"height": 2e-4}, fixed={"centre": _AMID, "width": (0.015, 0.025)}, signed=True),
    "beam_compliance": Scale(middle={"compliance": 0.02}),
    "ball_imbalance": Scale(middle={"offset": 5e-5}),
    # smaller only: the ball cannot roll on more than its own radius
    "rolling_radius": Scale(middle={"radius": 0.0105}, neutral=Rig().rolling_radius),
    # in the virtual rig's moves the ball keeps its grip from about μ = 0.019 on
    "contact_slip": Scale(middle={"friction_coefficient": 0.012}, neutral=0.019),
    "eccentric_pivot": Scale(middle={"eccentricity": Rig().eccentricity}),
    "angle_gain": Scale(middle={"gain": 1.05}, neutral=1.0, signed=True),
    "linkage_backlash": Scale(middle={"width": 0.0087}),
    "channel_delay": Scale(middle={"delay": 0.05}, signed=True),
    "position_gain": Scale(middle={"gain": 1.04}, neutral=1.0, signed=True),
    "position_lag": Scale(middle={"time_constant": 0.04}),
}
"""Every effect of the catalogue."""

UNLISTED_SCALES: Mapping[str, Scale] = {
    "gust": Scale(middle={"force": 0.008}, fixed={"start": (3.0, 6.0), "end": (8.0, 13.0)}, signed=True),
    "drifting_force": Scale(middle={"rate": 0.0006}, signed=True),
    "fading_resistance": Scale(middle={"coefficient": 0.006}, fixed={"time_constant": (4.0, 6.0)}),
    "rough_patch": Scale(middle={"coefficient": 0.01}, fixed={"start": (0.28, 0.31), "end": (0.33, 0.36)}),
    "force_hill": Scale(middle={"force": 0.01}, fixed={"start": (0.27, 0.30), "end": (0.34, 0.37)}, signed=True),
    "magnet": Scale(middle={"force": 0.01}, fixed={"centre": _AMID, "distance": (0.04, 0.06)}, signed=True),
    "cubic_spring": Scale(middle={"stiffness": 10.0}, fixed={"centre": _AMID}),
    "cubic_drag": Scale(middle={"coefficient": 0.8}),
    "cable_pull": Scale(middle={"force": 0.008}, fixed={"frequency": (50.0, 70.0)}, signed=True),
    "sticky_spot": Scale(middle={"coefficient": 0.015}, fixed={"width": (0.25, 0.35)}),
    "out_of_round": Scale(middle={"torque": 5e-5}, signed=True),
}
"""Every structure that no catalogue has."""

PAIRS = (
    ("rolling_resistance", "level_error"),
    ("viscous_damping", "level_error"),
    ("rolling_resistance", "channel_delay"),
    ("track_curvature", "viscous_damping"),
    ("angle_gain", "level_error"),
    ("linkage_backlash", "rolling_resistance"),
)
"""Effects that act together."""

POWER = (
    "rolling_resistance", "viscous_damping", "level_error", "track_curvature", "rolling_radius", "angle_gain",
    "linkage_backlash", "channel_delay", "position_gain", "position_lag",
)  # fmt: skip
"""Effects whose detection is followed down to sizes that go unseen."""
POWER_FACTORS = (0.01, 0.03, 0.1)
