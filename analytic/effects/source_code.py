"""How exported source code writes an effect: expressions that C99 and Python read alike, and named stages."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Stage = Literal["gain", "curve", "play", "hold", "lag", "servo", "drift"]
"""What stands between the measured angle and the beam's, in the templates of `harness.exports`."""
Inner = Literal["slip", "dahl"]
"""An internal state w of the ball: its slip velocity [m/s], or the pull of a Dahl friction [m/s²]."""


@dataclass(frozen=True)
class Code:
    """What an effect adds to the equation of motion, as source code.

    Expressions may use: the effect's own parameters in braces, `{coefficient}`; the ball's position s [m] and velocity
    v [m/s], the beam's angle, rate and angular acceleration `angle`, `rate`, `angular` [rad, s], the rolled angle phi
    [rad]; the rig's MASS, INERTIA, RADIUS, ROLLING_RADIUS, ECCENTRICITY and GRAVITY (SI); sin, cos, exp, fabs and fmax.

    Attributes:
        tilt: added to the angle that gravity sees [rad].
        force: on the ball, over its mass [m/s²].
        lever: what α̈ acts on, in place of the rig's h + r + J/(m r) [m].
        dry: coefficient of dry friction against motion towards +s, and towards −s [1].
        falling: whether `dry` depends on the velocity.
        stage: what it does between the measured angle and the beam's; its parameters follow in their order.
        inner: the internal state that it gives the ball; its parameters follow in their order.
    """

    tilt: str = ""
    force: str = ""
    lever: str = ""
    dry: tuple[str, str] | None = None
    falling: bool = False
    stage: Stage | None = None
    inner: Inner | None = None
