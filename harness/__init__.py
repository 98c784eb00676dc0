"""Cross-validation of ball-and-beam models and engines against recordings.

    import harness

    case = harness.load_case("my_rig/")
    comparison = harness.compare(case)
    diagnosis = harness.diagnose(case, progress=True)
    prediction = diagnosis.predict("swing_07.csv")

The names below are imported when they are first used: `import harness` itself takes no time.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from analytic.effects import Acting, Effect, Force, Parameter
    from harness.api.case import Case, load_case
    from harness.api.check import Check, check
    from harness.api.comparison import Comparison, compare
    from harness.api.compilation import Compilation, compile_kernels
    from harness.api.diagnosis import Diagnosis, diagnose
    from harness.api.doctor import Doctor, doctor
    from harness.api.export import Export, export
    from harness.api.importing import Imported, import_recording
    from harness.api.replay import Replayed, replay
    from harness.api.saved import LoadedDiagnosis, load_diagnosis
    from harness.api.scene import SceneCheck, check_scene
    from harness.api.sweep import Sweep, sweep
    from harness.api.tuning import Tuning, tune
    from harness.api.view import View, view
    from harness.errors import EngineFailure, HarnessError, InputError

_NAMES = {  # in the order of docs/api.md
    "harness.api.case": ("load_case", "Case"),
    "harness.api.importing": ("import_recording", "Imported"),
    "harness.api.check": ("check", "Check"),
    "harness.api.comparison": ("compare", "Comparison"),
    "harness.api.diagnosis": ("diagnose", "Diagnosis"),
    "harness.api.saved": ("load_diagnosis", "LoadedDiagnosis"),
    "harness.api.export": ("export", "Export"),
    "harness.api.replay": ("replay", "Replayed"),
    "harness.api.tuning": ("tune", "Tuning"),
    "harness.api.sweep": ("sweep", "Sweep"),
    "harness.api.view": ("view", "View"),
    "harness.api.scene": ("check_scene", "SceneCheck"),
    "harness.api.compilation": ("compile_kernels", "Compilation"),
    "harness.api.doctor": ("doctor", "Doctor"),
    "analytic.effects": ("Effect", "Parameter", "Force", "Acting"),
    "harness.errors": ("HarnessError", "InputError", "EngineFailure"),
}
_MODULES = {name: module for module, names in _NAMES.items() for name in names}

__all__ = [
    "Acting",
    "Case",
    "Check",
    "Comparison",
    "Compilation",
    "Diagnosis",
    "Doctor",
    "Effect",
    "EngineFailure",
    "Export",
    "Force",
    "HarnessError",
    "Imported",
    "InputError",
    "LoadedDiagnosis",
    "Parameter",
    "Replayed",
    "SceneCheck",
    "Sweep",
    "Tuning",
    "View",
    "check",
    "check_scene",
    "compare",
    "compile_kernels",
    "diagnose",
    "doctor",
    "export",
    "import_recording",
    "load_case",
    "load_diagnosis",
    "replay",
    "sweep",
    "tune",
    "view",
]


def __getattr__(name: str) -> Any:
    """The public names, imported when they are first asked for (PEP 562)."""
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = globals()[name] = getattr(importlib.import_module(_MODULES[name]), name)
    return value


def __dir__() -> list[str]:
    """The public names, imported or not."""
    return sorted({*globals(), *__all__})
