"""The diagnosis report of a real, small diagnosis of a simulated rig whose ball rolls with resistance."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from harness.api.assemble import diagnosis_record
from harness.api.diagnosis import input_hashes
from harness.identify.diagnosis import Another, Diagnosis
from harness.identify.estimate.fit import Estimator, fit
from harness.identify.estimate.forecast import Forecast
from harness.identify.pose import problem_of
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.spline_term import Kind, Regressor, blank
from harness.identify.record import FindingRecord
from harness.identify.selection.criterion import Criterion
from harness.identify.selection.decision import Decision, Evidence, Rule
from harness.identify.selection.ledger import Line
from harness.identify.selection.spline_terms import visited
from harness.identify.validation.beam_dependence import SIGNIFICANT
from harness.identify.validation.held_out import fit_folds, on_held_out, on_identify
from harness.identify.validation.residual_acceleration import residual_acceleration
from harness.identify.verdict import Estimate, IdentifiedEffect, Verdict
from harness.preparation.recordings import observe
from harness.recording import load_case
from harness.report.diagnosis import render_diagnosis
from harness.report.diagnosis.account import FOUND, Account
from harness.report.diagnosis.inputs import _status
from harness.report.diagnosis.verdict import before_after, chart
from harness.scene import Scene
from harness.simulator import Experiment, write_case

NAME = "rolling_resistance"
EXPERIMENT = Experiment(hidden={NAME: {"coefficient": 0.004}}, duration=8.0, seed=1, predict=0)
# As `engine_errors` gives them, one engine failing with the effect in it.
GOOD = {"rms_m": {"1 s": 0.0123, "whole": 0.456}}
FAILED = {"rms_m": {}, "failed": "mujoco: the ball left the rails at 3.2 s"}
ENGINES = {
    "mujoco": {"before": GOOD, "after": FAILED, "heldout": {"before": GOOD, "after": FAILED}},
    "pybullet": {"before": GOOD, "after": GOOD, "heldout": {"before": GOOD, "after": GOOD}},
}


@pytest.fixture(scope="module")
def case(tmp_path_factory):
    """Recordings of 8 s, two to identify from."""
    folder = tmp_path_factory.mktemp("rolling")
    write_case(folder, EXPERIMENT)
    return load_case(folder)


def line(rule, effects, fitted, against, *, kept=False):
    """A line of the ledger, with the gain by the criterion."""
    decision = Decision(kept, Criterion().gain(fitted, against), "")
    return Line(rule, effects, fitted, against, Evidence(), decision)


@pytest.fixture(scope="module")
def diagnosis(case):
    """What `diagnose` would find, its search cut down to the true effect and one rival."""
    problem = problem_of(case)
    base = fit(problem, Hypothesis(()))
    found, rival = (
        fit(problem, Hypothesis((name,)), process_noise=base.process_noise) for name in (NAME, "level_error")
    )
    value, deviation = found.values()[NAME, "coefficient"], found.deviations()[NAME, "coefficient"]
    values = {"coefficient": Estimate(value, value - 2.0 * deviation, value + 2.0 * deviation, "1")}
    ledger = (
        line(Rule.ADD, (NAME,), found, base, kept=True),
        line(Rule.ADD, ("level_error",), rival, base),
    )
    held = fit_folds(problem, base, found)
    also = Another(on_identify(problem, base, found, lambda _: None), {})
    return Diagnosis(
        problem=problem,
        verdict=Verdict.EFFECT,
        effects=(IdentifiedEffect(NAME, values, ()),),
        base=base,
        found=found,
        ledger=ledger,
        identify=on_identify(problem, base, found, lambda _: None),
        heldout=on_held_out(held),
        engines=ENGINES,
        also={"swing.csv": also},
        unseen=("track_bump",),
    )


@pytest.fixture(scope="module")
def record(diagnosis, case):
    """What is written to diagnosis.json."""
    return diagnosis_record(diagnosis, case, 1.0, input_hashes(case))


@pytest.fixture(scope="module")
def html(diagnosis, record, case):
    """The page."""
    return render_diagnosis(diagnosis, record, case, command="harness diagnose rolling")


@pytest.mark.slow
def test_it_opens_offline(html):
    """Hold everything in one file: no address but data and namespaces."""
    assert not re.findall(r"""(?:src|href)=["'](?!data:|#)""", html)


@pytest.mark.slow
def test_the_first_screen_says_what_was_missing(html, diagnosis):
    """Say the verdict in words, before the first picture, with the value that was put in."""
    top = html[: html.index("<figure>")]
    assert re.search(r"A rolling resistance of 0\.00(39|40)\d* ± \S+ was missing", top)
    assert "the held-out error over 3 s decreases from" in top
    assert "simulated data" in top


@pytest.mark.slow
def test_the_effect_stands_there_with_its_interval(html, diagnosis):
    """Print the law and both ends of the 95 % interval."""
    estimate = diagnosis.effects[0].parameters["coefficient"]
    row = html[html.index("Effects found") :].split("</tr>")[1]
    assert "against rolling, set-valued" in row
    cells = [float(text) for text in re.findall(r"(?<![\d.])0\.00\d+", row)]
    assert cells == pytest.approx(
        [estimate.value, estimate.low, estimate.high], abs=0.1 * (estimate.high - estimate.low)
    )  # the width is printed with two digits


@pytest.mark.slow
def test_an_implausible_size_is_a_caveat(html, diagnosis, record, case):
    """Say of a parameter outside its usual range what that range is, and nothing of one inside."""
    steep = replace(
        diagnosis.effects[0], parameters={"coefficient": Estimate(0.12, 0.11, 0.13, "1")}, implausible=("coefficient",)
    )
    page = render_diagnosis(replace(diagnosis, effects=(steep,)), record, case, command="")
    said = "<code>rolling_resistance</code> has a <code>coefficient</code> outside 0 … 0.0500"
    assert said in page
    assert "which is implausibly large for a rolling resistance, was missing" in page
    assert "mplausibl" not in html


@pytest.mark.slow
def test_warnings_stand_on_the_first_screen(diagnosis, record, case):
    """Print what is wrong with the input before the first picture, and notes not there."""
    findings = [
        FindingRecord(severity="warning", where="rec_01.csv", text="the clock is odd", code="rate"),
        FindingRecord(severity="note", where="rec_01.csv", text="the header is odd", code="unused-columns"),
    ]
    page = render_diagnosis(diagnosis, record.model_copy(update={"findings": tuple(findings)}), case)
    top = page[: page.index("<figure>")]
    assert "the clock is odd" in top
    assert "the header is odd" not in top
    assert "the header is odd" in page


@pytest.mark.slow
def test_the_recording_with_readings_left_out_is_shown(diagnosis, record, case):
    """Draw readings that were left out in the recording that has most of them, and leave the frame to the others."""
    name = case.identify[1]
    mask = np.zeros(len(case.recordings[name].time), dtype=bool)
    mask[100:180] = True
    faulty = replace(case, recordings=case.recordings | {name: replace(case.recordings[name], set_aside=mask)})
    account = Account(diagnosis, record, faulty, "")
    assert account.shown.name == name
    drawn = {line.get_label(): line for line in before_after(account).axes[0].lines}
    assert len(drawn["left out of all fits"].get_xdata()) == 80


@pytest.mark.slow
def test_a_prediction_that_runs_away_hides_no_recording(diagnosis, record, case):
    """Frame readings and three times their spread where a prediction ends a hundred metres off, in either picture."""
    account = Account(diagnosis, record, case, "")
    shown = account.shown
    away = np.nan_to_num(shown.reading) + 100.0 * np.linspace(0.0, 1.0, len(shown.time)) ** 6
    ran = Forecast(shown.time, away, np.full(len(away), 1e-3), np.column_stack((away, np.zeros(len(away)))))
    spread = np.ptp(shown.reading[np.isfinite(shown.reading)])
    top, bottom = before_after(account, [(ran, FOUND)]).axes
    upper, lower = chart(account, [(ran, FOUND)]).panels
    for low, high in (top.get_ylim(), upper.frame):
        assert low <= shown.reading[np.isfinite(shown.reading)].min()
        assert high - low < 4.0 * spread
    for _, high in (bottom.get_ylim(), lower.frame):
        assert high < 1e3 * 7.0 * spread


@pytest.mark.slow
def test_errors_stand_by_source_and_horizon(html):
    """Print CAM and both engines before and after, a dash and the message where one failed, and where effects enter."""
    part = html[html.index('id="errors"') :]
    tables = [
        part[part.index(f"<caption><span>{name}") :].split("</table>")[0]
        for name in ("Held out", "Identification", "Also")
    ]
    for table in tables[:2]:
        heads = re.findall(r"<th scope=\"col\".*?>(.*?)</th>", table)
        assert heads == [
            "RMS error over", "CAM, before", "after", "MuJoCo, before", "after", "PyBullet, before", "after"
        ]  # fmt: skip
        row = next(row for row in table.split("</tr>") if "windows of 1 s" in row)
        assert [cell.split(">")[-1] for cell in row.split("</td>")[2:6]] == ["12.3 mm", "—", "12.3 mm", "12.3 mm"]
    assert "swing.csv" in tables[2]
    assert part.count("the ball left the rails at 3.2 s") == 1
    assert re.search(r"<dt>rolling resistance</dt><dd>force on the ball</dd>", part)


@pytest.mark.slow
def test_a_users_own_scene_is_named(html, diagnosis, record, case):
    """Say with the errors and with the inputs which scene file each engine ran; say nothing of built-in ones."""
    own = replace(case, scene=Scene(folder=case.path, mjcf=case.path / "parts" / "crank.xml"))
    page = render_diagnosis(diagnosis, record, own)
    said = "MuJoCo: <code>parts/crank.xml</code>; PyBullet: built-in scene"
    for anchor in ("errors", "inputs"):
        assert said in page[page.index(f'<section id="{anchor}"') :].split("</section>")[0]
    assert "built-in scene" not in html


@pytest.mark.slow
def test_warnings_of_engines_stand_with_their_errors(html, diagnosis, case):
    """Say which engine warns of what, of each warning the one with the largest number, also in diagnosis.json."""
    sags = [f"the linkage lets the beam depart from the recorded angle by up to {sag} rad" for sag in (4e-4, 7e-4)]
    engines = {name: one | {"warnings": (sags[1],) if name == "mujoco" else ()} for name, one in ENGINES.items()}
    also = replace(diagnosis.also["swing.csv"], engines={"mujoco": ENGINES["mujoco"] | {"warnings": (sags[0],)}})
    warned = replace(diagnosis, engines=engines, also={"swing.csv": also})
    record = diagnosis_record(warned, case, 1.0, input_hashes(case))
    assert record.errors.engines["mujoco"].warnings == (sags[1],)
    section = render_diagnosis(warned, record, case).partition('<section id="errors"')[2].partition("</section>")[0]
    assert f"MuJoCo: {sags[1]}" in section
    assert section.count("linkage") == 1
    assert "engines say" not in html


@pytest.mark.slow
def test_innovations_no_longer_know_the_angle(html, diagnosis):
    """Print p of the angle, which resistance left in the innovations and the found one takes out of them."""
    assert diagnosis.heldout.before.beam["angle"].p < SIGNIFICANT < diagnosis.heldout.after.beam["angle"].p
    row = html[html.index("independent of α: p") :].split("</tr>")[0]
    assert f"{diagnosis.heldout.after.beam['angle'].p:.2f}" in row


@pytest.mark.slow
def test_every_attempt_is_in_the_ledger(html, diagnosis, record):
    """List what was tried under its hash, and set apart what was kept."""
    table = html[html.index('id="ledger"') : html.index('id="inputs"')]
    rows = re.findall(r'<tr class="(\w*)">.*?</tr>', table)
    assert rows == ["best" if one.kept else "" for one in diagnosis.ledger]
    assert all(one.because in table for one in diagnosis.ledger)
    hashes = [line.hash for line in record.ledger]
    assert all(f"<code>{one[:8]}</code>" in table for one in hashes)


@pytest.mark.slow
def test_rivals_are_weighed(html, diagnosis):
    """A tilt that nobody levelled is no rival to a resistance."""
    table = html[html.index('id="rivals"') : html.index('id="ledger"')]
    behind = Criterion().gain(diagnosis.found, diagnosis.ledger[1].fit)
    assert f"{behind:.1f}" in table
    assert re.search(r"level_error.*<td class=\"text\">yes</td>", table)


@pytest.mark.slow
def test_rivals_by_held_out_errors_are_so_many_per_cent_worse(diagnosis, case):
    """Where held-out errors decided, give those of a rival over what was found, and tell 3 % apart from nothing."""

    def by_errors(one, metres):
        return replace(one, estimator=Estimator.FREE_RUNS, held_out=(metres,) * 4)

    found, base = by_errors(diagnosis.found, 0.010), by_errors(diagnosis.base, 0.030)
    near, far = (by_errors(diagnosis.ledger[1].fit, metres) for metres in (0.0103, 0.015))
    tried = (
        line(Rule.JOINT, (NAME,), found, base, kept=True),
        line(Rule.EXTEND, ("level_error",), near, base),
        line(Rule.EXTEND, ("viscous_damping",), far, base),
    )
    decided = replace(diagnosis, base=base, found=found, ledger=tried)
    page = render_diagnosis(decided, diagnosis_record(decided, case, 1.0, input_hashes(case)), case)
    table = page[page.index('id="rivals"') : page.index('id="ledger"')]
    assert "held-out error above what was found" in table
    assert "BIC" not in table
    assert re.search(r"level_error.*>3</td>.*>no<", table)
    assert re.search(r"viscous_damping.*>50</td>.*>yes<", table)


def test_a_value_that_was_set_aside_is_not_called_given():
    """Call a quantity of the rig given only where the given value is the one that is used."""
    assert _status(5.03e-6, 5.03e-6) == "given"
    assert _status(9e-5, None) == "estimated or assumed"
    assert _status(9e-5, 5.031e-6) == "estimated, contrary to the given 5.031·10⁻⁶"


@pytest.mark.slow
def test_the_law_lies_on_the_trace(diagnosis, case):
    """The acceleration that the found resistance gives is k c N/m against the motion, and is what the model leaves.

    N/m = g cos α − 2 ṡ α̇ − s α̈ − (h + r) α̇² in the middle of a step. Within half a step of 10 ms the ball moves by
    2 mm at most, 0.5 % of s, in a term that is a tenth of N at most: 5e-4. Off the turning points, where the estimate
    rounds the step off, the model leaves that much but for what the recording leaves open.
    """
    problem, rig = diagnosis.problem, diagnosis.problem.rig
    for record in problem.recordings:
        ball = observe(case.recordings[record.name], case.sensors, rig).ball
        seen = residual_acceleration(problem, diagnosis.found, record, ball)
        fast = np.abs(seen.velocity[:-1]) > 0.03  # the last stamp has no step of its own
        s, v, law = (each[:-1][fast] for each in (seen.position, seen.velocity, seen.law))
        angle, rate, angular = record.table[2 * record.grid.marks[:-1][fast] + 1, :3].T
        arm = rig.eccentricity + rig.rolling_radius
        normal = rig.gravity * np.cos(angle) - 2.0 * v * rate - s * angular - arm * rate**2
        pull = rig.rolling_ratio * diagnosis.found.values()[NAME, "coefficient"] * normal
        assert law == pytest.approx(-np.sign(v) * pull, rel=5e-4)
        left = seen.residual[:-1][fast] - law
        assert np.sqrt(np.mean(left**2)) < 2.0 * np.sqrt(np.mean(seen.deviation[:-1][fast] ** 2))
        assert np.sqrt(np.mean(left**2)) < 0.5 * np.sqrt(np.mean(law**2))


@pytest.mark.slow
def test_nothing_found_adds_nothing(diagnosis, case):
    """The law of no effect is zero, to the bit."""
    problem, record = diagnosis.problem, diagnosis.problem.recordings[0]
    ball = observe(case.recordings[record.name], case.sensors, problem.rig).ball
    assert not np.any(residual_acceleration(problem, diagnosis.base, record, ball).law)


@pytest.mark.slow
def test_no_finding_needs_no_table(diagnosis, case):
    """Where nothing is missing the page says so, and draws no second prediction."""
    none = replace(diagnosis, verdict=Verdict.NONE, effects=(), found=diagnosis.base, heldout=diagnosis.heldout)
    page = render_diagnosis(none, diagnosis_record(none, case, 1.0, input_hashes(case)), case)
    assert "No missing effect was found" in page
    assert "Effects found (" not in page
    assert 'id="rivals"' not in page


@pytest.mark.slow
def test_the_nearest_rival_of_a_spline_term_is_another_spline_term(diagnosis, case):
    """Name the spline term of something else that comes closest, not the same one with more nodes, nor an effect."""
    problem, base = diagnosis.problem, diagnosis.base
    kinds = (Regressor.POSITION, Regressor.ANGLE)
    terms = [blank(Kind(kind), *visited(problem, kind)) for kind in kinds]
    found, other, finer = (
        fit(problem, Hypothesis((), one), process_noise=base.process_noise) for one in (*terms, terms[0].finer())
    )
    tried = (
        line(Rule.SPLINE, (), found, base, kept=True),
        line(Rule.SPLINE, (), other, base),
        line(Rule.SPLINE, (), finer, base),
        line(Rule.REFINE, (), finer, found),
    )
    ledger = (*diagnosis.ledger, *tried)
    unlisted = replace(diagnosis, verdict=Verdict.UNLISTED, effects=(), found=found, ledger=ledger)
    page = render_diagnosis(unlisted, diagnosis_record(unlisted, case, 1.0, input_hashes(case)), case)
    assert "the nearest is spline of angle," in page


@pytest.mark.slow
def test_a_spline_term_has_a_section_of_its_own(diagnosis, case):
    """An unlisted force is drawn against what it depends on."""
    term = blank(Kind(Regressor.POSITION), *visited(diagnosis.problem, Regressor.POSITION))
    found = fit(diagnosis.problem, Hypothesis((), term), process_noise=diagnosis.base.process_noise)
    entry = line(Rule.SPLINE, (), found, diagnosis.base, kept=True)
    unlisted = replace(diagnosis, verdict=Verdict.UNLISTED, effects=(), found=found, ledger=(*diagnosis.ledger, entry))
    page = render_diagnosis(unlisted, diagnosis_record(unlisted, case, 1.0, input_hashes(case)), case)
    assert "a force that depends on the ball&#39;s position" in page
    nodes = page[page.index("Nodes of the spline term") :].split("</table>")[0]
    assert nodes.count('<th scope="row">') == len(term.nodes)
