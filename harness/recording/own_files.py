"""CSV files that the harness writes itself, which lie beside recordings and are none."""

from pathlib import Path

NEXT_EXPERIMENT = "next_experiment.csv"
"""Name of a proposed experiment, whose columns are those of a recording."""
PREDICTED = ("time_s", "ball_position_m", "low_m", "high_m")
"""Columns of a prediction, whatever its name."""
OWN_FILES = "own-files"
"""Code of the note on them."""
_FIRST_COLUMNS = (",".join(PREDICTED), "time_s,measured_m,", "source,horizon,")
"""With which a prediction, trajectories.csv and metrics.csv begin."""


def is_own(file: Path) -> bool:
    """Whether the harness wrote this file: by the name of an experiment, or by the columns of a result."""
    if file.name == NEXT_EXPERIMENT:
        return True
    try:
        with file.open(encoding="utf-8", errors="replace") as lines:
            return lines.readline(200).startswith(_FIRST_COLUMNS)
    except OSError:  # what cannot be read is said where it is read as a recording
        return False
