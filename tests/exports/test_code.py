"""Exported C and Python against our own equations, for every effect of the catalogue."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from analytic.effects import CATALOGUE, Acting, Effect, Force, Parameter, SensorLaw, acting, parameters_with
from analytic.law import acceleration, dry_limit
from analytic.models import CAM
from analytic.slots import ORIGIN
from harness.errors import InputError
from harness.exports.code_files import c_files, python_files
from harness.exports.model import LONGEST_STEP, of_effects
from harness.identify.problem.spline_term import KINDS, SplineTerm
from tests.exports.exported import EACH, RIG, InC, effect, in_python, motion, ours

S0 = 0.3  # start [m]
PHASE = 0.7  # [rad]
# Rounding of some 1e3 steps of a motion of 1 m, of which a friction that stops the ball makes more: measured 2e-13.
ROUNDED = 1e-10
PRINTED = 6e-10  # the example prints nine decimals [m]
SPLINES = [
    SplineTerm(
        kind.depends,
        kind.friction,
        0.05,
        0.11,
        (0.003 if kind.friction else 0.05) * np.sin(np.arange(1.0, 7.0)) ** 2,
        int(kind.periodic),
    )
    for kind in KINDS
]


def test_every_effect_of_the_catalogue_is_tried() -> None:
    """Have a size for each effect, and each effect either exportable or a law of the user's own."""
    assert set(EACH) == set(CATALOGUE)
    for one in CATALOGUE.values():
        assert one.exportable, one.name


@pytest.mark.slow
@pytest.mark.parametrize("name", CATALOGUE)
def test_derivative_and_run_equal_our_own(name: str, tmp_path: Path) -> None:
    """Compare accelerations and friction limits at random states, and a run of four seconds."""
    model = of_effects(RIG, [effect(name)])
    compiled, plain = InC(model, tmp_path), in_python(model, tmp_path)
    p = parameters_with(CAM, RIG, [effect(name)], phase=PHASE)
    p[ORIGIN] = S0
    random = np.random.default_rng(1)
    for s, v, angle, rate, angular in random.normal(0.0, (0.4, 0.5, 0.1, 0.5, 3.0), (50, 5)):
        phi = (s - S0) / model.rig.rolling_radius + PHASE
        expected = acceleration(s, v, angle, rate, angular, p)
        held = dry_limit(s, v, 1.0, angle, rate, angular, p), dry_limit(s, v, -1.0, angle, rate, angular, p)
        for code in (compiled, plain):
            # Sums of terms of up to 30 m/s², rounded in another order; sin(φ) of 100 rad loses two digits more.
            assert code.acceleration(s, v, angle, rate, angular, phi, 0.0) == pytest.approx(expected, abs=1e-12)
            got = [code.dry_limit(s, v, side, angle, rate, angular, phi, 0.0) for side in (1.0, -1.0)]
            np.testing.assert_allclose(got, held, rtol=1e-12, atol=1e-15)
    beam = motion()
    expected_run = ours(RIG, [effect(name)], beam, S0, phase=PHASE)
    time, states = beam.time.tolist(), [tuple(one) for one in beam.states.tolist()]
    if model.sensor.delay:  # the project's own law of a delay, by a spline through the positions
        expected_run = SensorLaw(delay=model.sensor.delay).recorded(beam.time, expected_run)
        # Our cubics meet the spline to h³/8 of the jerk's changes: 10 ms, 30 m/s⁴ or less.
        tolerance = 1e-8 * 30
    else:
        tolerance = ROUNDED
    np.testing.assert_allclose(plain.run(time, states, S0, 0.0, PHASE), expected_run, atol=tolerance)
    np.testing.assert_allclose(compiled.run(beam, S0, PHASE), expected_run, atol=tolerance + PRINTED)


@pytest.mark.slow
@pytest.mark.parametrize("term", SPLINES, ids=lambda one: one.name)
def test_spline_terms_equal_our_own(term: SplineTerm, tmp_path: Path) -> None:
    """Run each kind of spline term, in force, in friction and in the sensor, over four seconds."""
    from analytic.effects import motion_with
    from analytic.kernel import Grid
    from harness.identify.filter.arguments import BeamTable
    from harness.identify.filter.free_run import free_runs

    effects = [effect("rolling_resistance")]
    model, beam = of_effects(RIG, effects, term), motion()
    grid = Grid.over(beam.time, LONGEST_STEP)
    p = parameters_with(CAM, RIG, effects, phase=PHASE)
    p[ORIGIN] = S0
    term.write(p, PHASE)
    table = term.load(grid.tabulate(motion_with(beam, beam.time, effects)), grid.edges, RIG.gravity)
    whole = np.array([0]), np.array([len(beam.time)])
    expected = free_runs(*whole, BeamTable(grid.steps, grid.marks, table), p, 0.0, np.array([[S0, 0.0]]))
    expected = model.sensor.curve(expected)
    time, states = beam.time.tolist(), [tuple(one) for one in beam.states.tolist()]
    np.testing.assert_allclose(in_python(model, tmp_path).run(time, states, S0, 0.0, PHASE), expected, atol=ROUNDED)
    np.testing.assert_allclose(InC(model, tmp_path).run(beam, S0, PHASE), expected, atol=ROUNDED + PRINTED)


def test_many_effects_together_equal_our_own(tmp_path: Path) -> None:
    """Combine effects of all kinds, two of them of one name, behind each other."""
    names = ("angle_gain", "rolling_resistance", "level_error", "viscous_damping", "angle_lag", "position_lag")
    effects: list[Acting] = [*map(effect, names), acting("level_error", {"angle": -0.001}), effect("level_drift")]
    model, beam = of_effects(RIG, effects), motion()
    expected = ours(RIG, effects, beam, S0)
    time, states = beam.time.tolist(), [tuple(one) for one in beam.states.tolist()]
    np.testing.assert_allclose(in_python(model, tmp_path).run(time, states, S0), expected, atol=ROUNDED)
    np.testing.assert_allclose(InC(model, tmp_path).run(beam, S0), expected, atol=ROUNDED + PRINTED)


def test_a_ball_that_slips_against_a_resistance_equals_our_own(tmp_path: Path) -> None:
    """Stop slipping and turning within steps where our own ball does."""
    effects = [
        acting("contact_slip", {"friction_coefficient": 0.003}),
        acting("rolling_resistance", {"coefficient": 0.002}),
    ]
    model, beam = of_effects(RIG, effects), motion()
    expected = ours(RIG, effects, beam, S0)
    rolling = ours(RIG, effects[1:], beam, S0)
    assert np.abs(expected - rolling).max() > 1e-3  # or it would not slip
    time, states = beam.time.tolist(), [tuple(one) for one in beam.states.tolist()]
    np.testing.assert_allclose(in_python(model, tmp_path).run(time, states, S0), expected, atol=ROUNDED)
    np.testing.assert_allclose(InC(model, tmp_path).run(beam, S0), expected, atol=ROUNDED + PRINTED)


def test_angles_alone_are_enough(tmp_path: Path) -> None:
    """Derive rate and acceleration from angles, alike in C and Python."""
    model, beam = of_effects(RIG, []), motion()
    compiled, plain = InC(model, tmp_path), in_python(model, tmp_path)
    time, angle = beam.time.tolist(), beam.states[:, 0].tolist()
    derived = plain.derive(time, angle)
    run = plain.run(time, derived, S0)
    np.testing.assert_allclose(compiled.run(beam, S0, angle_only=True), run, atol=1e-9 + PRINTED)
    # A cubic over ±0.1 s smooths a sine of 9 rad/s by (9·0.1)⁴ · 3/280, 0.7 %, of an amplitude that moves the ball by
    # K g 0.015/81 = 1 mm: well below 1 mm in 4 s.
    assert np.abs(np.array(run) - ours(RIG, [], beam, S0)).max() < 1e-3


ROWS = "0,0.01\n0.01,0.011\n0.02,0.012\n"


@pytest.fixture(scope="module")
def programs(tmp_path_factory: pytest.TempPathFactory) -> list[list[str]]:
    """The exported example, compiled and in Python, of a rig without effects."""
    folder, model = tmp_path_factory.mktemp("programs"), of_effects(RIG, [])
    return [[str(InC(model, folder).program)], [sys.executable, str(in_python(model, folder).__file__)]]


def printed(command: list[str], text: str, *start: str) -> tuple[int, str, str]:
    """Exit code and what an example prints of rows."""
    done = subprocess.run([*command, *(start or ("0.3",))], input=text.encode(), capture_output=True, check=False)
    return done.returncode, done.stdout.decode(), done.stderr.decode()


@pytest.mark.parametrize(
    "text",
    [
        "\ufeff" + ROWS,
        "\ufefftime_s,angle_rad\n" + ROWS,
        ROWS + "\n \n\n",
        ROWS.replace("\n", "\r\n"),
        ROWS.replace(",", " , "),
        "\n" + ROWS,
    ],
)
def test_rows_that_other_programs_write_are_taken(programs: list[list[str]], text: str) -> None:
    """Skip a byte order mark, a header and blank lines at the end, alike in C and Python."""
    for command in programs:
        assert printed(command, text) == printed(command, ROWS)
    assert printed(programs[0], ROWS) == printed(programs[1], ROWS)


@pytest.mark.parametrize(
    ("text", "line"),
    [
        (ROWS + "0.03,0.01,3\n", 4),
        (ROWS + "0.03,0.01x\n", 4),
        (ROWS + "0.03,0.01 0.02\n", 4),
        (ROWS + "0.03,nan\n", 4),
        (ROWS + "0.03,0x1\n", 4),
        (ROWS + "0.03,1_0\n", 4),
        (ROWS + "0.03,1e999\n", 4),
        (ROWS + "0.03,\n", 4),
        (ROWS + "\n0.03,0.01\n", 4),
        ("0,0,0,0,0\n" * 2, 1),
        ("0,0,1\n" * 2, 1),
        ("0,0,0,0\n1,0\n", 2),
        ("0,zero\n" + ROWS, 1),
    ],
)
def test_rows_that_are_none_are_refused_by_line(programs: list[list[str]], text: str, line: int) -> None:
    """End with exit code 2 and the line, alike in C and Python."""
    for command in programs:
        code, out, told = printed(command, text)
        assert (code, out) == (2, "")
        assert told.startswith(f"line {line}: give time_s,angle_rad or these and rate_rad_s")


@pytest.mark.parametrize("wrong", ["0.3m", "nan", "inf", "0,3", "", "0x1"])
def test_a_start_that_is_no_number_is_refused(programs: list[list[str]], wrong: str) -> None:
    """End with exit code 2, alike in C and Python."""
    for command in programs:
        assert printed(command, ROWS, "0.3", wrong) == (2, "", f"{wrong} is not a finite number\n")


def test_rows_too_far_apart_are_refused(programs: list[list[str]]) -> None:
    """Take the same longest gap in C and Python, 2048 steps."""
    for command in programs:
        assert printed(command, f"0,0,0,0\n{2048 * LONGEST_STEP},0,0,0\n", "0")[0] == 0
        code, _, told = printed(command, f"0,0,0,0\n{2048 * LONGEST_STEP + 0.1},0,0,0\n", "0")
        assert code == 2
        assert "too far apart" in told


def test_what_a_late_angle_leaves_unknown_is_blank(tmp_path: Path) -> None:
    """Leave positions blank that need angles after the last row, and print the others as our own law has them."""
    late = acting("channel_delay", {"delay": -0.035})
    model, beam = of_effects(RIG, [late]), motion(1.0)
    time, states = beam.time.tolist(), [tuple(one) for one in beam.states.tolist()]
    told = np.array(in_python(model, tmp_path).run(time, states, S0))
    blank = beam.time + 0.035 > beam.time[-1]
    assert blank.sum() == 4
    assert np.array_equal(np.isnan(told), blank)
    expected = SensorLaw(delay=-0.035).recorded(beam.time, ours(RIG, [], beam, S0))
    known = np.flatnonzero(~blank)[:-1]  # in the last interval a cubic has one neighbour only
    np.testing.assert_allclose(told[known], expected[known], atol=1e-8 * 30)
    rows = "\n".join(",".join(f"{one:.17g}" for one in row) for row in np.column_stack((beam.time, beam.states)))
    compiled = printed([str(InC(model, tmp_path).program)], rows)
    assert compiled == printed([sys.executable, str(tmp_path / "ball_beam.py")], rows)
    assert [line.endswith(",") for line in compiled[1].splitlines()[1:]] == blank.tolist()


def test_a_law_of_the_users_own_is_refused() -> None:
    """Say that a law in Python cannot be written as C."""
    own = Effect("magnet", "F = c s", (Parameter("c", "N/m", 0.0, 1.0, 0.1),), "here", force=Force("position", abs))
    model = of_effects(RIG, [Acting(own, {"c": 0.1})])
    for files in (c_files, python_files):
        with pytest.raises(InputError, match="magnet is a law in Python of the user's own"):
            files(model)
