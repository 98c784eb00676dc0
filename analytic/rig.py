"""The rig's quantities: names, units, bounds, and what follows from them.

Symbols and values are those of Table 1 in Gembalczyk, Domogała, Leśniowski, "Modeling of Underactuated Ball and
Beam System — A Comparative Study", Actuators 2023, 12(2), 59, doi 10.3390/act12020059 ("the paper").
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace

SOLID_SPHERE = 0.4  # J / (m R²) of a homogeneous ball
HOLLOW_SPHERE = 2.0 / 3.0  # the same of a thin shell


class RigError(ValueError):
    """A rig that cannot exist; the text names the quantity and says what would be possible."""


@dataclass(frozen=True, kw_only=True)
class Rig:
    """One ball on one beam, all quantities in SI units.

    A steel ball rolls in two-point contact on the inner top edges of a U-channel that turns about a horizontal axis
    `eccentricity` below the plane of these edges. α > 0 lowers the +s end; s is measured from the foot of the pivot
    axis. Defaults are the paper's Table 1.

    Attributes:
        mass: m, ball mass [kg].
        inertia: J, the ball's moment of inertia about its centre [kg m²].
        radius: R, ball radius [m].
        rolling_radius: r, height of the ball's centre above the edge plane [m]; 0 < r <= R.
        eccentricity: h, distance from the pivot axis up to the edge plane [m]; negative if the axis lies above it.
        gravity: g [m/s²].
        level_angle: α₀, added to the recorded angle where gravity is concerned [rad].
        friction_coefficient: f_b of eq. 15; its unit depends on the reading (see `analytic.models`).
        transition_velocity: v_t of eq. 15 [m/s].

    Raises:
        RigError: a quantity is out of its physical range.
    """

    mass: float = 0.071
    inertia: float = 4.948e-6
    radius: float = 0.0132
    rolling_radius: float = 0.0118
    eccentricity: float = 0.035
    gravity: float = 9.81
    level_angle: float = 0.0
    friction_coefficient: float = 0.0362
    transition_velocity: float = 0.008

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if not math.isfinite(value):
                raise RigError(f"{field.name} is {value}; it must be a finite number")
        for name in ("mass", "inertia", "radius", "rolling_radius", "gravity", "transition_velocity"):
            if getattr(self, name) <= 0.0:
                raise RigError(f"{name} is {getattr(self, name):g}; it must be positive")
        if self.rolling_radius > self.radius * (1 + 1e-12):
            raise RigError(
                f"rolling_radius {self.rolling_radius:g} m exceeds the ball's radius {self.radius:g} m; the centre "
                "cannot lie higher above the edges than one radius"
            )
        if abs(self.level_angle) > math.pi / 4:
            raise RigError(f"level_angle is {self.level_angle:g} rad; more than 45° is taken for a unit error")

    @property
    def inertia_ratio(self) -> float:
        """J/(m r²), the share of rotation in the ball's inertia along the beam [1]."""
        return self.inertia / (self.mass * self.rolling_radius**2)

    @property
    def rolling_ratio(self) -> float:
        """K = 1/(1 + J/(m r²)): acceleration of the rolling ball over that of a sliding one [1]."""
        return 1.0 / (1.0 + self.inertia_ratio)

    @property
    def lever(self) -> float:
        """h + r + J/(m r): what α̈ acts on in eq. 14 after division by m [m]."""
        return self.eccentricity + self.rolling_radius + self.inertia / (self.mass * self.rolling_radius)

    @property
    def half_gap(self) -> float:
        """w/2 = √(R² − r²): half the clear width between the two edges [m]."""
        return math.sqrt(max(self.radius**2 - self.rolling_radius**2, 0.0))

    @property
    def contact_angle(self) -> float:
        """Lean of the contact normals from the vertical, asin(w/2 / R) [rad]."""
        return math.asin(self.half_gap / self.radius)

    def with_(self, **changes: float) -> Rig:
        """The same rig with some quantities changed (names as in the attributes)."""
        return replace(self, **changes)
