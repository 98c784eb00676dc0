"""The band of predictions by errors of held-out blocks."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from harness.identify.estimate.band import Band, Foreseen, fitted_band, widened
from harness.numerics import TWO_SIDED

AHEAD = np.linspace(0.05, 3.0, 60)
NOISE = 1e-3  # of a reading [m]


def blocks(count: int, factor: float, growth: float, seed: int) -> list[Foreseen]:
    """Blocks of errors with a band's variance, of a filter that foresees next to nothing in every other block."""
    generator = np.random.default_rng(seed)
    made = []
    for number in range(count):
        foreseen = (1e-3 if number % 2 else 1e-2) ** 2 * AHEAD**3
        deviation = np.sqrt(factor**2 * foreseen + growth * AHEAD + NOISE**2)
        made.append(Foreseen(deviation * generator.standard_normal(len(AHEAD)), foreseen, AHEAD))
    return made


@pytest.mark.parametrize(("factor", "growth"), [(1.0, 0.0), (3.0, 0.0), (1.0, 1e-4), (2.0, 4e-4)])
def test_errors_tell_factor_and_growth(factor: float, growth: float) -> None:
    """Find what errors exceed the foreseen deviations by, and what of them was not foreseen at all."""
    made = fitted_band(blocks(40, factor, growth, 1), NOISE**2)
    # 1200 independent errors of each kind: a deviation is known to 2 %, two that are told apart to 10 %
    assert made.factor == pytest.approx(factor, rel=0.1)
    assert np.sqrt(made.growth) == pytest.approx(np.sqrt(growth), rel=0.1, abs=5e-4)


def test_errors_that_nobody_foresaw_are_held() -> None:
    """Hold 95 % of errors of blocks in which the filter foresees none, which no factor on its deviation does."""
    known, further = blocks(40, 1.0, 1e-4, 2), blocks(400, 1.0, 1e-4, 3)[1::2]

    def held(band: Band) -> float:
        within = [
            np.abs(one.error) < TWO_SIDED * np.sqrt(band.variance(one.variance, one.ahead) + NOISE**2)
            for one in further
        ]
        return float(np.mean(within))

    assert held(fitted_band(known, NOISE**2)) == pytest.approx(0.95, abs=0.02)  # 12,000 readings: 0.002; the fit: 1 %
    ratios = [np.abs(one.error) / np.sqrt(one.variance + NOISE**2) for one in known]
    assert held(Band(float(np.quantile(np.concatenate(ratios), 0.95)) / TWO_SIDED)) < 0.9


def test_the_noise_of_readings_narrows_no_band() -> None:
    """Leave what is foreseen as it is where a reading's noise alone explains the errors, whatever the band."""
    noise = [replace(one, error=0.5 * NOISE * np.sin(np.arange(len(AHEAD)))) for one in blocks(8, 1.0, 0.0, 5)]
    assert fitted_band(noise, NOISE**2).factor == 1.0


def test_one_block_that_diverges_does_not_set_the_band() -> None:
    """Stay within half of the band's width without it where a prediction of one block of forty left the beam."""
    usual = blocks(40, 1.0, 1e-4, 4)
    lost = Foreseen(np.full(len(AHEAD), 100.0), usual[0].variance, AHEAD)
    before, after = (fitted_band(each, NOISE**2) for each in (usual, [*usual[1:], lost]))
    assert np.sqrt(after.growth) < 1.5 * np.sqrt(before.growth)
    assert after.factor < 1.5 * before.factor


@pytest.mark.parametrize("blocks", [4, 8, 16])
def test_a_band_of_few_blocks_holds_95_percent_of_a_further_one(blocks: int) -> None:
    """Be as wide as a further block needs where errors are alike within each; their plain quantile holds too little."""
    generator = np.random.default_rng(blocks)
    within, plain = [], []
    for _ in range(400):
        sizes = np.abs(generator.normal(size=blocks + 1))
        *known, further = [size * np.abs(1.0 + 0.3 * generator.standard_normal(60)) for size in sizes]
        within.append(np.mean(further <= widened(known)))
        plain.append(np.mean(further <= np.quantile(np.concatenate(known), 0.95)))
    # shares of single blocks scatter by some 0.2: a mean of 400 of them by 0.01
    assert np.mean(within) == pytest.approx(0.95, abs=0.03)
    assert np.mean(plain) < np.mean(within) - 0.01
