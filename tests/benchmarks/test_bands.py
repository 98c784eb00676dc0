"""The table of prediction bands, from rows made by hand."""

from __future__ import annotations

import pytest

from benchmarks.bands import Row, measured, page, trials


def test_shares_are_means_over_recordings_and_errors_their_root_mean_squares() -> None:
    """Count every recording once, whatever its length, by encoder and by whether an effect is hidden."""
    rows = [
        Row("fine", False, (1.0, 1.0, 1.0), 1.0, 0.5, 3e-3, 1e-3),
        Row("fine", False, (1.0, 0.5, 0.0), 0.2, 1.5, 4e-3, 7e-3),
        Row("paper's", True, (1.0, 1.0, 0.9), 0.95, 0.7, 1e-3, 1e-3),
    ]
    lines = page(rows, "abc").splitlines()
    # √((9 + 16)/2) and √((1 + 49)/2) mm; of two recordings the bootstrap draws one twice in a quarter of its draws each
    assert "| fine | nothing | 2 | 100% | 75% | 50% | 60% (20%–100%) | 1.00 | 3.54 | 5.00 |" in lines
    assert "| paper's | an effect | 1 | 100% | 100% | 90% | 95% (95%–95%) | 0.70 | 1.00 | 1.00 |" in lines
    assert lines[-1].startswith("| all | all | 3 |")


def test_half_of_the_rigs_hide_an_effect() -> None:
    """Take as many with an effect of middle size as without, no effect twice before each came once."""
    wanted = trials(20)
    names = [name for one in wanted for name in one.hidden]
    assert len(wanted) == 20
    assert len(names) == 10 == len(set(names))


@pytest.mark.slow
def test_a_rig_without_hidden_effect_is_predicted_within_its_band() -> None:
    """Hold most of what truly happened in the band, from the first second on."""
    row = measured(trials(4)[0])
    assert not row.hidden
    assert row.whole > 0.8
    assert row.error < 5e-3
