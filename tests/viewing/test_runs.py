from pathlib import Path

import numpy as np
import pytest

import harness
from analytic.effects import SensorLaw
from analytic.rig import Rig
from harness.api.saved import load_diagnosis
from harness.comparison import Choices, prepare
from harness.comparison.sources import run_engine
from harness.engines.catalogue import engine_of
from harness.recording import load_case
from harness.viewing.playback import Playback
from harness.viewing.rerun_log import name_of_run, title_of_run
from harness.viewing.runs import _lagging, rms_and_largest, run_with, run_without
from tests.acceptance.short import write_short_case
from tests.own_scenes import crank_and_link

SEED = Path(__file__).parents[2] / "benchmarks" / "fuzz" / "seeds" / "diagnosis.json"
NO_EFFECTS = {"effects": (), "spline_term": None, "parameters": (), "covariance": ()}


def test_without_a_diagnosis_the_run_is_that_of_a_comparison(tmp_path: Path) -> None:
    """Give the positions that `harness run` gives, and their error."""
    setting = prepare(load_case(write_short_case(tmp_path / "case")), Choices())
    engine = engine_of("mujoco")
    shown = run_without(setting, engine, {})
    whole = setting.horizons[0]
    compared = run_engine(setting, engine, engine.parameters(), whole).position
    # The same run of the same engine: nothing but rounding may differ.
    np.testing.assert_allclose(shown.position, compared, rtol=0.0, atol=1e-12)
    error = compared - setting.recording.position[whole.stamps]
    rms, largest = rms_and_largest(shown, setting.time, setting.recording.position)
    assert rms == pytest.approx(np.sqrt(np.nanmean(error**2)), rel=1e-9)
    assert largest == pytest.approx(np.nanmax(np.abs(error)), rel=1e-9)


def test_a_run_in_a_users_own_scene_says_what_decides_it(tmp_path: Path) -> None:
    """Name the user's file beside rig.toml, which has only the level angle and the effects to say there."""
    folder = write_short_case(tmp_path / "case")
    (folder / "rails.xml").write_text(crank_and_link(Rig()), encoding="utf-8")
    with (folder / "rig.toml").open("a", encoding="utf-8") as file:
        file.write('[scene]\nmjcf = "rails.xml"\nbeam_joint = "beam_hinge"\ndriven_joint = "motor"\n')
    case = load_case(folder)
    setting = prepare(case, Choices())
    own = run_without(setting, engine_of("mujoco", case.scene), {})
    known = setting.ball.trusted
    stamps, reading = setting.time[known], setting.recording.position[known]
    playback = Playback("mujoco", (own,), stamps, reading, 0.0, float(setting.time[-1]), simulated=True)
    assert own.name == "as rails.xml and rig.toml say"
    assert title_of_run(playback, 0) == "mujoco, simulated, as rails.xml and rig.toml say"
    assert name_of_run(playback, 0) == "mujoco_simulated/as_rails_xml_and_rig_toml_say"
    model = load_diagnosis(SEED).record.model.model_copy(update=NO_EFFECTS)
    nothing = run_with(setting, engine_of("mujoco", case.scene), {}, model, "")
    assert nothing.name == "as rails.xml says; no effects were found"
    assert run_without(setting, engine_of("mujoco"), {}).name == "as rig.toml says"


def test_a_lagging_sensor_begins_with_what_it_had() -> None:
    """Go from the first reading to the settled lag behind a uniform motion."""
    time = np.linspace(0.0, 1.0, 1001)
    position = 0.2 + 0.1 * time
    sensor = SensorLaw(lag=0.05)
    lagging = _lagging(time, position, sensor, 0.18)
    assert lagging[0] == pytest.approx(0.18, abs=1e-12)
    # T ẏ + y = s for s = s₀ + v t: y → s − v T, here after twenty time constants, which leave e⁻²⁰ of 25 mm.
    assert lagging[-1] == pytest.approx(position[-1] - 0.1 * 0.05, abs=1e-10)


@pytest.mark.slow
def test_with_a_diagnosis_the_error_is_that_of_its_engines() -> None:
    """Let the effects found act as they do where the diagnosis validates them, and begin where it does."""
    case = load_case(Path("open_ball_beam"))
    found = harness.diagnose(case)
    setting, engine = prepare(case, Choices()), engine_of("mujoco")
    shown = run_with(setting, engine, {}, found.record.model, "")
    reading = np.where(setting.ball.trusted, setting.recording.position, np.nan)
    rms, _ = rms_and_largest(shown, setting.time, reading)
    # The diagnosis takes steps of 2 ms, which cost at most 25 µm where friction stops the ball.
    after = found.record.errors.engines["mujoco"].after.rms_m["whole"]
    assert rms == pytest.approx(after, abs=25e-6)
    before, _ = rms_and_largest(run_without(setting, engine, {}, beside=True), setting.time, reading)
    assert before > 2.0 * rms


def test_a_run_has_the_beam_of_its_diagnosis(tmp_path: Path) -> None:
    """Turn the beam as roughly as the diagnosis found that it moves; without one, as a comparison does."""
    setting, engine = prepare(load_case(write_short_case(tmp_path / "case")), Choices()), engine_of("mujoco")
    model = load_diagnosis(SEED).record.model.model_copy(update={"roughness": 100.0})
    beams = [
        run.motion.evaluate(setting.time)
        for run in (run_without(setting, engine, {}), run_with(setting, engine, {}, model, ""))
    ]
    np.testing.assert_array_equal(beams[0], setting.drive.evaluate(setting.time))
    np.testing.assert_array_equal(beams[1], setting.drive.rougher(100.0).evaluate(setting.time))
    assert np.any(beams[0] != beams[1])
