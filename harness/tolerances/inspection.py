"""Everything between a user's wish (a case, tweaked parameters, limits) and its checks, in two steps.

`inspect` reads and settles, and is where bad input shows; `Inspection.checks` runs models and engines, once.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from harness.comparison import Choices, Setting, prepare, study
from harness.engines.catalogue import engine_of, parameters_of, read_settings
from harness.engines.protocol import Engine, EngineParameters
from harness.errors import EngineFailure, InputError
from harness.recording import load_case
from harness.tolerances.check import Checked, check, require
from harness.tolerances.file import tolerances_for
from harness.tolerances.limits import Limit, Tolerances


@dataclass(frozen=True)
class Inspection:
    """A case ready to be held to its limits.

    Attributes:
        setting: recording, rig, drive, start, horizons.
        engines: those that run, with their parameters.
        tolerances: limits to check.
        left_out: limits on engines that the user chose not to run.
        tweaks: parameters that differ from their defaults, as in "mujoco.friction = 0.3 (default 0.5)".
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
    """Settle a case and its limits.

    Args:
        path: folder, `rig.toml` or CSV recording.
        recording: its name in the case, `None` for the first to identify from.
        engines: those to run; none for those on which there is a limit.
        assignments: `engine.parameter=value`.
        parameters: TOML file with a table an engine; assignments win.
        tolerances: the limits' file, `None` for the case's own or else the package's.

    Raises:
        InputError: anything in it cannot be used, or would have no effect.
    """
    settings = read_settings(parameters, assignments)
    case = load_case(path)
    limits = tolerances_for(path, tolerances)
    names = tuple(dict.fromkeys(engines)) or limits.engines
    chosen = tuple((engine, parameters_of(engine, settings.get(engine.name, {}))) for engine in map(engine_of, names))
    _nothing_in_vain(names, settings, limits)
    kept = limits.without(set(limits.engines) - set(names))
    setting = prepare(case, kept.settle(Choices(recording=recording, lengths=())))
    require(setting, kept)
    _try_out(setting, chosen)
    return Inspection(
        setting=setting,
        engines=chosen,
        tolerances=kept,
        left_out=tuple(limit for limit in limits.limits if limit not in kept.limits),
        tweaks=tuple(text for engine, values in chosen for text in _tweaks(engine, values)),
    )


def _try_out(setting: Setting, engines: Sequence[tuple[Engine, EngineParameters]]) -> None:
    """Let every engine build its scene and run to the second stamp: a rig it cannot work with shows here."""
    first = int(setting.horizons[0].first[0])
    for engine, values in engines:
        with suppress(EngineFailure):  # is found again, and judged, when the engine runs in earnest
            engine.run(setting.rig, setting.drive, setting.start, setting.time[first : first + 2], parameters=values)


def _nothing_in_vain(names: Sequence[str], settings: Mapping[str, Any], limits: Tolerances) -> None:
    """A parameter of an engine that does not run, or an engine without a limit, would seem to pass."""
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
