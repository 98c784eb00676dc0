"""Where the data lie that are too large or not free to be part of the repository; tests that need them skip without."""

from pathlib import Path

SHARED = Path(__file__).resolve().parents[2] / "shared"
CASES, RECORDINGS = SHARED / "cases", SHARED / "recordings"
