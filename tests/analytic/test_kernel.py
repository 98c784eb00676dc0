"""The kernel is accurate, of fourth order, and treats every run of a batch as if it were alone."""

from __future__ import annotations

import math

import numpy as np
import pytest

from analytic.kernel import Grid, Runs, integrate, integrate_windows, simulate
from analytic.models import CAM, CUM, FRICTION, MODELS, Model, Reading, coefficients
from analytic.motion import BeamMotion, FloatArray, State
from analytic.rig import Rig
from tests.motions import ClosedForm, Fixed, Ramp, Sines
from tests.reference import reference

RIG = Rig(level_angle=0.002)
MOTION = Sines()
START = State(0.36, 0.05)
EVEN = np.linspace(0.0, 10.0, 1001)
UNEVEN = np.concatenate(([0.0], np.sort(np.random.default_rng(3).uniform(0.0, 10.0, 700)), [10.0]))
EVERY_MODEL = pytest.mark.parametrize("model", MODELS.values(), ids=lambda model: model.name)


def halved(grid: Grid) -> Grid:
    """The same stamps with every step cut in two."""
    return Grid(grid.time, np.repeat(0.5 * grid.steps, 2), 2 * grid.marks)


def free_run(model: Model, grid: Grid, motion: BeamMotion = MOTION, rig: Rig = RIG, start: State = START) -> Runs:
    """One run over a whole grid."""
    return integrate(grid, grid.tabulate(motion), coefficients(model, rig), [(start.position, start.velocity)])


def kink_error(model: Model, velocity: FloatArray, grid: Grid) -> float:
    """What the reversals of the ball cost a Runge–Kutta step where friction has a kink at ṡ = 0 [m].

    With |tanh|, s̈ contains −(G/v_t) |ṡ| ṡ near ṡ = 0; at a reversal with acceleration a its second time derivative
    jumps by 4 G a²/v_t. Simpson's rule misses the integral of ½ jump (t − θ)²₊ by at most jump h³/324 (at θ = h/3),
    and that velocity is carried along until the end.
    """
    if model.reading is not Reading.PRINTED_DISSIPATIVE:
        return 0.0
    at = np.flatnonzero(velocity[:-1] * velocity[1:] < 0.0)
    turning = np.diff(velocity)[at] / np.diff(grid.time)[at]
    gain = RIG.rolling_ratio * RIG.friction_coefficient * RIG.gravity
    jumps = 4.0 * gain * turning**2 / RIG.transition_velocity
    return float(np.sum(jumps) * grid.steps.max() ** 3 / 324.0 * (grid.time[-1] - grid.time[0]))


@pytest.mark.slow
@EVERY_MODEL
@pytest.mark.parametrize("time", [EVEN, UNEVEN], ids=["even stamps", "uneven stamps"])
def test_kernel_agrees_with_the_adaptive_reference(model: Model, time: FloatArray) -> None:
    """Follow the reference over 10 s, with the default step, to within the error that halving the steps reveals."""
    coarse = Grid.over(time, 5e-3)
    fine = halved(coarse)
    (position,), (velocity,) = free_run(model, fine).position, free_run(model, fine).velocity
    # fourth order: error(h/2) = (s(h) − s(h/2))/15, up to terms smaller by λ h: the fastest rate is Coulomb's
    # k f_b g/v_t = 30 1/s, so 10 % allow for them; the reference's own error is what a looser tolerance moves it;
    # 4000 steps round s of a few metres at random, 64 · 4e-16 m
    own = np.max(np.abs(free_run(model, coarse).position[0] - position)) / 15.0
    expected, loose = (reference(model, RIG, MOTION, START, time, rtol=rtol).position for rtol in (1e-13, 1e-12))
    tolerance = 1.1 * own + kink_error(model, velocity, fine) + np.max(np.abs(expected - loose))
    assert np.max(np.abs(position - expected)) < tolerance + 3e-14
    assert tolerance < (2e-8 if model.reading is Reading.PRINTED_DISSIPATIVE else 1e-9)


def test_default_step_resolves_a_fast_beam() -> None:
    """Keep what `Grid.over` promises: below 1e-9 m after 10 s with 3° at 2 Hz."""
    fast = Sines(((math.radians(3.0), 4.0 * math.pi, 0.3),))
    (run,) = simulate([CAM], RIG, fast, START, EVEN)
    expected = reference(CAM, RIG, fast, START, EVEN, rtol=1e-13).position
    assert np.max(np.abs(run.position - expected)) < 1e-9


@pytest.mark.parametrize("name", ["cum", "cum_linear", "cam", "friction_viscous", "friction_printed"])
def test_error_falls_with_the_fourth_power_of_the_step(name: str) -> None:
    """Fit order 4 over four halvings of the step."""
    model, ends = MODELS[name], np.array([0.0, 4.0])
    steps = 0.04 / 2.0 ** np.arange(5)
    exact = reference(model, RIG, MOTION, State(0.36, 0.5), ends, rtol=1e-13).position[-1]
    errors = [
        abs(free_run(model, Grid.over(ends, step), start=State(0.36, 0.5)).position[0, -1] - exact) for step in steps
    ]
    # the next term of the error bends the slope by about ω h = 0.1 at the coarsest step, a fifth of that in the fit
    assert np.polyfit(np.log(steps), np.log(errors), 1)[0] == pytest.approx(4.0, abs=0.05)


def test_cam_conserves_energy_on_a_fixed_slope() -> None:
    """Keep ½ (m + J/r²) ṡ² − m g s sin(α + α₀) to rounding while the ball runs up the slope and down again."""
    tilt = -0.05
    (run,) = simulate([CAM], RIG, Fixed(tilt), State(0.2, 0.8), EVEN)
    kinetic = 0.5 * RIG.mass / RIG.rolling_ratio * run.velocity**2
    energy = kinetic - RIG.mass * RIG.gravity * run.position * math.sin(tilt + RIG.level_angle)
    assert np.ptp(kinetic) > 0.1
    assert np.min(kinetic) < 1e-6
    # 4000 steps, each rounding s (of up to 13 m) and ṡ (2.6 m/s), that is an energy of up to 0.5 J, to 1.1e-16 in
    # some five operations
    assert np.ptp(energy) < 4000 * 5 * 0.5 * 1.1e-16


@pytest.mark.parametrize("model", [CUM, CAM], ids=lambda model: model.name)
def test_steadily_turning_beam_has_a_closed_solution(model: Model) -> None:
    """Follow s̈ = k (ω² s + g sin(ω t + a)), whose solution is hyperbolic plus sinusoidal, where sin α ≠ α."""
    turn, tilt, time = 0.4, -0.8, np.linspace(0.0, 4.0, 401)
    k = 1.0 / (1.0 + RIG.inertia / (RIG.mass * (RIG.radius if model is CUM else RIG.rolling_radius) ** 2))
    phase, grow = tilt + RIG.level_angle, math.sqrt(k) * turn
    forced = -k * RIG.gravity / (turn**2 * (1.0 + k))
    even, odd = START.position - forced * math.sin(phase), (START.velocity - forced * turn * math.cos(phase)) / grow
    expected = even * np.cosh(grow * time) + odd * np.sinh(grow * time) + forced * np.sin(turn * time + phase)
    (run,) = simulate([model], RIG, Ramp(turn, tilt), START, time)
    # terms of up to 40 m cancel here: 1e-14 m of rounding each; the method leaves (ω h)⁴/120 = 1e-14 of 40 m a radian;
    # 1600 steps round s of 5 m by 1e-15 m each
    np.testing.assert_allclose(run.position, expected, rtol=0.0, atol=5e-12)


def kick(begin: float, steepness: float = 5.0) -> ClosedForm:
    """A beam at rest that turns with a constant α̈ [rad/s²] from `begin` [s] on."""
    return ClosedForm(
        lambda time: 0.5 * steepness * np.maximum(time - begin, 0.0) ** 2,
        lambda time: steepness * np.maximum(time - begin, 0.0),
        lambda time: np.where(time > begin, steepness, 0.0),
    )


def test_jump_of_the_beam_acceleration_costs_nothing() -> None:
    """Give ṡ the whole impulse K (h + r + J/(m r)) Δα̇ wherever in a step α̈ jumps."""
    step = 1e-3
    rig, one = Rig(), Grid.over(np.array([0.0, step]), step)
    errors = []
    for begin in step * np.concatenate((np.linspace(0.0, 1.0, 21), [0.5 - 1e-9, 0.5 + 1e-9])):
        (found,) = free_run(CAM, one, kick(begin), rig, State(0.36, 0.0)).velocity[:, -1]
        # α̈ acts for step − begin; the gravity and s α̇² that it brings about are smaller by g step²/(2 · lever) = 1e-4
        errors.append(abs(found + rig.rolling_ratio * rig.lever * 5.0 * (step - begin)))
    assert max(errors) < 1e-3 * rig.rolling_ratio * rig.lever * 5.0 * step


def batch() -> tuple[Grid, FloatArray, FloatArray, FloatArray, FloatArray]:
    """Every model on three beam motions from two starts: grid, tables, parameters, starts, motion of each run."""
    grid = Grid.over(UNEVEN)
    tables = np.array([grid.tabulate(motion) for motion in (MOTION, Fixed(0.02), Ramp(0.01, -0.05))])
    cases = [(model, motion, start) for model in MODELS.values() for motion in range(3) for start in (0.05, -0.1)]
    parameters = np.array([coefficients(model, RIG) for model, _, _ in cases])
    starts = np.array([(0.36, start) for _, _, start in cases])
    return grid, tables, parameters, starts, np.array([motion for _, motion, _ in cases])


def test_runs_of_a_batch_do_not_touch_each_other() -> None:
    """Give each of 42 runs bit for bit what it gets alone."""
    grid, tables, parameters, starts, table_of = batch()
    together = integrate(grid, tables, parameters, starts, table_of=table_of)
    assert together.position.shape == together.velocity.shape == (42, len(UNEVEN))
    for run, motion in enumerate(table_of):
        alone = integrate(grid, tables[motion], parameters[run], starts[run])
        np.testing.assert_array_equal(together.position[run], alone.position[0])
        np.testing.assert_array_equal(together.velocity[run], alone.velocity[0])


def test_windows_are_slices_of_restarted_runs() -> None:
    """Give each window bit for bit what its stamps give as a recording of their own, one after the other."""
    grid, tables, parameters, starts, table_of = batch()
    random = np.random.default_rng(7)
    first, last = np.sort(random.integers(0, len(UNEVEN), (2, len(starts))), axis=0)
    first[0], last[0], first[1] = 0, len(UNEVEN) - 1, last[1]
    position, velocity = integrate_windows(grid, tables, parameters, starts, first, last, table_of=table_of)
    ends = np.cumsum(last - first + 1)
    assert len(position) == len(velocity) == ends[-1]
    motions = (MOTION, Fixed(0.02), Ramp(0.01, -0.05))
    for run, (begin, end) in enumerate(zip(first, last, strict=True)):
        own, where = Grid.over(UNEVEN[begin : end + 1]), slice(ends[run] - (end - begin + 1), ends[run])
        alone = integrate(own, own.tabulate(motions[table_of[run]]), parameters[run], starts[run])
        np.testing.assert_array_equal(position[where], alone.position[0])
        np.testing.assert_array_equal(velocity[where], alone.velocity[0])


@EVERY_MODEL
def test_run_can_be_taken_up_at_any_stamp(model: Model) -> None:
    """Go on from a stamp's state bit for bit as the uninterrupted run does."""
    grid = Grid.over(UNEVEN)
    table, p = grid.tabulate(MOTION), coefficients(model, RIG)
    whole = integrate(grid, table, p, [(0.36, 0.05)])
    at = np.array([1, 250, len(UNEVEN) - 2])
    states = np.column_stack((whole.position[0, at], whole.velocity[0, at]))
    resumed = integrate_windows(grid, table, p, states, at, np.full(len(at), len(UNEVEN) - 1))
    for one, other in zip(resumed, (whole.position[0], whole.velocity[0]), strict=True):
        np.testing.assert_array_equal(one, np.concatenate([other[begin:] for begin in at]))


def test_simulate_returns_the_models_in_order() -> None:
    """Return one trajectory a model, named after it, on the stamps asked for."""
    models = [CAM, FRICTION[Reading.VISCOUS], CUM]
    runs = simulate(models, RIG, MOTION, START, UNEVEN)
    assert [run.source for run in runs] == ["cam", "friction_viscous", "cum"]
    for model, run in zip(models, runs, strict=True):
        np.testing.assert_array_equal(run.time, UNEVEN)
        np.testing.assert_array_equal(run.position, free_run(model, Grid.over(UNEVEN)).position[0])
        assert (run.position[0], run.velocity[0]) == (START.position, START.velocity)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"tables": np.zeros((3, 3))}, "tables"),
        ({"parameters": np.zeros(5)}, "parameters"),
        ({"starts": np.zeros((2, 3))}, "starts"),
        ({"first": np.array([0, -1])}, "windows"),
        ({"last": np.array([5, 11])}, "windows"),
        ({"first": np.array([6, 0]), "last": np.array([5, 5])}, "windows"),
        ({"first": np.array([0])}, "windows"),
        ({"table_of": np.array([0, 1])}, "table_of"),
    ],
    ids=lambda value: value if isinstance(value, str) else "+".join(value),
)
def test_arrays_that_do_not_fit_are_refused(wrong: dict[str, FloatArray], message: str) -> None:
    """Refuse what compiled code would read past its end, naming the argument."""
    grid = Grid.over(np.linspace(0.0, 1.0, 11))
    fitting = {"tables": grid.tabulate(MOTION), "parameters": coefficients(CAM, RIG), "starts": np.zeros((2, 2))}
    windows = {"first": np.zeros(2, np.int64), "last": np.full(2, 10)}
    with pytest.raises(ValueError, match=message):
        integrate_windows(grid, **(fitting | windows | wrong))
