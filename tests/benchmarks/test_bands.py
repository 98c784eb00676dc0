"""The table of prediction bands, from rows made by hand."""

from __future__ import annotations

import pytest

from benchmarks.bands import Row, measured, page, trials


def test_shares_are_means_over_recordings_and_errors_their_root_mean_squares() -> None:
    """Count every recording once, whatever its length, by record and by whether an effect is hidden."""
    rows = [
        Row("fine encoder", False, (1.0, 1.0, 1.0), 1.0, 0.5, 3e-3, 1e-3),
        Row("fine encoder", False, (1.0, 0.5, 0.0), 0.2, 1.5, 4e-3, 7e-3),
        Row("imperfect", True, (1.0, 1.0, 0.9), 0.95, 0.7, 1e-3, 1e-3),
    ]
    lines = page(rows, "abc").splitlines()
    # √((9 + 16)/2) and √((1 + 49)/2) mm; of two recordings the bootstrap draws one twice in a quarter of its draws each
    assert "| fine encoder | nothing | 2 | 100% | 75% | 50% | 60% (20%–100%) | 1.00 | 3.54 | 5.00 |" in lines
    assert "| imperfect | an effect | 1 | 100% | 100% | 90% | 95% (95%–95%) | 0.70 | 1.00 | 1.00 |" in lines
    assert lines[-1].startswith("| all | all | 3 |")


def test_a_third_of_the_rigs_hide_an_effect_and_a_third_have_imperfect_records() -> None:
    """Take as many of each, no effect twice before each came once, and every other imperfect record with one."""
    wanted = trials(31)
    perfect, imperfect = ([one for one in wanted if bool(one.imperfection) is each] for each in (False, True))
    names = [name for one in perfect for name in one.hidden]
    assert (len(perfect), len(imperfect)) == (21, 10)
    assert len(names) == 10 == len(set(names))
    assert sum(bool(one.hidden) for one in imperfect) == 5


@pytest.mark.slow
def test_a_rig_without_hidden_effect_is_predicted_within_its_band() -> None:
    """Hold most of what truly happened in the band, from the first second on."""
    row = measured(trials(3)[0])
    assert row is not None
    assert not row.hidden
    assert row.whole > 0.8
    assert row.error < 5e-3
