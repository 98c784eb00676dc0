"""MuJoCo's settings: names, units, defaults and bounds, and the MJCF attributes they become."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, model_validator

from analytic.rig import Rig
from harness.engines.protocol import EngineParameters
from mjcf.scene import (
    ACROSS,
    DAMPING_RATIO,
    FRICTION,
    IMPEDANCE,
    RELAXATION,
    Attribute,
    aligned,
    friction_reference,
    impratio_of,
)

MIN_FRICTION = 1e-5  # MuJoCo raises smaller coefficients to this (mjMINMU)
MIN_IMPEDANCE, MAX_IMPEDANCE = 1e-4, 0.9999  # and keeps impedances within these (mjMINIMP, mjMAXIMP)


class MuJoCoParameters(EngineParameters):
    """Settings of MuJoCo under its own names. What MuJoCo would clamp or ignore without a word is refused."""

    friction: float = Field(
        FRICTION, ge=MIN_FRICTION, le=10.0, description="friction coefficient of ball and rail along the beam [1]"
    )
    friction_across: float | None = Field(
        None,
        ge=MIN_FRICTION,
        le=10.0,
        description="the same across the beam [1]; none: small enough to leave the load to the normals",
    )
    condim: Literal[3, 4, 6] = Field(
        3, description="dimension of a contact: 3 slides, 4 has torsional, 6 also rolling friction"
    )
    torsional_friction: float = Field(
        0.0, ge=0.0, le=0.1, description="friction against spinning about a normal [m]; in a groove it brakes rolling"
    )
    rolling_friction: float = Field(0.0, ge=0.0, le=0.1, description="friction against rolling [m]; needs condim 6")
    friction_relaxation: float | None = Field(
        RELAXATION,
        gt=0.0,
        lt=2.0,
        description="share of the slip velocity that friction removes in a step [1]; none: as solref says. Take 0.01 "
        "where the ball slides or has rolling friction: MuJoCo lifts it off by the friction times the slip removed",
    )
    solref_timeconst: float | None = Field(
        None, gt=0.0, le=1.0, description="time constant of the contact [s]; none: two steps, MuJoCo's shortest"
    )
    solref_dampratio: float = Field(DAMPING_RATIO, gt=0.0, le=100.0, description="damping ratio of the contact [1]")
    solimp_dmin: float = Field(
        IMPEDANCE, ge=MIN_IMPEDANCE, le=MAX_IMPEDANCE, description="impedance of the contact at first touch [1]"
    )
    solimp_dmax: float = Field(
        IMPEDANCE, ge=MIN_IMPEDANCE, le=MAX_IMPEDANCE, description="impedance at and beyond solimp_width [1]"
    )
    solimp_width: float = Field(0.001, gt=0.0, le=0.1, description="depth over which the impedance changes [m]")
    solimp_midpoint: float = Field(
        0.5, ge=MIN_IMPEDANCE, le=MAX_IMPEDANCE, description="where the impedance's curve turns, share of the width [1]"
    )
    solimp_power: float = Field(2.0, ge=1.0, le=10.0, description="exponent of the impedance's curve [1]")
    margin: float | None = Field(
        None,
        ge=0.0,
        le=1e-3,
        description="distance at which the contact begins to push [m]; none: as deep as the ball's weight sinks, so "
        "that it rolls at its declared height",
    )
    gap: float = Field(0.0, ge=0.0, le=1e-2, description="distance beyond the margin at which contacts are listed [m]")
    impratio: float | None = Field(
        None, gt=0.0, le=1e6, description="impedance of friction over that of the normal [1]; none: goes with friction"
    )
    cone: Literal["elliptic", "pyramidal"] = Field(
        "elliptic", description="friction cone; the pyramidal one lets a hard contact bounce"
    )
    integrator: Literal["Euler", "implicitfast", "implicit"] = Field(
        "Euler", description="integrator; those that keep velocities at t − dt/2"
    )
    solver: Literal["Newton", "CG", "PGS"] = Field("Newton", description="constraint solver")
    iterations: int = Field(50, ge=1, le=10_000, description="most iterations of the solver in a step [1]")
    noslip_iterations: int = Field(0, ge=0, le=1000, description="iterations of the pass against slip [1]")
    tolerance: float = Field(
        1e-16, ge=0.0, le=1e-14, description="where the solver stops, relative to the pivot's inertia [1]"
    )
    refsafe: bool = Field(True, description="refuse contact time constants under two steps, which may explode")
    slip_limit: float = Field(
        0.01, gt=0.0, le=100.0, description="slip velocity beyond which a run counts as sliding [m/s]"
    )

    @model_validator(mode="after")
    def _nothing_is_ignored(self) -> MuJoCoParameters:
        given = self.model_fields_set
        shortest = 2 * self.time_step
        if self.refsafe and self.solref_timeconst is not None and self.solref_timeconst < shortest * (1 - 1e-9):
            raise ValueError(
                f"solref_timeconst {self.solref_timeconst:g} s is under two time steps, and MuJoCo would use "
                f"{shortest:g} s; lower time_step or set refsafe = false"
            )
        for name, least in (("torsional_friction", 4), ("rolling_friction", 6)):
            value = getattr(self, name)
            if value > 0.0 and self.condim < least:
                raise ValueError(f"{name} acts from condim {least} on; condim is {self.condim}")
            if value < MIN_FRICTION and self.condim >= least:
                raise ValueError(
                    f"with condim {self.condim} MuJoCo raises {name} {value:g} to {MIN_FRICTION:g}; set that or lower "
                    "condim"
                )
        if self.cone == "pyramidal" and "friction_relaxation" in given and self.friction_relaxation is not None:
            raise ValueError("friction_relaxation acts with the elliptic cone only")
        return self

    def option(self, rig: Rig) -> dict[str, Attribute]:
        """Attributes of MJCF's `<option>`."""
        option: dict[str, Attribute] = {
            "timestep": self.time_step,
            "integrator": self.integrator,
            "solver": self.solver,
            "cone": self.cone,
            "jacobian": "dense",
            "iterations": self.iterations,
            "tolerance": self.tolerance,
            "impratio": self.impratio or (impratio_of(self._across(rig) / self.friction) if self._soft_across else 1.0),
        }
        return option | ({"noslip_iterations": self.noslip_iterations} if self.noslip_iterations else {})

    def pair(self, rig: Rig) -> dict[str, Attribute]:
        """Attributes of MJCF's `<pair>`."""
        roll = self.rolling_friction
        pair: dict[str, Attribute] = {
            "condim": self.condim,
            "friction": (self._across(rig), self.friction, self.torsional_friction, roll, roll),
            "solref": (self.solref_timeconst or 2 * self.time_step, self.solref_dampratio),
        }
        if self.friction_relaxation is not None and self.cone == "elliptic":
            pair["solreffriction"] = friction_reference(self.friction_relaxation, self.solimp_dmax, self.time_step)
        shape = (self.solimp_width, self.solimp_midpoint, self.solimp_power)
        return pair | {
            "solimp": (self.solimp_dmin, self.solimp_dmax, *shape),
            "margin": self.margin or 0.0,
            "gap": self.gap,
        }

    @property
    def _soft_across(self) -> bool:
        """Whether friction across the beam may be all but left out.

        Torsional and rolling friction are regularised relative to it and need it stiff; solvers of first order converge
        badly on so uneven a contact; the pyramidal cone knows no impratio of this kind.
        """
        return self.condim == 3 and self.cone == "elliptic" and self.solver == "Newton"

    def _across(self, rig: Rig) -> float:
        """Friction coefficient across the beam [1]."""
        if self.friction_across is not None:
            return self.friction_across
        if aligned(rig) and self._soft_across:
            return max(self.friction * ACROSS, MIN_FRICTION)
        if aligned(rig) and self.condim > 3:
            return max(self.friction * 40 * ACROSS, MIN_FRICTION)  # the load is the normals' but for half a per cent
        return self.friction
