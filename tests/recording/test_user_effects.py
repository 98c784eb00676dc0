"""The effect of the documentation is a user's own, acts as written down, and what is wrong in such a file is said."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from analytic.effects import CATALOGUE, Acting, SensorLaw, acting, parameters_with, sensor_with
from analytic.kernel import Grid, integrate
from analytic.models import CAM
from analytic.motion import FloatArray, State
from analytic.rig import Rig
from harness.engines.catalogue import engine_of
from harness.engines.injection import force_of
from harness.errors import InputError
from harness.recording import user_effects
from harness.recording.user_effects import own_effects, read_effects
from harness.simulator import Plant, simulate
from tests.motions import Sines

DOCS = Path(__file__).resolve().parents[2] / "docs"
FILE = DOCS / "examples" / "magnet.py"
MAGNET = {"force": 0.012, "centre": 0.33, "distance": 0.06}
RIG, MOTION, START = Rig(), Sines(((0.01, 1.7, 0.0), (0.012, 3.1, 0.4))), State(0.36, 0.0)
STAMPS = np.arange(401) / 100.0


@pytest.fixture
def magnet() -> Iterator[Acting]:
    """The documented effect, beside the catalogue."""
    with own_effects([FILE]):
        yield acting("magnet", MAGNET)


def in_kernel(*effects: Acting) -> FloatArray:
    """s of the analytic model, shape (n,) [m]."""
    grid = Grid.over(STAMPS)
    vector = parameters_with(CAM, RIG, effects)
    starts = np.array([[START.position, START.velocity]])
    return integrate(grid, grid.tabulate(MOTION), vector, starts).position[0]


def test_documentation_shows_the_file_that_is_run_here() -> None:
    """Print the file as it is, short enough to read."""
    text = FILE.read_text(encoding="utf-8")
    assert f"```python\n{text}```" in (DOCS / "diagnosis.md").read_text(encoding="utf-8")
    assert len(text.splitlines()) <= 35


def test_magnet_moves_the_ball_as_in_the_independent_plant(magnet: Acting) -> None:
    """Agree with the virtual rig, whose law of the magnet is its own, and matter."""
    truth = simulate(Plant(step=5e-5).with_effects({"magnet": MAGNET}), MOTION, START, STAMPS[-1])
    expected = np.interp(STAMPS, truth.time, truth.position)
    # Nodes 1/256 m apart leave F/m K (1/256/d)⁴/384 × 200 = 1e-6 m/s², 200 being the largest fourth derivative of
    # the law at F = d = 1: in 4 s 8e-6 m if it pushed to one side. The plant's step leaves 1e-7 m.
    assert np.max(np.abs(in_kernel(magnet) - expected)) < 8e-6
    assert np.max(np.abs(in_kernel() - expected)) > 0.05


@pytest.mark.parametrize("name", ["mujoco", "pybullet"])
def test_magnet_acts_in_engines(name: str, magnet: Acting) -> None:
    """Move an engine's ball as the analytic model's, within micrometres."""
    engine, dt = engine_of(name), engine_of(name).parameters().time_step
    force = force_of([magnet], RIG, MOTION, STAMPS, dt)
    position = engine.run(RIG, MOTION, START, STAMPS, force=force).trajectory.position
    # Each engine alone is within 1 µm of eq. 14 after 10 s, and takes this force at the instant that it gets it.
    assert np.max(np.abs(position - in_kernel(magnet))) < 2e-6


def test_engines_count_the_rolled_angle_from_the_origin(tmp_path: Path) -> None:
    """Push with F sin φ, φ counting from where the recording began, as the analytic model does."""
    text = "import numpy as np\nfrom analytic.effects import *\n" + OWN.format(
        name="pull", force='Force("roll_angle", lambda turn, size: size * np.sin(turn))', low="-1.0", typical="0.01"
    )
    with own_effects([written(tmp_path, text)]):
        push = force_of([acting("pull", {"size": 0.01})], RIG, MOTION, STAMPS, 1e-3, origin=0.36)
    assert push is not None
    assert push(0.36, 0.0, 0.0, 0.0) == pytest.approx(0.0, abs=1e-12)
    quarter = 0.5 * np.pi * RIG.rolling_radius
    assert push(0.36 + quarter, 0.0, 0.0, 0.0) == pytest.approx(0.01, rel=1e-6)


OWN = """
OWN = Effect(
    name="{name}",
    law="F",
    parameters=(Parameter("size", "N", {low}, 1.0, {typical}),),
    source="here",
    force={force},
)
"""
HEAD = "from analytic.effects import Effect, Force, Parameter\n"
GOOD = {"name": "mine", "force": 'Force("angle", lambda angle, size: size * angle)', "low": "-1.0", "typical": "0.1"}


def written(folder: Path, text: str) -> Path:
    """A file of a user's own."""
    file = folder / "mine.py"
    file.write_text(text, encoding="utf-8")
    return file


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("x = 1\ny = (\n", r"mine\.py, line 2: SyntaxError: '\(' was never closed"),
        ("import numpy\n\nx = 1 / 0\n", r"mine\.py, line 3: ZeroDivisionError"),
        ("raise BaseException('no more')\n", r"mine\.py, line 1: BaseException: no more"),
        ("import sys\nsys.exit(0)\n", r"mine\.py, line 2: ends the program by sys\.exit\. Correct the file"),
        (
            HEAD + "import sys\n" + OWN.format(**GOOD | {"force": 'Force("angle", lambda a, size: sys.exit(0))'}),
            r"mine\.py, line 9: mine: ends the program by sys\.exit",
        ),
        ("from analytic.effects import Force\n", "has no effect in it"),
        (HEAD + "while True:\n    pass\n", r"mine\.py, line [23]: takes more than 0\.5 s\. Correct the file"),
        (
            HEAD
            + "import itertools\n"
            + OWN.format(**GOOD | {"force": 'Force("angle", lambda a, size: min(iter(lambda: 1, 0)))'}),
            r"mine\.py, line 9: mine: takes more than 0\.3 s",
        ),
        (
            HEAD + "import time\n" + OWN.format(**GOOD | {"force": 'Force("angle", lambda a, size: time.sleep(60))'}),
            r"mine\.py, line 9: mine: takes more than 0\.3 s",
        ),
        ("raise GeneratorExit\n", r"mine\.py, line 1: GeneratorExit"),
        (HEAD + OWN.format(**GOOD | {"name": "level_error"}), "'level_error' is taken"),
        (HEAD + OWN.format(**GOOD | {"low": "2.0"}), r"mine\.py, line 6: size: bounds 2 and 1"),
        (HEAD + OWN.format(**GOOD | {"typical": "7.0"}), "7 lies outside its bounds, -1 to 1"),
        (HEAD + OWN.format(**GOOD | {"force": 'Force("time", abs)'}), r"mine\.py, line 8: a force cannot depend on"),
        (
            HEAD + OWN.format(**GOOD | {"force": 'Force("angle", lambda angle, sise: angle)'}),
            "mine: TypeError: .*unexpected keyword argument 'size'",
        ),
        (
            HEAD + "import math\n" + OWN.format(**GOOD | {"force": 'Force("angle", lambda a, size: math.sin(a))'}),
            r"mine\.py, line 9: mine: TypeError",
        ),
        (
            HEAD + OWN.format(**GOOD | {"force": 'Force("angle", lambda a, size: a ** 0.5)'}),
            "the law gives nan N at angle -1.008 with size = 0.1. Narrow the bounds",
        ),
        (
            HEAD + OWN.format(**GOOD | {"force": 'Force("angle", lambda a, size: a + size ** 0.5)'}),
            "the law gives values of the type complex128, not real numbers. Narrow the bounds",
        ),
    ],
    ids=[
        "syntax",
        "error",
        "no Exception",
        "exit",
        "exit in a law",
        "endless file",
        "endless law",
        "sleeping law",
        "another end",
        "no effect",
        "taken",
        "bounds",
        "typical",
        "quantity",
        "parameter",
        "no array",
        "nan",
        "complex",
    ],
)
def test_what_is_wrong_in_a_file_is_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, text: str, message: str
) -> None:
    """Name the file, the line if there is one, and what to do; leave the catalogue as it was."""
    # Short limits where there is no end alone: a busy machine takes longer than that over a file without fault.
    for limit, seconds in (("LONGEST_READ", 0.5), ("LONGEST_CALL", 0.3)):
        if f"more than {seconds}".replace(".", r"\.") in message:
            monkeypatch.setattr(user_effects, limit, seconds)
    before = list(CATALOGUE)
    with pytest.raises(InputError, match=message) as caught, own_effects([written(tmp_path, text)]):
        pass
    assert str(tmp_path / "mine.py") in str(caught.value)
    assert list(CATALOGUE) == before


def test_a_missing_file_is_said(tmp_path: Path) -> None:
    """Name the file that is not there."""
    with pytest.raises(InputError, match=r"nowhere\.py: there is no such file"):
        read_effects(tmp_path / "nowhere.py")


def test_a_file_given_twice_is_refused() -> None:
    """Say that its names are taken."""
    with pytest.raises(InputError, match="'magnet' is taken"), own_effects([FILE, FILE]):
        pass


def test_settings_that_a_file_makes_end_with_it(tmp_path: Path) -> None:
    """Compute on as before where a file makes every rounding or warning an error."""
    settings = "import warnings\nimport numpy as np\nnp.seterr(all='raise')\nwarnings.simplefilter('error')\n"
    before = np.geterr(), list(warnings.filters)
    read_effects(written(tmp_path, settings + HEAD + OWN.format(**GOOD)))
    assert (np.geterr(), list(warnings.filters)) == before


SENSOR = HEAD.replace("Force", "Follower, Force, SensorLaw") + OWN.replace("force={force}", "sensor={sensor}")


def test_an_effect_may_act_on_the_sensor(tmp_path: Path) -> None:
    """Filter and engines know the sensor by what it does: here a gain and a lag that go together."""
    law = "lambda values: SensorLaw(gain=1.0 + values['size'], lag=0.1 * values['size'])"
    text = SENSOR.format(**GOOD | {"sensor": law, "low": "0.0"})
    with own_effects([written(tmp_path, text)]):
        sensor = sensor_with([acting("mine", {"size": 0.5}), acting("channel_delay", {"delay": 0.02})])
    assert sensor == SensorLaw(gain=1.5, lag=0.05, delay=0.02)
    # A first-order lag follows a ramp T behind, once exp(−t/T) is gone: 1e-13 after 1.5 s.
    ramp = SensorLaw(gain=1.5, lag=0.05).recorded(STAMPS, 0.1 * STAMPS)
    np.testing.assert_allclose(ramp[150:], 1.5 * 0.1 * (STAMPS[150:] - 0.05), atol=1e-12)


@pytest.mark.parametrize(
    ("law", "message"),
    [
        ("lambda values: SensorLaw(gain=values['size'])", "with size = 0 the sensor has the gain 0"),
        ("lambda values: SensorLaw(lag=values['size'] - 0.5)", "with size = 0.1 the sensor has .* the lag -0.4 s"),
        ("lambda values: 2.0", r"mine: sensor gives 2\.0\. Let it give a SensorLaw"),
        ("lambda values: SensorLaw(gain=values['sise'])", r"mine\.py, line 8: mine: KeyError"),
    ],
    ids=["no gain", "negative lag", "no law", "error"],
)
def test_a_sensor_that_cannot_be_is_refused(tmp_path: Path, law: str, message: str) -> None:
    """Say with which values the filter could not take it."""
    with pytest.raises(InputError, match=message):
        read_effects(written(tmp_path, SENSOR.format(**GOOD | {"sensor": law, "low": "0.0"})))


@pytest.mark.parametrize(
    ("law", "message"),
    [
        ("alter=lambda rig, values: None", "alter gives None. Let it give a Rig"),
        ("tilting=lambda values: 'a'", "tilting gives 'a'. Let it give a float"),
        ("transmission=lambda values: 1.0", "transmission gives 1.0. Let it give a Transmission"),
        (
            "turn=lambda motion, stamps, values: motion, follower=lambda values: 0.1",
            "follower gives 0.1. Let it give a Follower",
        ),
        (
            "turn=lambda motion, stamps, values: motion, follower=lambda values: Follower(values['size'])",
            "line 8: mine: a follower with the lag -1 s .* none below 0",
        ),
        (
            "sensor=lambda values: SensorLaw(), follower=lambda values: Follower(0.1)",
            "mine: a follower smooths the angle's error as its turn the motion; give both",
        ),
        ("sensor=lambda values: SensorLaw(gain='a')", "TypeError: must be real number, not str"),
    ],
)
def test_what_gives_something_else_is_refused(tmp_path: Path, law: str, message: str) -> None:
    """Say what a function of an effect has to give before anything is computed with it."""
    text = SENSOR.replace("sensor={sensor}", law).format(**GOOD)
    with pytest.raises(InputError, match=message):
        read_effects(written(tmp_path, text))


def test_an_error_that_comes_late_names_the_line_too(tmp_path: Path) -> None:
    """Tell the user's own error from one of the house, whenever a law is computed."""
    law = 'Force("angle", lambda a, size: a + (1.0 if size != 0.25 else 1 / 0))'
    (effect,) = read_effects(written(tmp_path, HEAD + OWN.format(**GOOD | {"force": law})))
    with pytest.raises(InputError, match=r"mine\.py, line 8: mine: ZeroDivisionError"):
        parameters_with(CAM, RIG, [Acting(effect, {"size": 0.25})])
