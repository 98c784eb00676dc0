"""What all effects have in common: names as published, rest, energy, convergence, one seed one truth."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from analytic.effects import CATALOGUE
from analytic.motion import State
from harness.errors import InputError
from harness.simulator import UNLISTED, Experiment, Plant, Sensors, simulate
from harness.simulator.effects import DEPENDENCES
from tests.simulator.acting import EACH, EACH_UNLISTED, rolled
from tests.simulator.motions import Sines

ALL = {**EACH, **EACH_UNLISTED}
PUBLISHED = {
    "viscous_damping": ["coefficient"],
    "quadratic_drag": ["coefficient"],
    "rolling_resistance": ["coefficient"],
    "directional_resistance": ["coefficient_plus", "coefficient_minus"],
    "stribeck_friction": ["static_coefficient", "kinetic_coefficient", "stribeck_velocity"],
    "level_error": ["angle"],
    "level_per_recording": ["spread"],
    "level_drift": ["rate"],
    "track_curvature": ["curvature", "centre"],
    "track_bump": ["height", "centre", "width"],
    "ball_imbalance": ["offset"],
    "rolling_radius": ["radius"],
    "contact_slip": ["friction_coefficient"],
    "angle_gain": ["gain"],
    "linkage_backlash": ["width"],
    "angle_nonlinearity": ["square", "cube"],
    "angle_hold": ["interval"],
    "angle_lag": ["time_constant"],
    "angle_servo": ["lag", "damping"],
    "beam_compliance": ["compliance"],
    "channel_delay": ["delay"],
    "position_gain": ["gain"],
    "position_nonlinearity": ["square", "cube"],
    "position_lag": ["time_constant"],
    "presliding_hysteresis": ["coefficient", "stiffness"],
    "eccentric_pivot": ["eccentricity"],
}


def test_names_are_those_published() -> None:
    """Offer every effect of the public catalogue under its name, with its parameters."""
    assert {name: [one.name for one in effect.parameters] for name, effect in CATALOGUE.items()} == PUBLISHED
    assert set(EACH) == set(CATALOGUE)


def test_unlisted_structures_cover_every_dependence() -> None:
    """Say of each unlisted structure what it depends on, and have one for each quantity."""
    assert set(EACH_UNLISTED) == set(UNLISTED)
    assert not set(UNLISTED) & set(CATALOGUE)
    assert {entry.depends_on[0] for entry in UNLISTED.values()} == set(DEPENDENCES)
    assert all(set(entry.depends_on) <= set(DEPENDENCES) for entry in UNLISTED.values())


@pytest.mark.parametrize(
    ("effects", "message"),
    [
        ({"rolling_resistence": {}}, "Did you mean 'rolling_resistance'?"),
        ({"level_error": {"tilt": 0.1}}, "level_error has the parameters angle; given: tilt."),
        ({"track_bump": {"height": 1e-4, "centre": 0.3}}, "height, centre, width; given: height, centre."),
        ({"eccentric_pivot": {}}, "eccentric_pivot has the parameters eccentricity; given: none."),
        ({"viscous_damping": {"coefficient": -1.0}}, "coefficient is -1; it must lie between 0 and 10 N s/m."),
        ({"angle_gain": {"gain": float("nan")}}, "gain is nan"),
        ({"rough_patch": {"coefficient": 0.01, "start": 0.4, "end": 0.3}}, "start is 0.4, more than end = 0.3"),
    ],
)
def test_what_cannot_act_is_refused(effects: dict[str, dict[str, float]], message: str) -> None:
    """Refuse unknown names, missing parameters and impossible values, in words that help."""
    for what in (Plant(), Sensors()):
        with pytest.raises(InputError, match=re.escape(message)):
            what.with_effects(effects)


MOVING = ("level_error", "beam_compliance", "gust", "settling_force", "magnet", "level_drift", "level_per_recording")
RESTING = [name for name in ALL if name not in MOVING]


@pytest.mark.slow
@pytest.mark.parametrize("name", [*RESTING, "magnet"])
def test_ball_at_rest_stays_at_rest(name: str) -> None:
    """Leave a resting ball on a level beam where it is, to the bit, unless something pulls at it."""
    places = {"magnet": 0.33, "track_curvature": 0.33, "cubic_spring": 0.32}
    start = places.get(name, 0.2)  # 6 w from the bump, which is 1e-8 of it
    effects = {name: ALL[name]}
    # Their pull is zero nowhere, only within what resistance holds.
    if name in ("track_bump", "ball_imbalance", "out_of_round", "ripple_force"):
        effects["rolling_resistance"] = {"coefficient": 0.01}
    run = rolled(effects, State(start, 0.0), 1.0, turned_before=0.3)
    assert np.all(run.position == start)
    assert np.all(run.velocity == 0.0)


@pytest.mark.parametrize("name", ALL)
def test_energy_balance_closes_with_second_order(name: str) -> None:
    """Account for energy, work and loss of every effect, with an error that falls with the square of the step."""
    steps, errors = (4e-4, 1e-4), []
    for step in steps:
        motion = Sines(((0.02, 1.7, 0.0), (0.008, 3.1, 0.4)))
        run = rolled({name: ALL[name]}, State(0.3, 0.1), 4.0, motion=motion, turned_before=0.3, step=step)
        errors.append(np.max(np.abs(run.energy - run.energy[0] - run.work + run.dissipated)))
    # a step is 16 times as good; a corner of a law that is met anywhere within a step may halve that
    assert errors[1] < errors[0] / 8
    assert errors[1] < 1e-8  # J, of some 1e-3


@pytest.mark.slow
@pytest.mark.parametrize("name", ALL)
def test_experiment_step_is_fine_enough(name: str) -> None:
    """Leave an error at the experiments' step that is below a hundredth of the laser's noise after 6 s."""
    listed = name in EACH
    experiment = Experiment(
        hidden={name: ALL[name]} if listed else {}, unlisted={} if listed else {name: ALL[name]}, duration=6.0, seed=5
    )
    seed = experiment.seeds[0]
    plant = experiment.plant(seed, experiment.acting)
    run, _ = experiment.carried_out(seed)
    start = State(float(run.position[0]), 0.0)
    fine = simulate(replace(plant, step=plant.step / 4), run.shaft_motion, start, 6.0)
    assert np.max(np.abs(fine.position[::4] - run.position)) < 0.01 * experiment.position_noise


def test_forces_of_several_effects_add() -> None:
    """Let a bowl and a beam that bends under the load act as their sum does: a constant slope."""
    curved, bending = {"curvature": 0.06, "centre": 0.33}, {"compliance": 0.06 / (0.071 * 9.81)}
    run = rolled({"track_curvature": curved, "beam_compliance": bending}, State(0.3, 0.0), 2.0)
    tilted = rolled({"level_error": {"angle": 0.06 * 0.33}}, State(0.3, 0.0), 2.0)
    np.testing.assert_allclose(run.position, tilted.position, rtol=0.0, atol=1e-11)
