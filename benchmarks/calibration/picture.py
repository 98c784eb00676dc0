"""The confusion at each size as a picture."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from benchmarks.calibration.sizes import SCALES
from benchmarks.calibration.tables import ELSEWHERE

_DPI = 80


def draw(confusions: Mapping[str, pd.DataFrame], path: Path) -> None:
    """One panel a size: share of the trials of what acts (lines) in which something was named (columns)."""
    columns = [*SCALES, *ELSEWHERE]
    figure = Figure(figsize=(1.6 + 4.6 * len(confusions), 5.6), layout="constrained")
    for at, (size, table) in enumerate(confusions.items()):
        axes = figure.add_subplot(1, len(confusions), at + 1)
        counts = table.set_index("acts").reindex(list(SCALES))[columns].to_numpy(float)
        with np.errstate(invalid="ignore"):
            shares = counts / counts.sum(axis=1, keepdims=True)
        image = axes.imshow(np.ma.masked_invalid(shares), cmap="Blues", vmin=0.0, vmax=1.0, aspect="auto")
        axes.set_xticks(range(len(columns)), columns, rotation=90, fontsize=7)
        axes.set_yticks(range(len(SCALES)), list(SCALES) if at == 0 else [], fontsize=7)
        axes.axvline(len(SCALES) - 0.5, color="0.6", linewidth=0.8)
        axes.set_title(f"{size} effects", fontsize=9)
        axes.set_xlabel("named", fontsize=8)
        if at == 0:
            axes.set_ylabel("acts", fontsize=8)
        if at == len(confusions) - 1:
            figure.colorbar(image, ax=axes, label="share of trials")
    # without the program's version, so that the file changes with its content only
    figure.savefig(path, dpi=_DPI, metadata={"Software": None})
