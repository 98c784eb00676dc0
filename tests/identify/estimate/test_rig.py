"""What the rig file leaves open is estimated, and the stated standard errors hold."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from analytic.effects import ROLLING_RESISTANCE
from analytic.motion import FloatArray
from harness.comparison import Choices, prepare
from harness.errors import InputError
from harness.recording import load_case
from harness.simulator import Plant
from tests.comparison.made import COARSE, FINE, HIDDEN, KNOWN, RIG, Made, sensors, steps, swing, write_case

LEVEL = -0.0028  # the paper's −0.16° [rad]
RESISTANCE = 0.0035
TRUTH = np.array([RIG.rolling_ratio, LEVEL, RIG.lever])


def hidden_rig(folder: Path, make: object, counts: int, resistance: float, seed: int) -> Made:
    """Two recordings of a rig of which only gravity is known."""
    plant, used = Plant(rig=RIG.with_(level_angle=LEVEL), rolling_resistance=resistance), sensors(counts)
    recordings = [make(2 * seed + number, plant, used) for number in range(2)]  # type: ignore[operator]
    return write_case(folder / str(seed), recordings, used, known=HIDDEN)


def z_scores(folder: Path, make: object, counts: int, resistance: float, seeds: range) -> FloatArray:
    """(estimate − truth)/standard error of K, α₀ and ℓ, a row a seed."""
    rows = []
    for seed in seeds:
        fitted = hidden_rig(folder, make, counts, resistance, seed).prepare().fitted
        assert fitted is not None
        rows.append((np.array([fitted.ratio, fitted.level, fitted.lever]) - TRUTH) / fitted.std)
        friction, error = fitted.beside[ROLLING_RESISTANCE]
        assert friction == pytest.approx(resistance, abs=4.0 * error + 0.02 * resistance)
    return np.array(rows)


@pytest.mark.slow
def test_estimates_cover_the_truth_under_rolling_resistance(tmp_path: Path) -> None:
    """Find K, α₀ and ℓ within their standard errors although the ball sticks and slips from rest."""
    z = z_scores(tmp_path, steps, FINE, RESISTANCE, range(6))
    # Of 18 numbers within 2σ at 95 % each, fewer than 15 are met once in 600 tries.
    assert np.sum(np.abs(z) < 2.0) >= 15
    assert np.max(np.abs(z)) < 4.0


@pytest.mark.slow
@pytest.mark.parametrize(
    ("make", "counts", "resistance"),
    # Half of all combinations: every two levels of every two factors meet.
    [(steps, FINE, 0.0), (steps, COARSE, RESISTANCE), (swing, FINE, RESISTANCE), (swing, COARSE, 0.0)],
    ids=["steps-fine-free", "steps-coarse-resisted", "swing-fine-resisted", "swing-coarse-free"],
)
def test_estimates_cover_the_truth(tmp_path: Path, make: object, counts: int, resistance: float) -> None:
    """Cover each of K, α₀ and ℓ as often as 95 % intervals do, within chance, by error bars that are not idle."""
    z = z_scores(tmp_path, make, counts, resistance, range(12, 28))
    # At 95 % coverage fewer than 13 hits in 16 happen once in 143 tries, at 50 % coverage 13 or more once in 94.
    assert np.all(np.sum(np.abs(z) < 2.0, axis=0) >= 13)
    # Not idle: a standard error three times too long would show a root mean square below 1/3.
    assert np.all(np.sqrt(np.mean(z**2, axis=0)) > 1.0 / 3.0)


def test_a_level_angle_is_found_beside_friction(shared: Path) -> None:
    """Find the level angle of a simulated rig with rolling resistance, −0.3°, to a thousandth of a degree."""
    setting = prepare(load_case(shared / "cases" / "level"), Choices(level_angle="estimate"))
    fitted = setting.fitted
    assert fitted is not None
    truth = -0.005235987755982988
    assert abs(fitted.level - truth) < 2.5 * fitted.std[1]
    assert fitted.std[1] < 2e-5
    # The case declares its friction, 0.002, so that nothing is left; it only has to be out of the way.
    assert fitted.beside[ROLLING_RESISTANCE][0] == pytest.approx(0.0, abs=5e-5)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["null_plain", "null_declared_paper_encoder", "rolling"])
def test_a_level_rig_is_found_level(shared: Path, name: str) -> None:
    """Find no level angle where there is none."""
    fitted = prepare(load_case(shared / "cases" / name), Choices(level_angle="estimate")).fitted
    assert fitted is not None
    assert abs(fitted.level) < 2.5 * fitted.std[1]


def test_only_what_is_asked_for_is_estimated(tmp_path: Path) -> None:
    """Keep K and ℓ of the rig file, with zero standard error."""
    plant, used = Plant(rig=RIG.with_(level_angle=LEVEL)), sensors(FINE)
    made = write_case(tmp_path, [swing(3, plant, used)], used)
    setting = made.prepare(level_angle="estimate")
    assert setting.fitted is not None
    assert (setting.fitted.ratio, setting.fitted.lever) == (RIG.rolling_ratio, RIG.lever)
    assert setting.fitted.covariance[0, 0] == setting.fitted.covariance[2, 2] == 0.0
    assert [one.name for one in setting.estimates] == ["level angle α₀"]
    assert abs(setting.rig.level_angle - LEVEL) < 3.0 * setting.estimates[0].std
    assert made.prepare().fitted is None  # nothing is unknown, nothing asked for: α₀ is 0


def test_a_weak_recording_says_so(tmp_path: Path) -> None:
    """Assume a pivot in the edge plane if a slow beam does not identify it."""
    plant, used = Plant(), sensors(COARSE, noise=5e-3)
    known = {key: value for key, value in KNOWN.items() if key != "eccentricity_m"}
    setting = write_case(tmp_path, [swing(4, plant, used, 3.0)], used, known=known).prepare()
    (note,) = [one for one in setting.estimates if one.name == "eccentricity h"]
    assert (note.value, note.std, setting.rig.eccentricity) == (0.0, np.inf, 0.0)
    assert "too weak" in note.how


def test_a_reversed_angle_is_refused(tmp_path: Path) -> None:
    """Refuse a recording in which the ball climbs, and name the convention."""
    plant, used = Plant(), sensors(FINE)
    made = write_case(tmp_path, [swing(5, plant, used)], used, known=HIDDEN)
    file = tmp_path / "rec_01.csv"
    table = np.genfromtxt(file, delimiter=",", skip_header=1)
    table[:, 1] *= -1.0
    np.savetxt(file, table, delimiter=",", header="time_s,beam_angle_rad,ball_position_m", comments="", fmt="%.7f")
    with pytest.raises(InputError, match=r"α > 0 must lower the \+s end"):
        made.prepare()
