"""What a command would take, told before it begins; beyond a limit it asks for consent."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from harness.errors import InputError

if TYPE_CHECKING:
    from harness.comparison import Choices
    from harness.engines.parameters import EngineParameters
    from harness.engines.protocol import Engine
    from harness.recording import Recording

ASKED = 600.0
"""Time beyond which a command asks [s]."""
MEMORY_ASKED = 4e9
"""Memory beyond which it asks [bytes]; a single run that takes more is refused (`engines.leapfrog.check_steps`)."""
# Measured on two cores [s]: steps of the engines, PyBullet's being the slowest; diagnoses of one to 25 recordings with
# 600 to 20 000 readings. Where little else ran, five measured rigs took 0.3 to 0.9 of what the line says (17 to 47 s),
# and three simulated rigs of 4800 readings, of which little is missing, 0.1 to 0.2 of it (6 to 10 s). On a busy machine
# it may be twice as much, and of a hundred thousand readings, with all kinds of spline terms, more than the line says.
_STEP = {"mujoco": 4e-5}
_STEP_OTHER = 1.1e-4
_DIAGNOSIS, _RECORDING, _READING = 20.0, 2.0, 0.005
# Runs for a parameter that pays: screening, fits and held-out blocks, all windows; one that does not takes a tenth.
_TUNED_RUNS = 100.0
_SIDE_BY_SIDE = 3  # runs of the smallest step of a fit: a parameter and both numbers of the starts moved
_HALF_AND_DOUBLE = 2.5
"""Runs at half and at double the time step, which tell the numerical error, in runs of the whole recording."""


def comparison_time(duration: float, engines: Sequence[tuple[Engine, EngineParameters]], choices: Choices) -> float:
    """Time that a comparison on a recording of this duration [s] takes [s].

    Args:
        duration: of the longest recording that may be compared [s].
        engines: that run, with their settings.
        choices: of which the windows are of interest: those of one length last as long together as the recording.
    """
    runs = 1.0 + len(set(choices.lengths)) + _HALF_AND_DOUBLE
    return sum(runs * duration / one.time_step * _STEP.get(engine.name, _STEP_OTHER) for engine, one in engines)


def diagnosis_time(recordings: Sequence[Recording]) -> float:
    """Time that a diagnosis of these recordings takes [s]."""
    from harness.recording.fast_sensor import neighbours_in_mean

    readings = sum(int(one.usable.sum()) / neighbours_in_mean(one) for one in recordings)
    return _DIAGNOSIS + _RECORDING * len(recordings) + _READING * readings


def tuning_time(durations: Sequence[float], free: int, engine: Engine, settings: Mapping[str, Any], jobs: int) -> float:
    """Time that tuning takes [s].

    Args:
        durations: of the recordings to fit to [s].
        free: how many parameters may be tuned.
        engine: to tune.
        settings: of it.
        jobs: processes that run it; those of a step of a fit run side by side.
    """
    from harness.engines.catalogue import parameters_of
    from harness.tuning.estimate.windows import LENGTH, MOST

    steps = min(sum(durations), MOST * LENGTH) / parameters_of(engine, settings).time_step
    return _TUNED_RUNS * free * steps * _STEP.get(engine.name, _STEP_OTHER) / min(max(jobs, 1), _SIDE_BY_SIDE)


def ask(seconds: float, memory: float, remedy: str, *, yes: bool) -> None:
    """Go on where it is short and small or the user has said yes.

    Args:
        seconds: that it takes [s].
        memory: that it takes at most [bytes].
        remedy: how it could be shorter.
        yes: the user's consent.

    Raises:
        InputError: it takes longer than `ASKED` or more than `MEMORY_ASKED`, and the user has not said yes.
    """
    long = f"some {seconds / 60.0:.0f} minutes, more than {ASKED / 60.0:.0f}" if seconds > ASKED else ""
    large = (
        f"up to {memory / 1e9:.1f} GB of memory, more than {MEMORY_ASKED / 1e9:.0f}" if memory > MEMORY_ASKED else ""
    )
    if (long or large) and not yes:
        said = " and ".join(filter(None, (long, large)))
        raise InputError(f"this would take {said}; {remedy}, or say --yes (yes=True in Python)")


def expected(seconds: float, memory: float) -> str:
    """What it takes, in words: told before it begins."""
    long = "less than a minute" if seconds < 60.0 else f"some {seconds / 60.0:.0f} min"
    return f"this takes {long} and up to {memory / 1e9:.1f} GB of memory"
