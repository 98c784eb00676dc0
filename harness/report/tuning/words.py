"""The answer of a tuning in words."""

from __future__ import annotations

import math

from harness.formatting import length, listed, measured, number
from harness.numerics import rms
from harness.report.palette import label_of
from harness.tuning.cam import CamErrors
from harness.tuning.tune import Rejected, Tuned, Verdict

_BETTER = 0.8  # of the engine's held-out error, below which CAM with effects counts as better


def sentences(tuned: Tuned, cam: CamErrors | None, case: str) -> tuple[str, ...]:
    """What was found, what it gains, and what to do next.

    Args:
        case: as the user typed it, for the command to type next.
    """
    name, found = label_of(tuned.model.engine.name), tuned.selection.found
    ratio = math.sqrt(found.misfit)
    lacks = f"the residuals of its free runs are {number(ratio, 2)} times what reading noise and angle error explain"
    told = []
    match tuned.verdict:
        case Verdict.TUNED:
            told.append(f"{name} was tuned: {listed([value_text(tuned, one) for one in tuned.selection.pays])}.")
        case Verdict.NOTHING:
            scene = tuned.model.engine.scene_file
            untuned = f"with {scene} as it is," if scene else "with its defaults"
            told.append(
                f"Nothing to tune: {untuned} {name} predicts these recordings as well as reading noise and "
                "angle error allow, and no free parameter lowers the criterion."
            )
        case Verdict.PHYSICS:
            told.append(f"No free parameter of {name} helps, although {lacks}.")
            if tuned.rejected is not None:
                told.append(_rejection(tuned.rejected))
    if tuned.left_out:
        told.append(
            f"{len(tuned.left_out)} of {len(tuned.left_out) + len(tuned.windows)} windows are left out, which {name} "
            f"does not run through: {tuned.left_out[0].reason} (first at {number(tuned.left_out[0].time, 4)} s)."
        )
    told += _errors(tuned, cam)
    if not found.complete:
        told += _not_tried(tuned)
    if not found.complete:
        beyond = "Still " if tuned.verdict is Verdict.TUNED else ""
        physics = f"physics is missing that no contact parameter stands for. `harness diagnose {case}` looks for it."
        told.append(f"{beyond}{lacks}: {physics}" if beyond else physics[:1].upper() + physics[1:])
    return tuple(told)


def _rejection(rejected: Rejected) -> str:
    names = listed([f"`{one}`" for one in rejected.names])
    pay = "pays" if len(rejected.names) == 1 else "pay"
    errors = f"{length(rejected.after)} instead of {length(rejected.before)}"
    return f"{names} {pay} on the readings fitted to, but on held-out blocks the RMS error is {errors}."


def _not_tried(tuned: Tuned) -> list[str]:
    """What the engine could not be tried with, and how it may be."""
    engine = tuned.model.engine.name
    half = 0.5 * tuned.model.parameters(tuned.selection.found.values).time_step
    return [
        f"`{one.name}` could not be tried at {listed([f'{value:g}' for value in one.failed])}: with "
        f"{one.failed[0]:g} {label_of(engine)} fails at {number(one.failure.time, 4)} s ({one.failure.reason}). "
        f"`--set {engine}.time_step={half:g}` may let it run through."
        for one in tuned.selection.screened.values()
        if one.name not in tuned.selection.pays and one.failure is not None
    ]


def left_as(tuned: Tuned, default: str) -> str:
    """Where the value of a parameter is from that is not set: the user's scene, or else `default`."""
    scene = tuned.model.engine.scene_file
    return f"as in {scene}" if scene else default


def value_text(tuned: Tuned, name: str) -> str:
    """`friction` 0.0092 ± 0.0002: the value, with half the width of its 95 % interval; at a bound, that it is there."""
    found, one = tuned.selection.found, tuned.model.free[name]
    unit = "" if one.unit == "1" else f" {one.unit}"
    if found.at_bound(name):
        return f"`{name}` {number(found.values[name], 4)}{unit}, at the end of the range tried"
    low, high = found.interval(name)
    return f"`{name}` {measured(found.values[name], 0.5 * (high - low))}{unit}"


def _errors(tuned: Tuned, cam: CamErrors | None) -> list[str]:
    held = tuned.held_out
    if held is None:
        return ["The recordings are too short for held-out blocks, so that no prediction error can be told."]
    before, after = rms(held.before), rms(held.after)
    if tuned.selection.pays:
        margin = held.margin
        sure = "" if margin is None or margin.sure else ", which so few blocks do not make sure"
        verb = "falls" if after < before else "rises"
        told = [f"On held-out blocks its RMS error {verb} from {length(before)} to {length(after)}{sure}."]
    else:
        told = [f"On held-out blocks its RMS error is {length(before)}."]
    if cam is not None:
        plain, with_effects = cam.rms(held.blocks)
        effects = [*(f"`{name}`" for name in cam.effects), *(["an unlisted law"] if cam.unlisted else [])]
        if effects:
            better = " predicts better:" if with_effects < _BETTER * after else " comes to"
            told.append(f"CAM with {listed(effects)}{better} {length(with_effects)} (without: {length(plain)}).")
        else:
            told.append(f"CAM, which a diagnosis adds no effect to, comes to {length(plain)}.")
    return told
