"""From a case, engine parameters and limits to checks, in two steps.

`inspect` reads and validates all input; `Inspection.checks` then runs models and engines once.
"""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from harness.comparison import Choices, Setting, prepare, study
from harness.engines.catalogue import engine_of, parameters_of, read_settings
from harness.engines.parameters import EngineParameters
from harness.engines.protocol import Engine
from harness.errors import EngineFailure, InputError
from harness.recording import load_case
from harness.recording.rig_changes import RIG_CHANGES, with_rig_changes
from harness.tolerances.check import Checked, check, require
from harness.tolerances.file import tolerances_for
from harness.tolerances.limits import Limit, Tolerances


@dataclass(frozen=True)
class Inspection:
    """A case, prepared for the check of its limits.

    Attributes:
        setting: recording, rig, drive, start, horizons.
        engines: engines to run, with their parameters.
        tolerances: limits to check.
        left_out: limits on engines excluded by the user.
        tweaks: parameters that differ from their defaults, as in "mujoco.friction = 0.3 (default 0.5)"; quantities of
            the rig that a settings file replaces.
    """

    setting: Setting
    engines: tuple[tuple[Engine, EngineParameters], ...]
    tolerances: Tolerances
    left_out: tuple[Limit, ...]
    tweaks: tuple[str, ...]

    @cached_property
    def checks(self) -> Mapping[str, Checked]:
        """Outcome of every limit by its name; the first call runs models and engines."""
        found = check(study(self.setting, self.engines), self.tolerances)
        return {one.name: one for one in found}


def inspect(
    path: Path,
    *,
    recording: str | None = None,
    engines: Sequence[str] = (),
    assignments: Sequence[str] = (),
    parameters: Path | None = None,
    tolerances: Path | None = None,
) -> Inspection:
    """Reads and validates a case and its limits.

    Args:
        path: folder, `rig.toml` or CSV recording.
        recording: name within the case, `None` for the first recording for identification.
        engines: engines to run; if empty, those with a limit.
        assignments: `engine.parameter=value`.
        parameters: TOML file with one table per engine, and possibly one of the rig; assignments take precedence.
        tolerances: file of the limits, `None` for the case's own or else the defaults.

    Raises:
        InputError: an input is invalid or would have no effect.
    """
    settings = read_settings(parameters, assignments)
    case = with_rig_changes(load_case(path), parameters)
    limits = tolerances_for(case.path, tolerances)
    names = tuple(dict.fromkeys(engines)) or limits.engines
    engines_chosen = (engine_of(name, case.scene) for name in names)
    chosen = tuple((engine, parameters_of(engine, settings.get(engine.name, {}))) for engine in engines_chosen)
    _refuse_unused(names, settings, limits)
    kept = limits.without(set(limits.engines) - set(names))
    setting = prepare(case, kept.applied_to(Choices(recording=recording, lengths=())))
    require(setting, kept)
    _try_out(setting, chosen)
    return Inspection(
        setting=setting,
        engines=chosen,
        tolerances=kept,
        left_out=tuple(limit for limit in limits.limits if limit not in kept.limits),
        tweaks=(
            *(text for engine, values in chosen for text in _tweaks(engine, values)),
            *(f"{one.where} {one.text}" for one in case.findings if one.code == RIG_CHANGES),
        ),
    )


def _try_out(setting: Setting, engines: Sequence[tuple[Engine, EngineParameters]]) -> None:
    """Lets every engine build its scene and run to the second stamp, to detect an unsupported rig early."""
    first = int(setting.horizons[0].first[0])
    for engine, values in engines:
        with suppress(EngineFailure):  # will occur again, and be reported, in the full run
            engine.run(setting.rig, setting.drive, setting.start, setting.time[first : first + 2], parameters=values)


def _refuse_unused(names: Sequence[str], settings: Mapping[str, Any], limits: Tolerances) -> None:
    """Refuses parameters of an engine that does not run, and engines without a limit."""
    for name in settings:
        if name not in names:
            raise InputError(
                f"parameters of {name} are set, but it does not run: {limits.path} sets no limit on it, or --engine "
                f"leaves it out. Add a limit, add --engine {name}, or do not set its parameters."
            )
    for name in names:
        if name not in limits.engines:
            raise InputError(
                f"{limits.path}: sets no limit on {name}, which --engine asks for. "
                f"Write for instance [{name}.against_cam] and below it max_difference_m = 2e-5."
            )


def _tweaks(engine: Engine, values: EngineParameters) -> list[str]:
    return [
        f"{engine.name}.{name} = {getattr(values, name)} (default {field.default})"
        for name, field in type(values).model_fields.items()
        if getattr(values, name) != field.default
    ]
