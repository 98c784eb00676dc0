"""Where recordings lie: one measured rig that is free (MIT), a built-in case, and those beside the repository.

What lies beside is too large or not free to be part of it; tests that need it skip without, and each has a twin that
runs on the bundled rig or on one that the virtual rig makes.
"""

from pathlib import Path

from harness.recording.case import MEASURED

SHARED = Path(__file__).resolve().parents[2] / "shared"
CASES, RECORDINGS = SHARED / "cases", SHARED / "recordings"
BUNDLED_RIG = MEASURED


def measured_rigs() -> list[Path]:
    """Case folders of real rigs: the bundled one, and those beside the repository where they are."""
    beside = sorted(path.parent for path in RECORDINGS.glob("*/rig.toml"))
    return [BUNDLED_RIG, *(path for path in beside if path.name != BUNDLED_RIG.name)]
