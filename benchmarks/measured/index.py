"""The table of all measured rigs: held-out errors by source, and the model over the best baseline."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

from benchmarks.measured.page import LABELS, Rig, millimetres, table
from harness.formatting import NONE, number
from harness.identify.validation.baseline_comparison import AFTER, BASELINES, BEFORE, FORECASTS
from harness.identify.validation.baselines import BLACK_BOXES

SIMPLE = tuple(name for name in BASELINES if name not in BLACK_BOXES)
_ABOUT = (
    "Written by `make measured RECORDINGS=…` from recordings of real rigs; nothing on this page is simulated. What "
    "acts on these rigs is not known to anyone: held-out errors tell how well a model predicts, and not whether the "
    "effects it names are those that act."
)
_LEGEND = (
    "RMS error over held-out blocks: 3 s predicted from the angle and the positions of the 2 s before, every source "
    "fitted to the same windows ([diagnosis](diagnosis.md#diagnosisjson)). The least error of a rig is bold. Simple "
    "baselines: ball at rest, ball at constant velocity, double integrator. The output-error models are black boxes "
    "fitted to the forecast: in closed loop they may read the controller backwards. Below 1, the model with the "
    "effects found predicts better; its parameters are fitted to forecasts where these predict better "
    "([predictions](diagnosis.md#parameters-for-predictions)); if its predictions are kept "
    "where the ball was recorded, so are those of every baseline ([ends](diagnosis.md#where-predictions-stay))."
)
_FREE = (
    "Only open_ball_beam comes with this program (MIT licence, Copyright (c) 2021 Benjamin Gravell, notice in "
    "`harness/data/open_ball_beam/`): `harness diagnose open_ball_beam`. The other recordings are not free to be "
    "passed on; their pages name the sources."
)


def geometric_mean(values: Iterable[float]) -> float:
    """Of the finite ones; NaN if there are none."""
    logs = [math.log(value) for value in values if math.isfinite(value) and value > 0.0]
    return math.exp(sum(logs) / len(logs)) if logs else math.nan


def index(rigs: Sequence[Rig], folder: str) -> str:
    """The page in Markdown.

    Args:
        folder: of the pages on the rigs, beside this one.
    """
    sources = (BEFORE, AFTER, FORECASTS, *BASELINES)
    rows = [
        (
            f"[{rig.case.name}]({folder}/{rig.case.name}.md)",
            number(rig.length),
            str(rig.compared.blocks) if rig.compared is not None else NONE,
            *(_marked(rig, source) for source in sources),
            _ratio(rig.ratio(SIMPLE)),
            _ratio(rig.ratio(BASELINES)),
        )
        for rig in rigs
    ]
    means = [_ratio(geometric_mean(rig.ratio(among) for rig in rigs)) for among in (SIMPLE, BASELINES)]
    rows.append(("geometric mean", "", "", *("" for _ in sources), *(f"**{mean}**" for mean in means)))
    heads = (
        "rig", "length [s]", "blocks", *(f"{LABELS[source]} [mm]" for source in sources),
        "model / best simple baseline", "model / best baseline",
    )  # fmt: skip
    verdicts = table(
        ("rig", "what was found"), [(rig.case.name, rig.diagnosis.sentence.replace("|", "\\|")) for rig in rigs], left=2
    )
    return (
        "\n\n".join(["# Measured rigs", _ABOUT, table(heads, rows), _LEGEND, "## What was found", verdicts, _FREE])
        + "\n"
    )


def _marked(rig: Rig, source: str) -> str:
    text = millimetres(rig.error(source))
    compared = rig.compared
    return f"**{text}**" if compared is not None and source == rig.best(compared.rms_m) else text


def _ratio(value: float) -> str:
    return number(value, 2) if math.isfinite(value) else NONE
