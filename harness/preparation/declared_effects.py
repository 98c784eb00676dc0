"""Effects that a rig file declares to act."""

from __future__ import annotations

from analytic.effects import CATALOGUE, Acting, EffectError, acting
from harness.errors import InputError
from harness.recording import Case


def declared_effects(case: Case) -> tuple[Acting, ...]:
    """The effects of `[[declared]]`, with their values.

    Raises:
        InputError: one of them is not in the catalogue, or its values are not possible.
    """
    for one in case.declared:
        if one.name in CATALOGUE and CATALOGUE[one.name].by_recording is not None:
            raise InputError(
                f"{case.path}: rig.toml, [[declared]]: {one.name} has a value of its own in each recording "
                "and cannot be declared. Leave it out; a diagnosis finds these values."
            )
    try:
        return tuple(acting(one.name, one.parameters) for one in case.declared)
    except EffectError as error:
        own = "" if all(one.name in CATALOGUE for one in case.declared) else " Give a file of your own with --effects."
        raise InputError(f"{case.path}: rig.toml, [[declared]]: {error}{own}") from error
