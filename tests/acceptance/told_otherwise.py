"""Cases that say the same in another way: mirrored, in other units, later, in another order, less often read."""

from __future__ import annotations

import re
import shutil
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from analytic.motion import FloatArray

HEADER = "time_s,beam_angle_rad,ball_position_m"


@dataclass(frozen=True)
class Change:
    """A way to say the same.

    Attributes:
        rows: what becomes of a recording's rows: time, angle and position, shape (n, 3); NaN where blank.
        header: names of the columns afterwards.
        rig_file: what becomes of the text of rig.toml.
    """

    rows: Callable[[FloatArray], FloatArray]
    header: str = HEADER
    rig_file: Callable[[str], str] = lambda text: text

    def of(self, case: Path, to: Path) -> Path:
        """The case, changed, as a new folder."""
        shutil.copytree(case, to)
        for file in to.glob("rec_*.csv"):
            rows = self.rows(np.genfromtxt(file, delimiter=",", skip_header=1))
            lines = [",".join("" if np.isnan(x) else repr(float(x)) for x in row) for row in rows]
            file.write_text("\n".join([self.header, *lines]) + "\n", encoding="utf-8", newline="\n")
        rig = to / "rig.toml"
        rig.write_text(self.rig_file(rig.read_text(encoding="utf-8")), encoding="utf-8")
        return to


def _mirrored(text: str) -> str:
    """The declared level and where a declared bump is, with the opposite sign."""
    return re.sub(r"(?m)^((?:level_angle_rad|centre) = )(.*)$", lambda found: f"{found[1]}{-float(found[2])!r}", text)


def _other_order(text: str) -> str:
    return text.replace('"rec_01.csv", "rec_02.csv"', '"rec_02.csv", "rec_01.csv"')


MIRROR = Change(lambda rows: rows * [1.0, -1.0, -1.0], rig_file=_mirrored)
UNITS = Change(lambda rows: rows * [1e3, np.degrees(1.0), 1e3], "time_ms,beam_angle_deg,ball_position_mm")
LATER = Change(lambda rows: rows + np.array([1000.0, 0.0, 0.0]))
OTHER_ORDER = Change(lambda rows: rows, rig_file=_other_order)
EVERY_SECOND = Change(lambda rows: rows[::2])
SHUFFLED = Change(lambda rows: np.random.default_rng(1).permutation(rows))
