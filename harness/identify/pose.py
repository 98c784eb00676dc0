"""Poses the problem of a case: recordings prepared, rig completed, noise measured."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from analytic.effects import CATALOGUE
from analytic.effects.effect import UnknownQuantity
from harness.errors import InputError
from harness.identify.estimate.angle_noise import prefers_held_command, told_noise_share
from harness.identify.estimate.fast_beam import with_fast_beam
from harness.identify.estimate.noise_colour import with_noise_colour
from harness.identify.problem.problem import Problem
from harness.identify.rig_completion import complete_rig, missing
from harness.preparation.declared_effects import declared_effects
from harness.preparation.recordings import observe
from harness.recording import Case, KnownRig
from harness.recording.commanded import answers_readings

_STOOD_FOR: tuple[UnknownQuantity, ...] = ("ratio", "level", "lever")  # of an incompletely known rig
_FEWEST = 20  # readings that a recording must hold to say anything


def problem_of(case: Case, names: Sequence[str] | None = None) -> Problem:
    """The problem that the recordings `names` pose (by default those to identify from).

    Raises:
        InputError: no recording has positions enough, the rig cannot be completed, or a declared effect is not in the
            catalogue.
    """
    names = [name for name in (names or case.identify) if int(case.recordings[name].usable.sum()) >= _FEWEST]
    if not names:
        why = [f"{one.where}: {one.text}" for one in case.findings if one.code == "no-positions"]
        text = f"{case.path}: no recording to identify from has {_FEWEST} known positions or more."
        raise InputError(" ".join([text, *why]))
    declared = declared_effects(case)
    completed = complete_rig(case, case.recordings[names[0]])
    unknown = unknown_effects(case.rig, lever=completed.tells_lever)

    recordings = [case.recordings[name] for name in names]

    def posed(noise_share: float = 1.0, *, held_command: bool = False) -> Problem:
        every = [
            observe(one, case.sensors, completed.rig, noise_share, held_command=held_command) for one in recordings
        ]
        problem = Problem.of(every, completed.rig, declared, unknown)
        return replace(problem, noise_share=noise_share, held_command=held_command)

    problem = posed()
    if answers_readings(recordings):
        held = posed(held_command=True)
        if prefers_held_command(problem, held):
            return with_noise_colour(held)
    noise_share = told_noise_share(problem)
    return with_noise_colour(with_fast_beam(problem) if noise_share == 1.0 else posed(noise_share))


def unknown_effects(known: KnownRig, *, lever: bool = True) -> tuple[str, ...]:
    """Effects that stand for what a rig file leaves open: K scales the angle's effect, α₀ is added to the angle.

    The lever of α̈ is estimated anew beside every effect, as a delay that is not known yet shifts it by centimetres.

    Args:
        lever: whether the recordings tell it; otherwise it stays as it is assumed.
    """
    open_ = missing(known)
    if open_ and known.level_angle is None:
        open_ |= {"level"}
    if not lever:
        open_ -= {"lever"}
    standing = {effect.relations.stands_for: name for name, effect in CATALOGUE.items()}
    return tuple(standing[quantity] for quantity in _STOOD_FOR if quantity in open_)
