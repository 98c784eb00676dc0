"""What a rig file may say about the rig and its sensors; what it does not say is unknown, not assumed."""

from __future__ import annotations

from dataclasses import asdict, dataclass, fields

from analytic.rig import Rig, RigError
from harness.errors import InputError

NEEDED = ("mass", "inertia", "radius", "rolling_radius", "eccentricity", "gravity")
"""Quantities without which no model runs. The level angle is not among them: 0 says "as recorded"."""


@dataclass(frozen=True, kw_only=True)
class Sensors:
    """What is declared about the sensors; `None` is unknown.

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
    """An effect that is known to act: its name in the catalogue and its parameters, SI units."""

    name: str
    parameters: dict[str, float]


@dataclass(frozen=True, kw_only=True)
class KnownRig:
    """A rig of which parts may be unknown (`None`); quantities as in `analytic.rig.Rig`.

    Attributes:
        mass: m [kg].
        inertia: J [kg m²].
        radius: R [m].
        rolling_radius: r [m].
        eccentricity: h [m].
        gravity: g [m/s²].
        level_angle: α₀ [rad].
        length: of the beam [m].

    Raises:
        RigError: what is known cannot be true together.
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
        # Rig checks the quantities together; an unknown one must not spoil the check of the others.
        if (self.radius is None) != (self.rolling_radius is None):
            known["radius"] = known["rolling_radius"] = known.get("radius", known.get("rolling_radius", 0.0))
        Rig(**known)
        if self.length is not None and not 0.0 < self.length < float("inf"):
            raise RigError(f"length is {self.length:g}; it must be positive")
        if self.mass is not None and self.inertia is not None and self.radius is not None:
            ratio = self.inertia / (self.mass * self.radius**2)
            if ratio > 1.0:
                raise RigError(
                    f"inertia is {ratio:.3g} m R²; no body within the radius R exceeds 1 m R² (a solid ball has 0.4)"
                )

    @property
    def _known(self) -> dict[str, float]:
        return {name: value for name, value in asdict(self).items() if value is not None and name != "length"}

    @property
    def unknown(self) -> tuple[str, ...]:
        """Names of the quantities a model needs that are not known here."""
        return tuple(name for name in NEEDED if getattr(self, name) is None)

    def complete(self, **estimates: float) -> Rig:
        """A full rig: what is known here, and `estimates` for what is not; what is known wins.

        Args:
            estimates: any quantity of `Rig` by name; a level angle that is neither known nor estimated is 0.

        Raises:
            InputError: quantities are still missing, or an estimate makes a rig that cannot exist.
            TypeError: an estimate names no quantity of `Rig`.
        """
        strange = sorted(set(estimates) - {field.name for field in fields(Rig)})
        if strange:
            raise TypeError(f"no quantity of Rig: {', '.join(strange)}")
        values = {**estimates, **self._known}
        missing = [name for name in NEEDED if name not in values]
        if missing:
            raise InputError(f"the rig's {', '.join(missing)} must be known here. Write what is missing into rig.toml.")
        try:
            return Rig(**values)
        except RigError as error:
            raise InputError(f"the rig completed with estimates cannot exist: {error}.") from error


def known_rig_of(rig: Rig) -> KnownRig:
    """Everything of a full rig but the level angle, which only a measurement can know."""
    return KnownRig(**{name: getattr(rig, name) for name in NEEDED})
