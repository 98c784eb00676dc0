"""What a run leaves behind: trajectories.csv, metrics.csv, manifest.json, report.html."""

from __future__ import annotations

import json
import platform
import sys
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from importlib.metadata import version
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np
import pydantic_core

from analytic.motion import FloatArray
from harness.provenance import SEAL, seal_of
from harness.recording.case import RIG_FILE, case_name

if TYPE_CHECKING:
    import pandas as pd

    from harness.comparison import Study

_PACKAGES = ("numpy", "scipy", "pandas", "numba", "matplotlib", "pydantic")


def report_folder(case: Path) -> Path:
    """Where the results of a case go unless the user says otherwise: `reports/<name of the case>`."""
    return Path("reports") / case_name(case)


def trajectories(study: Study) -> pd.DataFrame:
    """Free runs of every source beside the measurement: `time_s`, `measured_m`, then `<source>_m` [m]."""
    import pandas as pd  # takes a second, which only tables of mixed columns are worth

    whole = study.setting.horizons[0]
    table = {"time_s": study.setting.time, "measured_m": study.setting.recording.position}
    for source in study.sources:
        table[f"{source}_m"] = np.full(len(study.setting.time), np.nan)
        table[f"{source}_m"][whole.stamps] = study.run_of(source, whole).position
    return pd.DataFrame(table)


def metrics(study: Study, own: Mapping[str, Sequence[float]] = MappingProxyType({})) -> pd.DataFrame:
    """One row a source and horizon; columns are the fields of `harness.metrics.Score`, then the user's own metrics."""
    import pandas as pd

    return pd.DataFrame([asdict(score) for score in study.scores]).assign(**own)


def manifest(study: Study, *, command: str, wall_time: float) -> dict[str, Any]:
    """What is needed to repeat the run: hashes of inputs, versions, settings, seed; wall time [s]."""
    setting = study.setting
    return {
        "schema": 1,
        "command": command,
        "case": str(setting.case.path),
        "origin": setting.case.origin,
        "inputs": {
            **{one.name: one.sha256 for one in setting.used},
            **({RIG_FILE: setting.case.sha256} if setting.case.sha256 else {}),
            **(setting.case.scene.sha256 if setting.case.scene else {}),
        },
        "versions": {
            "harness": version("ball-beam-harness"),
            "python": platform.python_version(),
            "platform": f"{sys.platform} {platform.machine()}",
            **{name: version(name) for name in _PACKAGES},
            **{engine.name: engine.version() for engine, _ in study.engines},
        },
        "settings": {
            "rig": asdict(setting.rig),
            "estimates": [asdict(one) for one in setting.estimates],
            "start": asdict(setting.start),
            "horizons": [one.name for one in setting.horizons],
            "headline": study.headline.name,
            "recording": setting.recording.name,
            "draws": setting.choices.draws,
            "tolerance_m": setting.choices.tolerance,
            "engines": {engine.name: parameters.model_dump() for engine, parameters in study.engines},
            "scenes": {engine.name: engine.scene_file for engine, _ in study.engines if engine.scene_file},
        },
        "seed": setting.choices.seed,
        "lift_off": dict(study.lift_offs),
        "failures": [str(failure) for failure in study.failures],
        "wall_time_s": round(wall_time, 3),
    }


def to_json(value: Any) -> str:
    """JSON text, also of dataclasses; numbers that are not finite become null, as JSON has none."""
    return pydantic_core.to_json(value, indent=2, inf_nan_mode="null", fallback=lambda one: one.item()).decode()


def sealed_json(content: Mapping[str, Any]) -> str:
    """JSON text of a command's record, with the digest of its own content (`harness.api.writing`)."""
    plain = json.loads(to_json(content))
    return to_json(plain | {SEAL: seal_of(plain)}) + "\n"


def write_csv(table: pd.DataFrame, file: Path) -> None:
    """Write columns of numbers with six decimals: micrometres, microradians, microseconds."""
    table.to_csv(file, index=False, float_format="%.6f")


def write_columns(table: Mapping[str, FloatArray], file: Path) -> None:
    """As `write_csv`, columns without gaps, shape (n,) each, for which importing pandas would take longer."""
    np.savetxt(file, np.column_stack(list(table.values())), "%.6f", ",", header=",".join(table), comments="")


def write_tables(study: Study, folder: Path, own: Mapping[str, Sequence[float]] = MappingProxyType({})) -> None:
    """Write trajectories.csv (micrometres) and metrics.csv (seven digits) into `folder`."""
    write_csv(trajectories(study), folder / "trajectories.csv")
    metrics(study, own).to_csv(folder / "metrics.csv", index=False, float_format="%.7g")
