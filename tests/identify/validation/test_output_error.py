"""Free runs of output-error models: slopes in closed form against differences."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from harness.identify.problem.problem import PreparedRecording
from harness.identify.problem.windows import windows_of
from harness.identify.validation.output_error import OutputError, _FreeRuns, _Stack
from harness.signals.drive import make_drive

STEP = 0.02  # [s]


def _stack(jitter: float) -> _Stack:
    """Windows of a noisy recording with gaps, its stamps off the grid by up to `jitter` of a step."""
    rng = np.random.default_rng(0)
    time = STEP * (np.arange(851) + rng.uniform(0.0, jitter, 851))
    angle = 0.03 * np.sin(1.1 * time) + 0.02 * np.sin(2.7 * time + 1.0) + 0.01 * np.sin(6.3 * time)
    reading = np.where(rng.uniform(size=851) < 0.05, np.nan, np.cumsum(angle) * STEP + rng.normal(0.0, 0.01, 851))
    windows = windows_of((PreparedRecording("made", time, reading, make_drive(time, angle)),))
    return _Stack.of(windows, [np.isfinite(window.reading) for window in windows])


@pytest.mark.parametrize("jitter", [0.0, 0.3], ids=["even", "uneven"])
@pytest.mark.parametrize("poles", [(1.2, 9.0), (0.8, -0.9), (0.0, 0.0), (1.2, 9.0, 3.0)])
def test_slopes_give_the_gradient(poles: tuple[float, ...], jitter: float) -> None:
    """Point the search down the sum of squares, for poles of all kinds.

    Differences over 2 h have errors of h² and of rounding over h.
    """
    stack, h = _stack(jitter), 1e-4
    runs = _FreeRuns(OutputError(poles), stack)

    def cost(moved: np.ndarray) -> float:
        return 0.5 * float(np.sum(_FreeRuns(OutputError(tuple(moved)), stack).residuals ** 2))

    moves = h * np.eye(len(poles))
    differences = [(cost(poles + move) - cost(poles - move)) / (2.0 * h) for move in moves]
    np.testing.assert_allclose(
        runs.slopes.T @ runs.residuals, differences, rtol=1e-4, atol=1e-7 * cost(np.array(poles))
    )


def test_windows_do_not_pass_on_to_each_other() -> None:
    """Respond in every window as in that window alone."""
    rng = np.random.default_rng(1)
    time = STEP * np.arange(851)
    record = PreparedRecording("made", time, rng.normal(size=851), make_drive(time, 0.03 * np.sin(1.1 * time)))
    windows = windows_of((record, replace(record, time=time + 0.3)))
    every = [np.ones(len(window.time), dtype=np.bool_) for window in windows]
    law = OutputError((1.2, 9.0, 3.0))
    together = _FreeRuns(law, _Stack.of(windows, every))
    for number, window in enumerate(windows):
        np.testing.assert_allclose(together._driven[number], law.driven(window), rtol=1e-9, atol=1e-12)
