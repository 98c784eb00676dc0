"""What a worker does: some runs of one source on one recording, each a row; a run that fails is a row, too."""

from __future__ import annotations

import time
from collections import OrderedDict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from analytic.effects import Acting, EffectError, acting
from analytic.models import CAM
from analytic.rig import RigError
from harness.comparison import Choices, Setting, prepare
from harness.comparison.horizons import Horizon
from harness.comparison.sources import SourceRuns, run_engine, run_models
from harness.engines.catalogue import engine_of, parameters_of
from harness.engines.health import Failure
from harness.engines.injection import engine_settings
from harness.errors import EngineFailure, InputError
from harness.identify.rig_completion import missing
from harness.metrics.errors import max_error, rms_error
from harness.recording import Case
from harness.sweeps.factors import CAM_SOURCE, EFFECTS, RIG, RIG_KEYS, TIME_STEP
from harness.sweeps.plan import Run
from harness.sweeps.ranges import Value

_FEW = 2  # stamps of a run that only loads and compiles
_KEPT = 4  # prepared recordings in a process
IMPOSSIBLE_RIG, IMPOSSIBLE_EFFECT, REFUSED = "impossible_rig", "impossible_effect", "refused_parameters"
BAD_RECORDING = "bad_recording"

Row = dict[str, Any]


@dataclass(frozen=True)
class Batch:
    """Runs of one source on one recording.

    Attributes:
        case: with this recording.
        key: tells the case from others.
        window: length of the windows [s]; `None` for one free run.
        runs: of the same recording and source.
    """

    case: Case
    key: str
    window: float | None
    runs: Sequence[Run]


def lean(case: Case, recording: str) -> Case:
    """The case with no other recordings than those that a run on this one reads: what travels to a worker."""
    if missing(case.rig):
        return case
    return replace(case, recordings={recording: case.recordings[recording]}, identify=(recording,), predict=())


_warm: set[str] = set()  # sources that have run in this process
_prepared: OrderedDict[tuple[str, str, float | None], Setting] = OrderedDict()  # in this process


def _setting(batch: Batch, recording: str) -> Setting:
    """Drive, start state and noise of a recording, prepared once in a process."""
    key = (batch.key, recording, batch.window)
    if key not in _prepared:
        lengths = () if batch.window is None else (batch.window,)
        _prepared[key] = prepare(batch.case, Choices(recording=recording, lengths=lengths))
        while len(_prepared) > _KEPT:
            _prepared.popitem(last=False)
    return _prepared[key]


def do_batch(batch: Batch) -> list[Row]:
    """The rows of these runs, in their order."""
    try:
        setting = _setting(batch, batch.runs[0].recording)
        if batch.window is not None and len(setting.horizons) < 2:
            path = setting.recording.path
            raise InputError(f"{path}: no window of {batch.window:g} s has enough known positions; lower window_s")
    except InputError as error:
        return [failed_row(run, BAD_RECORDING, str(error)) for run in batch.runs]
    return [_row(setting, run) for run in batch.runs]


def failed_row(run: Run, name: str, message: str) -> Row:
    """The row of a run that gave nothing."""
    return {"run": run.number, "failure": name, "message": message}


def _row(setting: Setting, run: Run) -> Row:
    try:
        setting = _varied(setting, run.values)
        return {"run": run.number, "failure": None, "message": None, **_measured(setting, run)}
    except RigError as error:
        return failed_row(run, IMPOSSIBLE_RIG, str(error))
    except EffectError as error:
        return failed_row(run, IMPOSSIBLE_EFFECT, str(error))
    except EngineFailure as failure:
        name = failure.failure.name.lower() if isinstance(failure.failure, Failure) else str(failure.failure)
        return failed_row(run, name, str(failure))
    except InputError as error:
        return failed_row(run, REFUSED, str(error))
    except Exception as error:  # a fault of ours or of a package: one row, and not the end of a night's work
        return failed_row(run, type(error).__name__, str(error))


def _varied(setting: Setting, values: Mapping[str, Value]) -> Setting:
    """The setting with the rig and the effects of a run; drive and start state stay as they were estimated."""
    rig = {RIG_KEYS[name.partition(".")[2]]: float(x) for name, x in values.items() if name.startswith(f"{RIG}.")}
    return replace(setting, rig=setting.rig.with_(**rig), acting=(*setting.acting, *_effects(values)))


def _effects(values: Mapping[str, Value]) -> list[Acting]:
    given: dict[str, dict[str, float]] = {}
    for name, value in values.items():
        table, _, rest = name.partition(".")
        if table == EFFECTS:
            effect, _, parameter = rest.partition(".")
            given.setdefault(effect, {})[parameter] = float(value)
    return [acting(name, parameters) for name, parameters in given.items()]


def _measured(setting: Setting, run: Run) -> Row:
    """Errors of a run against CAM and against the measurement, and what it cost."""
    horizon = setting.horizons[0 if len(setting.horizons) == 1 else 1]
    (cam,) = run_models(setting, [CAM], horizon)
    if run.source not in _warm:  # what is loaded or compiled at first is no part of a run's time
        _run_of(setting, run, Horizon(horizon.seconds, horizon.first[:1], horizon.first[:1] + _FEW))
        _warm.add(run.source)
    begin = time.thread_time()  # of the processor: other jobs share it
    made = _run_of(setting, run, horizon)
    seconds = time.thread_time() - begin
    reference = made.position - cam.position
    trusted = np.where(setting.ball.trusted, setting.recording.position, np.nan)
    error = made.position - trusted[horizon.stamps]
    error = error[np.isfinite(error)]
    return {
        "motion_s": float(np.sum(setting.time[horizon.last] - setting.time[horizon.first])),
        "error_cam_max_m": max_error(reference),
        "error_cam_rms_m": rms_error(reference),
        "error_measured_max_m": max_error(error),
        "error_measured_rms_m": rms_error(error),
        "cpu_s": seconds,
        "steps": sum(one.steps for one in made.health),
        "slip_max_m_s": max((one.slip_max for one in made.health), default=None),
    }


def _run_of(setting: Setting, run: Run, horizon: Horizon) -> SourceRuns:
    """The source's runs on a horizon.

    Raises:
        EngineFailure: one of them failed.
        InputError: the engine refuses this combination of settings.
    """
    if run.source == CAM_SOURCE:
        return run_models(setting, [CAM], horizon)[0]
    engine = engine_of(run.source, setting.case.scene)
    own = {name.partition(".")[2]: value for name, value in run.values.items() if name.startswith(f"{run.source}.")}
    settings = {TIME_STEP: run.values[TIME_STEP], **engine_settings(setting.acting, run.source), **own}
    made = run_engine(setting, engine, parameters_of(engine, settings), horizon)
    if made.failures:
        raise made.failures[0]
    return made
