"""What an effect is: everything that the program knows of one, in one place.

Whoever needs a fact of an effect of the catalogue asks its `Effect`, and nobody its name. Only the virtual rig
(`harness.simulator`), which has to be independent, has a law of its own under the effect's name.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

from analytic import slots
from analytic.effects.force import EffectError, Force, Values
from analytic.effects.parameter import Parameter
from analytic.effects.sensor_law import SensorLaw
from analytic.effects.source_code import Code
from analytic.models import Model
from analytic.motion import BeamMotion, FloatArray
from analytic.rig import Rig

Write = Callable[[FloatArray, Rig, Values], None]
"""Adds an effect to a kernel vector, shape (SLOTS,), in place; effects of one kind add up."""
SlotTerms = Callable[[float, Rig, Values], Mapping[int, float]]
"""What an effect adds to slots of the kernel vector, given k = 1/(1 + J/(m r²)) [1]."""
Alter = Callable[[Rig, Values], Rig]
"""The rig as it is instead of as it is declared."""
Turn = Callable[[BeamMotion, FloatArray, Values], BeamMotion]
"""The beam's motion behind the measured one, over a recording's stamps, shape (n,) [s]."""

UnknownQuantity = Literal["ratio", "level", "lever"]
"""What a rig file may leave open: K = 1/(1 + J/(m r²)), the level angle α₀, and the lever h + r + J/(m r) of α̈."""
SplineKind = tuple[str, bool]
"""A kind of spline term: the quantity it depends on, as in diagnosis.json, or "reading" for an error of the position
sensor, which depends on the position too; and whether it is a dry friction."""


def adding(terms: SlotTerms) -> Write:
    """The `write` of an effect that adds `terms` to the vector."""

    def write(p: FloatArray, rig: Rig, values: Values) -> None:
        for slot, amount in terms(float(p[slots.RESPONSE]), rig, values).items():
            p[slot] += amount

    return write


@dataclass(frozen=True)
class Transmission:
    """Between the measured angle and the beam: beam angle = `gain` × angle [1], behind `play` of this width [rad]."""

    gain: float = 1.0
    play: float = 0.0


@dataclass(frozen=True)
class Follower:
    """How a small change e of the angle reaches a beam that follows it: `square` b̈ + `lag` ḃ + b = e [s², s].

    Raises:
        EffectError: one is negative or no number: no beam would settle.
    """

    lag: float
    square: float = 0.0

    def __post_init__(self) -> None:
        if not (math.isfinite(self.lag) and math.isfinite(self.square) and self.lag >= 0.0 and self.square >= 0.0):
            raise EffectError(f"a follower with the lag {self.lag:g} s and the square {self.square:g} s²: none below 0")


@dataclass(frozen=True)
class Relations:
    """How an effect stands to others, to the rig and to the baseline.

    Attributes:
        once: whether only one can act, as the kernel or the rig takes one.
        stands_for: the quantity of an incompletely known rig that it stands for in every hypothesis.
        hidden_by: unknown quantities of the rig whose estimates take it in, besides the one that it stands for.
        in_baseline: whether a model has it already.
        nested_in: kinds of spline terms that contain its law.
        late: whether a slow motion of the beam shows as a delay does: such effects differ in what they do to a quick
            one.
        common: whether it acts on many measured rigs, so that it is searched together with the others of these.
        same_beside: effects that say exactly the same where one of those named by it is fitted beside.
        splits_into: two effects of one number each which imitate it or which it is made of. Two causes are the rarer
            explanation.
    """

    once: bool = False
    stands_for: UnknownQuantity | None = None
    hidden_by: tuple[UnknownQuantity, ...] = ()
    in_baseline: Callable[[Model], bool] = lambda _: False
    nested_in: tuple[SplineKind, ...] = ()
    late: bool = False
    common: bool = False
    same_beside: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    splits_into: tuple[Effect, Effect] | None = None


@dataclass(frozen=True)
class EngineEntry:
    """How an effect enters the engines' scenes, where that does not follow from what it acts on.

    Attributes:
        words: where, for the report.
        settings: the engines' own parameters that stand for it, by engine; it is then no force on the ball.
    """

    words: str = ""
    settings: Mapping[str, Callable[[Values], dict[str, Any]]] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Effect:
    """One entry of the catalogue. It acts in one place: on the ball, on the rig's quantities, on the angle, or on the
    sensor.

    Attributes:
        name: public, as in results.
        law: one line, symbols as in the paper.
        parameters: in the order of results; the first one is its strength.
        source: where the law comes from.
        write: puts a force or tilt into the kernel's vector.
        force: a force on the ball that the kernel has no slot for.
        alter: changes a quantity of the rig.
        transmission: gain and play between measured angle and beam.
        turn: changes the beam's motion in any other way, which moves in closed loop do not foresee.
        follower: of a `turn` that smooths, and is linear in the motion, how an error of the angle reaches the beam;
            without, as it is.
        tilting: rate at which the whole rig tilts from the start of a recording on [rad/s].
        sensor: gain, lag and delay of what is recorded of the position.
        dry: whether it is a set-valued friction, which needs the ball's stop within a step.
        turning: whether it matters how the ball lies at the start, φ₀, which then is free in each recording.
        phrase: what it is called with its values in it, by parameter; {declared} is where its first one does nothing.
        relations: to other effects, the rig and the baseline.
        engine: how it enters the engines' scenes.
        code: how exported source writes it; what alters the rig or the sensor needs none, as these are numbers there.

    Raises:
        EffectError: a name that is none, no parameter or one twice, no law, or an effect that does nothing.
    """

    name: str
    law: str
    parameters: tuple[Parameter, ...]
    source: str
    write: Write | None = None
    alter: Alter | None = None
    turn: Turn | None = None
    follower: Callable[[Values], Follower] | None = None
    tilting: Callable[[Values], float] | None = None
    dry: bool = False
    force: Force | None = None
    transmission: Callable[[Values], Transmission] | None = None
    sensor: Callable[[Values], SensorLaw] | None = None
    turning: bool = False
    phrase: str = ""
    relations: Relations = Relations()
    engine: EngineEntry = EngineEntry()
    code: Code | None = None

    def __post_init__(self) -> None:
        if not self.name.isidentifier():
            raise EffectError(f"{self.name!r} is no name for an effect; use letters, digits and _")
        names = [parameter.name for parameter in self.parameters]
        if not names or len(set(names)) < len(names):
            raise EffectError(f"{self.name}: give it parameters, each name once")
        if len(names) > 1 and any(parameter.by_recording for parameter in self.parameters):
            raise EffectError(f"{self.name}: a parameter with a value for each recording has to be the only one")
        if not (self.law and self.source):
            raise EffectError(f"{self.name}: say its law in a line, and where that comes from")
        if not any((self.write, self.alter, self.moves_beam, self.sensor, self.force)):
            raise EffectError(
                f"{self.name}: does nothing; give it a force, or alter, turn, transmission, sensor or write"
            )
        if self.follower is not None and self.turn is None:
            raise EffectError(f"{self.name}: a follower smooths the angle's error as its turn the motion; give both")

    @property
    def exportable(self) -> bool:
        """Whether source code can be written of it: of a force that only Python knows it cannot."""
        known = self.code is not None or self.alter is not None or self.sensor is not None
        return known and self.force is None

    @property
    def by_recording(self) -> Parameter | None:
        """The parameter of which each recording has a value of its own; it is then the only one."""
        return self.parameters[0] if self.parameters[0].by_recording else None

    @property
    def strengths(self) -> frozenset[str]:
        """Names of the parameters with which it vanishes; of a force the first, if none says so."""
        named = frozenset(parameter.name for parameter in self.parameters if parameter.strength)
        return named or frozenset([self.parameters[0].name] if self.force is not None else ())

    @property
    def moves_beam(self) -> bool:
        """Whether the beam's motion is another one than the measured."""
        return any((self.transmission, self.turn, self.tilting))

    @property
    def pushes(self) -> bool:
        """Whether an engine's ball gets it as a force."""
        return (self.write is not None or self.force is not None) and not self.engine.settings

    @property
    def enters(self) -> str:
        """Where it enters the engines' scenes, in words."""
        if self.engine.words:
            return self.engine.words
        if self.alter is not None:
            return "the scene's geometry"
        if self.moves_beam:
            return "angle of the driven beam"
        return "force on the ball" if self.sensor is None else "sensor side: what is recorded of the position"


@dataclass(frozen=True)
class Acting:
    """An effect that acts, with the values of its parameters (SI)."""

    effect: Effect
    values: Values

    def text(self) -> str:
        """`rolling_resistance (coefficient = 0.002)`."""
        parts = (f"{p.name} = {self.values[p.name]:g} {p.unit}".removesuffix(" 1") for p in self.effect.parameters)
        return f"{self.effect.name} ({', '.join(parts)})"
