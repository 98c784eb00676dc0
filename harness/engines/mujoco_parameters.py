"""MuJoCo's parameters: names, units, defaults and bounds, and their translation to MJCF attributes."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, model_validator

from analytic.geometry import channel_of
from analytic.rig import Rig
from harness.engines.parameters import EngineParameters
from mjcf.scene import (
    ACROSS,
    DAMPING_RATIO,
    FRICTION,
    IMPEDANCE,
    Attribute,
    aligned,
    friction_reference,
    impratio_of,
    relaxation_of,
)

MIN_FRICTION = 1e-5  # MuJoCo raises smaller coefficients to this (mjMINMU)
MIN_IMPEDANCE, MAX_IMPEDANCE = 1e-4, 0.9999  # MuJoCo clips impedances to this range (mjMINIMP, mjMAXIMP)


class MuJoCoParameters(EngineParameters):
    """Parameters of MuJoCo under its own names. Values that MuJoCo would silently clip or ignore are refused."""

    friction: float = Field(
        FRICTION, ge=MIN_FRICTION, le=10.0, description="friction coefficient of ball and rail along the beam [1]"
    )
    friction_across: float | None = Field(
        None,
        ge=MIN_FRICTION,
        le=10.0,
        description="the same across the beam [1]; none: so small that the normal forces carry the load",
    )
    condim: Literal[3, 4, 6] = Field(
        3, description="contact dimension: 3 sliding friction, 4 also torsional, 6 also rolling friction"
    )
    torsional_friction: float = Field(
        0.0, ge=0.0, le=0.1, description="friction against spinning about a normal [m]; in a groove it brakes rolling"
    )
    rolling_friction: float = Field(0.0, ge=0.0, le=0.1, description="friction against rolling [m]; needs condim 6")
    friction_relaxation: float | None = Field(
        None,
        gt=0.0,
        lt=2.0,
        description="share of the slip velocity that friction removes per step [1]; none: 2 − time_step/(5 ms), at "
        "least 1.8. Use 0.01 for a sliding ball or rolling friction: MuJoCo lifts the ball by the friction times the "
        "slip removed",
    )
    solref_timeconst: float | None = Field(
        None, gt=0.0, le=1.0, description="time constant of the contact [s]; none: two steps, MuJoCo's shortest"
    )
    solref_dampratio: float = Field(DAMPING_RATIO, gt=0.0, le=100.0, description="damping ratio of the contact [1]")
    solimp_dmin: float = Field(
        IMPEDANCE, ge=MIN_IMPEDANCE, le=MAX_IMPEDANCE, description="impedance of the contact at zero penetration [1]"
    )
    solimp_dmax: float = Field(
        IMPEDANCE, ge=MIN_IMPEDANCE, le=MAX_IMPEDANCE, description="impedance at and beyond solimp_width [1]"
    )
    solimp_width: float = Field(0.001, gt=0.0, le=0.1, description="depth over which the impedance changes [m]")
    solimp_midpoint: float = Field(
        0.5, ge=MIN_IMPEDANCE, le=MAX_IMPEDANCE, description="inflection of the impedance curve, share of the width [1]"
    )
    solimp_power: float = Field(2.0, ge=1.0, le=10.0, description="exponent of the impedance's curve [1]")
    margin: float | None = Field(
        None,
        ge=0.0,
        le=1e-3,
        description="distance at which the contact force begins [m]; none: the penetration under the ball's weight, "
        "so that it rolls at its declared height",
    )
    gap: float = Field(0.0, ge=0.0, le=1e-2, description="distance beyond the margin at which contacts are listed [m]")
    impratio: float | None = Field(
        None, gt=0.0, le=1e6, description="ratio of frictional to normal impedance [1]; none: derived from friction"
    )
    cone: Literal["elliptic", "pyramidal"] = Field(
        "elliptic", description="friction cone; with the pyramidal one a hard contact bounces"
    )
    integrator: Literal["Euler", "implicitfast", "implicit"] = Field(
        "Euler", description="integrator, one with velocities at t − dt/2"
    )
    solver: Literal["Newton", "CG", "PGS"] = Field("Newton", description="constraint solver")
    iterations: int = Field(50, ge=1, le=10_000, description="maximum solver iterations per step [1]")
    noslip_iterations: int = Field(0, ge=0, le=1000, description="iterations of the noslip pass [1]")
    tolerance: float = Field(
        1e-16, ge=0.0, le=1e-14, description="solver tolerance, relative to the pivot's inertia [1]"
    )
    refsafe: bool = Field(True, description="refuse contact time constants below two steps, which may be unstable")

    @model_validator(mode="after")
    def _refuse_ignored_values(self) -> MuJoCoParameters:
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
        roll, grip = self.rolling_friction, channel_of(rig).grip
        pair: dict[str, Attribute] = {
            "condim": self.condim,
            "friction": (grip * self._across(rig), grip * self.friction, self.torsional_friction, roll, roll),
            "solref": (self.solref_timeconst or 2 * self.time_step, self.solref_dampratio),
        }
        if self.cone == "elliptic":
            share = self.friction_relaxation or relaxation_of(self.time_step)
            pair["solreffriction"] = friction_reference(share, self.solimp_dmax, self.time_step)
        shape = (self.solimp_width, self.solimp_midpoint, self.solimp_power)
        return pair | {
            "solimp": (self.solimp_dmin, self.solimp_dmax, *shape),
            "margin": self.margin or 0.0,
            "gap": self.gap,
        }

    @property
    def _soft_across(self) -> bool:
        """Whether friction across the beam may be almost removed.

        Torsional and rolling friction are regularised relative to it and need it stiff; first-order solvers converge
        slowly on such ill-conditioned contacts; the pyramidal cone does not support such an impratio.
        """
        return self.condim == 3 and self.cone == "elliptic" and self.solver == "Newton"

    def _across(self, rig: Rig) -> float:
        """Friction coefficient across the beam [1]."""
        if self.friction_across is not None:
            return self.friction_across
        if aligned(rig) and self._soft_across:
            return max(self.friction * ACROSS, MIN_FRICTION)
        if aligned(rig) and self.condim > 3:
            return max(self.friction * 40 * ACROSS, MIN_FRICTION)  # normal forces carry all but 0.5 % of the load
        return self.friction
