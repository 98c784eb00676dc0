"""A diagnosis says what is in the recordings, and nothing of how they are written down."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import harness
from analytic.rig import Rig
from harness.api.diagnosis import Diagnosis
from harness.identify.problem.settings import Settings
from harness.simulator import Experiment, write_case
from tests.acceptance.told_otherwise import (
    EVERY_SECOND,
    LATER,
    MIRROR,
    OTHER_ORDER,
    SHUFFLED,
    UNITS,
    Change,
)

pytestmark = pytest.mark.slow

ROLLING, LEVEL = "rolling_resistance", "level_error"
FRICTION = {ROLLING: {"coefficient": 0.002}}
BUMP = {"track_bump": {"height": 2e-4, "centre": 0.3, "width": 0.02}}

# Another unit, sign or order changes the last digits of the readings, by 1e-16 of their size, and 1000 s more change
# stamps of 10 ms by 1e-13 s, 1e-11 of a step. The smoothing of the angle and the filter amplify that, so far to 1e-9
# of a value; 1e-6 is a hundredth of the narrowest interval and less.
ROUNDING = 1e-6

# A fit ends where another round lowers the deviance by less than `converged`. A deviance d above its minimum is √d
# standard errors away from it, and two fits that come from two sides may end twice as far apart.
ENDED = 2.0 * float(np.sqrt(Settings().converged))


class Case:
    """A case of the virtual rig and what is found in it and in its changes, each of which is diagnosed once."""

    def __init__(self, folder: Path, experiment: Experiment) -> None:
        self._folder = folder
        write_case(folder / "plain", experiment)
        self.plain = harness.diagnose(folder / "plain")

    def after(self, change: Change, name: str) -> Diagnosis:
        """What is found after a change."""
        return harness.diagnose(change.of(self._folder / "plain", self._folder / name))


@pytest.fixture(scope="module")
def complete(tmp_path_factory: pytest.TempPathFactory) -> Case:
    """Nothing is missing; friction, the level and a bump of the track are declared."""
    experiment = Experiment(
        rig=Rig(level_angle=-0.0028), declared={**FRICTION, **BUMP}, duration=6.0, identify=2, predict=0, seed=4
    )
    return Case(tmp_path_factory.mktemp("complete"), experiment)


@pytest.fixture(scope="module")
def resisting(tmp_path_factory: pytest.TempPathFactory) -> Case:
    """Rolling resistance is missing."""
    return Case(
        tmp_path_factory.mktemp("resisting"),
        Experiment(hidden=FRICTION, duration=8.0, identify=2, predict=0, seed=3),
    )


@pytest.fixture(scope="module")
def tilted(tmp_path_factory: pytest.TempPathFactory) -> Case:
    """A level error is missing."""
    return Case(
        tmp_path_factory.mktemp("tilted"),
        Experiment(declared=FRICTION, hidden={LEVEL: {"angle": 0.004}}, duration=8.0, identify=1, predict=0, seed=3),
    )


def found(diagnosis: Diagnosis) -> tuple[str, list[str]]:
    """The verdict, and the names of the effects."""
    return diagnosis.verdict, list(diagnosis.effects)


def errors(diagnosis: Diagnosis) -> list[float]:
    """RMS errors of prediction on the recordings used [m], in the order of the horizons."""
    return list(diagnosis.found.identify.after.rms.values())


def holds(one: Diagnosis, other: Diagnosis, name: str, key: str) -> bool:
    """Whether each of two intervals of a parameter contains the other one's value."""
    first, second = (each.effects[name].parameters[key] for each in (one, other))
    return all(a.interval[0] <= b.value <= a.interval[1] for a, b in ((first, second), (second, first)))


CHANGES = {"mirror": MIRROR, "units": UNITS, "later": LATER, "other_order": OTHER_ORDER}


@pytest.mark.parametrize("name", CHANGES)
def test_nothing_is_missing_whichever_way_it_is_told(complete: Case, name: str) -> None:
    """Say `none`, with the same errors, of a mirrored rig, in other units, at another time, in another order."""
    other = complete.after(CHANGES[name], name)
    assert found(complete.plain) == found(other) == ("none", [])
    assert errors(other) == pytest.approx(errors(complete.plain), rel=ROUNDING)


@pytest.mark.parametrize("name", CHANGES)
def test_what_is_missing_is_the_same_whichever_way_it_is_told(resisting: Case, name: str) -> None:
    """Find the same friction with the same interval in a mirrored rig, other units, at another time, in any order."""
    other = resisting.after(CHANGES[name], name)
    assert found(resisting.plain) == found(other) == ("effect", [ROLLING])
    one, again = (each.effects[ROLLING].parameters["coefficient"] for each in (resisting.plain, other))
    assert [again.value, *again.interval] == pytest.approx([one.value, *one.interval], rel=ROUNDING)
    assert errors(other) == pytest.approx(errors(resisting.plain), rel=ROUNDING)


def test_a_mirrored_effect_has_the_opposite_sign(tilted: Case) -> None:
    """Find the level error of a mirrored rig with the opposite sign, as exactly as fits end."""
    other = tilted.after(MIRROR, "mirror")
    assert found(tilted.plain) == found(other) == ("effect", [LEVEL])
    one, again = (each.effects[LEVEL].parameters["angle"] for each in (tilted.plain, other))
    standard_error = max(np.diff(each.interval).item() for each in (one, again)) / (2.0 * 1.96)
    assert abs(one.value + again.value) <= ENDED * standard_error


@pytest.mark.parametrize("name", ["complete", "resisting", "tilted"])
def test_half_of_the_readings_say_the_same(name: str, request: pytest.FixtureRequest) -> None:
    """Come to the same verdict from every second reading, with values within each other's intervals."""
    case: Case = request.getfixturevalue(name)
    other = case.after(EVERY_SECOND, "every_second")
    assert found(other) == found(case.plain)
    assert all(holds(case.plain, other, effect, key) for effect, one in other.effects.items() for key in one.parameters)


def test_shuffled_rows_are_refused(tilted: Case) -> None:
    """Name the file and the first row whose time is before the one above it."""
    with pytest.raises(harness.InputError, match=r"rec_01\.csv, row 4, column 'time_s': time decreases .*sorted by"):
        tilted.after(SHUFFLED, "shuffled")
