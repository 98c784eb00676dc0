"""Reads and validates the input: `rig.toml` and CSV recordings become checked arrays, or an `InputError`."""

from harness.recording.case import Case, load_case
from harness.recording.findings import DataFinding
from harness.recording.known_rig import Declared, KnownRig, Sensors
from harness.recording.recording import Recording, load_recording
from harness.recording.resolution import inferred_resolution

__all__ = [
    "Case",
    "DataFinding",
    "Declared",
    "KnownRig",
    "Recording",
    "Sensors",
    "inferred_resolution",
    "load_case",
    "load_recording",
]
