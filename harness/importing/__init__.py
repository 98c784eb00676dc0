"""Recordings of other programs and instruments: readers, what their columns mean, what is written of them."""

from harness.importing.choices import Ambiguity, Choice, Linkage, Options
from harness.importing.read import read_file
from harness.importing.signals import Group, Signal, SourceFile
from harness.importing.understand import Understood, understand

__all__ = [
    "Ambiguity",
    "Choice",
    "Group",
    "Linkage",
    "Options",
    "Signal",
    "SourceFile",
    "Understood",
    "read_file",
    "understand",
]
