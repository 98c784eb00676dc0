"""The quantities of rig and sensors that the rig file gives; all others are unknown (`None`)."""

from __future__ import annotations

from dataclasses import asdict, dataclass, fields

from analytic.rig import Rig, RigError
from harness.errors import InputError

NEEDED = ("mass", "inertia", "radius", "rolling_radius", "eccentricity", "gravity")
"""Quantities every model needs. The level angle is not required: it defaults to 0."""
UNITS = {
    "mass": "kg",
    "inertia": "kg m²",
    "radius": "m",
    "rolling_radius": "m",
    "eccentricity": "m",
    "gravity": "m/s²",
    "level_angle": "rad",
    "length": "m",
    "angle_resolution": "rad",
    "angle_noise": "rad",
    "position_noise": "m",
    "position_resolution": "m",
}
"""Of the quantities of rig and sensors."""


@dataclass(frozen=True, kw_only=True)
class Sensors:
    """Declared sensor properties; `None` is unknown.

    Attributes:
        angle_resolution: step of the angle [rad].
        angle_noise: standard deviation of the angle's noise [rad].
        position_noise: standard deviation of the position's noise [m].
        position_resolution: step of the position [m].
    """

    angle_resolution: float | None = None
    angle_noise: float | None = None
    position_noise: float | None = None
    position_resolution: float | None = None


@dataclass(frozen=True)
class Declared:
    """A declared effect, known to be present: its name in the catalogue and its parameters in SI units."""

    name: str
    parameters: dict[str, float]


@dataclass(frozen=True, kw_only=True)
class KnownRig:
    """A partly known rig; an unknown quantity is `None`. Quantities as in `analytic.rig.Rig`.

    Attributes:
        mass: m [kg].
        inertia: J [kg m²].
        radius: R [m].
        rolling_radius: r [m].
        eccentricity: h [m].
        gravity: g [m/s²].
        level_angle: α₀ [rad].
        length: beam length [m].

    Raises:
        RigError: the known quantities contradict each other.
    """

    mass: float | None = None
    inertia: float | None = None
    radius: float | None = None
    rolling_radius: float | None = None
    eccentricity: float | None = None
    gravity: float | None = None
    level_angle: float | None = None
    length: float | None = None

    def __post_init__(self) -> None:
        known = self._known
        # Rig checks R and r together; if one is unknown it is set equal to the other so that the rest is still checked.
        if (self.radius is None) != (self.rolling_radius is None):
            known["radius"] = known["rolling_radius"] = known.get("radius", known.get("rolling_radius", 0.0))
        Rig(**known)
        if self.length is not None and not 0.0 < self.length < float("inf"):
            raise RigError(f"length is {self.length:g}; it must be positive")
        if self.mass is not None and self.inertia is not None and self.radius is not None:
            ratio = self.inertia / (self.mass * self.radius**2)
            if ratio > 1.0:
                raise RigError(
                    f"inertia is {ratio:.3g} m R²; no body of radius R exceeds 1 m R² (a solid ball has 0.4)"
                )

    @property
    def _known(self) -> dict[str, float]:
        return {name: value for name, value in asdict(self).items() if value is not None and name != "length"}

    @property
    def unknown(self) -> tuple[str, ...]:
        """Names of the required quantities that are unknown."""
        return tuple(name for name in NEEDED if getattr(self, name) is None)

    def complete(self, **estimates: float) -> Rig:
        """A complete rig from the known quantities and, for the unknown ones, `estimates`.

        Args:
            estimates: quantities of `Rig` by name; ignored where the quantity is known. An unknown level angle is 0.

        Raises:
            InputError: quantities are still missing, or the completed rig is physically impossible.
            TypeError: an estimate is not a quantity of `Rig`.
        """
        unexpected = sorted(set(estimates) - {field.name for field in fields(Rig)})
        if unexpected:
            raise TypeError(f"not a quantity of Rig: {', '.join(unexpected)}")
        values = {**estimates, **self._known}
        missing = [name for name in NEEDED if name not in values]
        if missing:
            raise InputError(f"the rig's {', '.join(missing)} must be known here. Add what is missing to rig.toml.")
        try:
            return Rig(**values)
        except RigError as error:
            raise InputError(f"the rig completed with estimates is impossible: {error}.") from error


def known_rig_of(rig: Rig) -> KnownRig:
    """All quantities of a complete rig except the level angle, which has to be measured."""
    return KnownRig(**{name: getattr(rig, name) for name in NEEDED})
