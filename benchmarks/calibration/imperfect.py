"""What a right answer is where nothing is wrong with the ball but something is with its record.

- An effect of the catalogue that says what the imperfection does is a right name, not a false positive: a position
  that is late, by whatever, is a delay or lag of positive size; a command is also held between samples; a wandering
  zero is a level that drifts, or, by its mean, a level error, or one of each recording, or a force that depends on
  time.
- So is a spline term of the position sensor where its track is worn.
- Everything else that is named is a false positive, whatever it may imitate: no force comes from a worn track, a
  spike, an error of a stamp or coloured noise.
- `not_identifiable` is no answer: neither right nor false, and counted apart.
- Naming nothing is right where no effect is hidden: what a record lacks need not be found, only not be taken for
  physics. Where one is hidden, it has to be named, with or without the imperfection.
"""

from __future__ import annotations

from collections.abc import Mapping

from analytic.effects import (
    ANGLE_HOLD,
    ANGLE_LAG,
    ANGLE_SERVO,
    CHANNEL_DELAY,
    LEVEL_DRIFT,
    LEVEL_ERROR,
    LEVEL_PER_RECORDING,
    POSITION_LAG,
)
from harness.simulator import KINDS, kinds_of

SEVERAL = "several"
"""Of the kinds of `harness.simulator.KINDS`, each with probability 1/2."""
IMPERFECTIONS = (*KINDS, SEVERAL)
"""What a trial may have."""
READING = "reading"
"""What a spline term of the position sensor depends on: an error by the recorded position."""

_LATE = frozenset({CHANNEL_DELAY.name, POSITION_LAG.name, ANGLE_LAG.name, ANGLE_SERVO.name})
_ZERO = frozenset({LEVEL_ERROR.name, LEVEL_DRIFT.name, LEVEL_PER_RECORDING.name})

NAMED_BY: Mapping[str, frozenset[str]] = {
    "sensor_lag": _LATE,
    "dropouts": _LATE,  # a repeated reading is late
    "commanded_angle": _LATE | {ANGLE_HOLD.name},
    "zero_drift": _ZERO,
}
"""Effects that say what the imperfection does, by its kind."""
_SPLINES = {"zero_drift": "time", "worn_track": READING}  # what a spline term depends on that says it


def names_for(imperfection: str) -> set[str]:
    """Effects that may say what the imperfection does: no trial hides one of these beside it."""
    kinds = KINDS if imperfection == SEVERAL else (imperfection,)
    return {name for kind in kinds for name in NAMED_BY.get(kind, ())}


def says_imperfection(imperfection: str, seed: int, name: str, values: Mapping[str, float]) -> bool:
    """Whether an effect that was named, with these values, is what is wrong with the record.

    Args:
        imperfection: of the trial, a kind or `SEVERAL`.
        seed: of the trial.
        name: of the effect.
        values: of its parameters (SI).
    """
    right = name in {each for kind in kinds(imperfection, seed) for each in NAMED_BY.get(kind, ())}
    return right and (name not in _LATE or min(values.values()) > 0.0)


def spline_says(imperfection: str, seed: int, depends_on: str | None) -> bool:
    """Whether a spline term of this regressor, or of the position sensor, is what is wrong with the record."""
    return depends_on in {_SPLINES[kind] for kind in kinds(imperfection, seed) if kind in _SPLINES}


def kinds(imperfection: str, seed: int) -> tuple[str, ...]:
    """Kinds of imperfection of a trial."""
    if not imperfection:
        return ()
    return kinds_of(seed) if imperfection == SEVERAL else (imperfection,)
