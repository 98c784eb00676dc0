"""The FMU in FMPy: description without a problem, and the run of our own kernel."""

from __future__ import annotations

import shutil
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave
from fmpy.validation import validate_fmu

from analytic.effects import SensorLaw, acting
from analytic.motion import beam_states
from analytic.quintic import QuinticMotion
from harness.api.case import load_case
from harness.errors import InputError
from harness.exports.carried import in_source
from harness.exports.fmu import VARIABLES, Fmi, fmu_bytes
from harness.exports.model import of_effects
from harness.preparation.recordings import observe
from tests.exports.exported import RIG, effect, ours

MICROMETRE = 1e-6
STEP = 5e-3  # between communication points [s]
BUNDLED = Path(__file__).parents[2] / "harness" / "data" / "paper_protocol"
SETS = {
    "nothing": (),
    "friction": ("rolling_resistance", "level_error", "viscous_damping"),
    "lags": ("angle_gain", "angle_lag", "position_lag", "angle_hold"),
    "servo": ("angle_servo",),
    "delay": ("channel_delay", "position_gain"),
}


@pytest.mark.slow
@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("which", SETS)
def test_fmu_runs_as_our_own_kernel(fmi: Fmi, which: str, tmp_path: Path) -> None:
    """Simulate the drive of a bundled recording, and stay within a micrometre of our own run."""
    effects = [effect(name) for name in SETS[which]]
    model = of_effects(RIG, effects)
    file = tmp_path / "ball_beam.fmu"
    file.write_bytes(fmu_bytes(model, fmi, "read me"))
    assert validate_fmu(str(file)) == []
    case = load_case(BUNDLED)
    drive = observe(case.recordings["rec_01.csv"], case.sensors, RIG).drive
    time = np.array(drive.time)
    # Twice as dense as the rows. What the FMU does not know is how the angular acceleration goes on within a step; at
    # steps of 10 ms that is up to 1.5 µm, and falls with the third power.
    dense = np.arange(time[0], time[-1] + 0.5 * STEP, STEP)
    names = ("time", "angle", "rate", "angular_acceleration")
    rows = np.column_stack((dense, beam_states(drive, np.minimum(dense, time[-1]))))
    signals = np.array([tuple(row) for row in rows], dtype=[(name, np.float64) for name in names])
    told = fmpy.simulate_fmu(
        str(file),
        start_time=time[0],
        stop_time=time[-1],
        output_interval=STEP,
        input=signals,
        start_values={"start_position": 0.3},
        output=["position"],
    )
    # Our kernel with the same steps: with others a ball that friction holds breaks loose at another instant.
    expected = ours(RIG, effects, QuinticMotion(dense, rows[:, 1:]), 0.3)
    expected = SensorLaw(delay=model.sensor.delay).recorded(dense, expected) if model.sensor.delay else expected
    np.testing.assert_allclose(told["time"], dense, atol=1e-9)
    np.testing.assert_allclose(told["position"], expected, atol=MICROMETRE)


def test_a_step_can_be_made_again(tmp_path: Path) -> None:
    """Repeat a step with another size as if it were the first, and refuse to go back in time."""
    file = tmp_path / "ball_beam.fmu"
    file.write_bytes(fmu_bytes(of_effects(RIG, [effect("channel_delay")]), 2, ""))
    token, folder = fmpy.read_model_description(str(file)).guid, fmpy.extract(str(file), str(tmp_path / "fmu"))
    number = {one.name: one.number for one in VARIABLES}
    outputs = [number[name] for name in ("position", "ball_position", "ball_velocity")]

    def begun() -> FMU2Slave:
        one = FMU2Slave(guid=token, unzipDirectory=folder, modelIdentifier="ball_beam", instanceName="one")
        one.instantiate()
        one.setupExperiment(startTime=0.0)
        one.enterInitializationMode()
        one.setReal([number["start_position"], number["angle"]], [0.3, 0.02])
        one.exitInitializationMode()
        return one

    again, straight = begun(), begun()
    for one, steps in ((again, [(0.0, 0.01), (0.01, 0.02), (0.01, 0.05)]), (straight, [(0.0, 0.01), (0.01, 0.05)])):
        for time, step in steps:
            one.doStep(currentCommunicationPoint=time, communicationStepSize=step)
    assert again.getReal(outputs) == straight.getReal(outputs)
    with pytest.raises(FMICallException):
        again.doStep(currentCommunicationPoint=0.0, communicationStepSize=0.01)
    for one in (again, straight):
        one.terminate()
        one.freeInstance()


@pytest.mark.slow
@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("name", ["angle", "start_position"])
def test_what_is_no_number_is_refused_with_a_message(fmi: Fmi, name: str, tmp_path: Path) -> None:
    """End a simulation with an input or a start that is NaN, and log why."""
    file, told = tmp_path / "ball_beam.fmu", []
    file.write_bytes(fmu_bytes(of_effects(RIG, []), fmi, ""))
    signals = np.array([(0.0, 0.01), (0.1, np.nan)], dtype=[("time", np.float64), ("angle", np.float64)])
    given = {"input": signals} if name == "angle" else {"start_values": {name: np.nan}}

    def log(*arguments: object) -> None:
        told.append(b" ".join(one for one in arguments if isinstance(one, bytes)).decode())

    with pytest.raises(FMICallException):
        fmpy.simulate_fmu(str(file), stop_time=0.2, output_interval=0.01, logger=log, **given)
    assert any("an input or a start is no finite number" in one for one in told)


def test_a_negative_delay_is_told_not_to_be_carried() -> None:
    """Say what to do about an angle that is late, which an FMU alone cannot have, and nothing of printing."""
    for delay, to, carried in ((-0.04, "fmu", False), (0.04, "fmu", True), (-0.04, "c", True)):
        (one,) = in_source(of_effects(RIG, [acting("channel_delay", {"delay": delay})]), to)
        assert one.carried == carried
        assert ("feed the inputs 0.04 s early" in one.how) == (not carried)
        assert ("printed" in one.how) == (to == "c")


@pytest.mark.parametrize("before", ["", "env ", "'{folder}/my compilers/cc' -m64 -Wall", "{folder}/my compilers/cc"])
def test_the_compiler_may_have_arguments(before: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Take what `CC` says as a shell does: a launcher, options, a path with blanks."""
    found = shutil.which("cc")
    assert found is not None
    (tmp_path / "my compilers").mkdir()
    (tmp_path / "my compilers" / "cc").symlink_to(found)
    asked = before.format(folder=tmp_path)
    monkeypatch.setenv("CC", asked if "compilers" in asked else f"{asked}cc -DUNUSED=1")
    assert fmu_bytes(of_effects(RIG, []), 2, "")


def test_same_model_gives_the_same_file() -> None:
    """Build twice and compare bytes."""
    model = of_effects(RIG, [effect("level_error")])
    assert fmu_bytes(model, 2, "") == fmu_bytes(model, 2, "")


def test_missing_compiler_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    """Name the compiler that is missing, and what to do."""
    for asked in ("no_such_compiler", "no_such_compiler -m64", "'no_such_compiler"):
        monkeypatch.setenv("CC", asked)
        with pytest.raises(InputError, match=r"no C compiler .'?no_such_compiler.*--to c"):
            fmu_bytes(of_effects(RIG, []), 2, "")
