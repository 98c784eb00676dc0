"""The next experiment: feasible, deterministic, and worth what it claims when an independent rig carries it out."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from analytic.effects import CATALOGUE
from harness.identify.design.choose import choose_to_detect, choose_to_discriminate, pairs_of
from harness.identify.design.closed_loop import simulate_closed_loop
from harness.identify.design.excitation import LIBRARY, envelope_of
from harness.identify.design.proposal import MOST_RUNS, NOTHING, Proposal, Separation, sentence
from harness.identify.estimate.fit import Estimator, Fit, fit
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.settings import DEFAULT
from harness.identify.selection.criterion import Criterion
from harness.identify.selection.decision import Decision, Evidence, Rule
from harness.identify.selection.ledger import Line
from tests.identify.short_rig import GAIN, LEVEL, RADIUS, ROLLING, SEEDS, Short, on_flat_rail, short


@pytest.fixture(scope="module")
def radius(tmp_path_factory: pytest.TempPathFactory) -> Short:
    """A rolling radius that a gain of the position sensor imitates to the last on 5 s of data."""
    return short(tmp_path_factory.mktemp("radius"), {RADIUS: {"radius": 0.0112}}, GAIN)


@pytest.fixture(scope="module")
def proposal(radius: Short) -> Proposal:
    """What is proposed then."""
    made = choose_to_discriminate(radius.problem, radius.found, [radius.pair])
    assert made is not None
    return made


@pytest.fixture(scope="module")
def pairs(radius: Short, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Short]:
    """Rigs with effects that short data hardly tell from a rival."""
    folder = tmp_path_factory.mktemp
    return {
        "radius": radius,
        "curvature": short(folder("curvature"), {"track_curvature": {"curvature": 0.01, "centre": 0.3}}, LEVEL),
        "rolling": short(folder("rolling"), {ROLLING: {"coefficient": 0.0003}}, "viscous_damping", 4.0),
        "damping": short(folder("damping"), {"viscous_damping": {"coefficient": 0.008}}, "quadratic_drag"),
    }


@pytest.mark.parametrize(
    "name", ["radius", "rolling", *(pytest.param(name, marks=pytest.mark.slow) for name in ("curvature", "damping"))]
)
def test_the_independent_rig_confirms_the_expected_separation(name: str, pairs: dict[str, Short]) -> None:
    """Expect the separation that comes out when the virtual rig plays the profile and both are fitted to its records.

    σ is scaled so that a separation scatters by one. Noise of the readings averages out over the seeds; the rounding of
    the angle is the same in all of them and does not: so the mean may be off by one.
    """
    rig = pairs[name]
    proposed = choose_to_discriminate(rig.problem, rig.found, [rig.pair])
    assert proposed is not None
    (one,) = proposed.separations
    assert one.at_hand < 4.0
    assert one.expected > one.at_hand + 1.5
    run = rig.played(proposed)
    before = rig.rival.deviance - rig.found.deviance
    reached = []
    for seed in SEEDS:
        alone = replace(rig.problem, recordings=(rig.recorded(run, seed),))
        again = partial(fit, alone)
        found, rival = (again(each.hypothesis, process_noise=each.process_noise) for each in (rig.found, rig.rival))
        reached.append(math.sqrt(max(before + rival.deviance - found.deviance, 0.0)))
    assert abs(float(np.mean(reached)) - one.expected) < 1.0, reached


def test_recordings_diagnosed_together_bring_at_least_that(radius: Short, proposal: Proposal) -> None:
    """Separate by no less than expected, but for one σ, when the new recording joins the one at hand."""
    new = radius.recorded(radius.played(proposal), SEEDS[0])
    joint = replace(radius.problem, recordings=(*radius.problem.recordings, new))
    found, rival = (
        fit(joint, each.hypothesis, process_noise=each.process_noise) for each in (radius.found, radius.rival)
    )
    assert math.sqrt(rival.deviance - found.deviance) > proposal.smallest.expected - 1.0


def test_profiles_keep_the_limits(radius: Short) -> None:
    """Ask of the beam and of the ball no more than the recordings show, and a fifth; nearly every profile fits that."""
    envelope = envelope_of(radius.problem)
    states = np.abs(np.concatenate([one.drive.states for one in radius.problem.recordings]))
    assert envelope.angle <= 1.2 * states[:, 0].max()
    assert envelope.rate <= 1.2 * states[:, 1].max()
    assert envelope.acceleration <= 1.2 * states[:, 2].max()
    made = [
        simulate_closed_loop(radius.problem, radius.found.terms, radius.found.process_noise, one, envelope)
        for one in LIBRARY
    ]
    feasible = [one for one in made if one is not None]
    assert len(feasible) >= 0.8 * len(LIBRARY)
    for one in feasible:
        assert np.all(np.abs(one.recording.drive.states).max(axis=0) <= envelope.limits), one.recording.name
        assert envelope.low <= one.position.min() < one.position.max() <= envelope.high, one.recording.name
        assert np.ptp(one.position) > 0.05 * (envelope.high - envelope.low), one.recording.name


def test_the_ball_stays_on_the_beam_of_the_independent_rig(radius: Short, proposal: Proposal) -> None:
    """Played blindly, end where expected within three of the deviations that are claimed, and stay in the room."""
    run = radius.played(proposal)
    expected = np.interp(run.time, proposal.time, proposal.reading)
    assert np.max(np.abs(run.position - expected)) < 3.0 * proposal.open_loop_drift
    assert proposal.envelope.low - 3.0 * proposal.open_loop_drift < run.position.min()
    assert run.position.max() < proposal.envelope.high + 3.0 * proposal.open_loop_drift


def test_a_known_beam_is_used_to_its_ends(radius: Short) -> None:
    """Let the ball go up to 5 cm from either end of a beam of known length, and no further than before otherwise."""
    ball = radius.problem.recordings[0].reading
    known, unknown = envelope_of(radius.problem, 0.6), envelope_of(radius.problem)
    assert (known.low, known.high) == pytest.approx((0.05, 0.55))
    assert np.nanmin(ball) <= unknown.low < unknown.high <= np.nanmax(ball)
    longer = choose_to_discriminate(radius.problem, radius.found, [radius.pair], length=0.6)
    assert longer is not None
    assert np.ptp(longer.reading) > 2.0 * np.ptp(ball[np.isfinite(ball)])


def test_the_same_data_give_the_same_profile(radius: Short, proposal: Proposal) -> None:
    """Propose the same to the bit, whichever thread finishes first."""
    again = choose_to_discriminate(radius.problem, radius.found, [radius.pair])
    assert again is not None
    assert again.separations == proposal.separations
    assert again.tried == proposal.tried
    np.testing.assert_array_equal(again.angle, proposal.angle)


def test_the_best_profile_is_chosen(proposal: Proposal) -> None:
    """Choose the profile whose smallest separation is largest, and begin at rest on a level beam."""
    assert proposal.tried[proposal.profile.name] == pytest.approx(max(proposal.tried.values()), abs=0.3)  # one step
    assert proposal.angle[0] == 0.0
    assert abs(proposal.reading[1] - proposal.reading[0]) < 1e-5
    assert set(proposal.table()) == {"time_s", "beam_angle_rad", "ball_position_m"}


def test_what_goes_unseen_is_shown(tmp_path: Path) -> None:
    """Find the profile on which a lag of typical size is seen, and see it there as clearly as expected."""
    rig = short(tmp_path, {}, "position_lag")
    effects = ("position_lag", LEVEL, "contact_slip")
    proposed = choose_to_detect(rig.problem, rig.found, effects)
    assert proposed is not None
    lag, level, slip = proposed.separations
    assert (lag.told, level.told, slip.told) == (True, True, False)  # no beam tilts far enough for a ball to slip
    lagging = replace(rig.experiment, hidden={"position_lag": {"time_constant": 0.03}})
    new = replace(rig, experiment=lagging)
    alone = replace(rig.problem, recordings=(new.recorded(new.played(proposed), SEEDS[0]),))
    without, with_it = fit(alone, Hypothesis(())), fit(alone, Hypothesis(("position_lag",)))
    reached = math.sqrt(without.deviance - with_it.deviance)
    assert reached == pytest.approx(lag.expected, abs=1.0)  # as above
    assert reached > lag.needed


def test_a_rig_that_has_shown_nothing_is_asked_nothing(radius: Short) -> None:
    """Propose nothing where ball and beam stood still: nobody knows what they can do."""
    (one,) = radius.problem.recordings
    still = replace(one, reading=np.where(np.isfinite(one.reading), 0.3, np.nan))
    assert choose_to_discriminate(replace(radius.problem, recordings=(still,)), radius.found, [radius.pair]) is None


def test_nothing_is_proposed_where_nothing_would_be_seen(radius: Short) -> None:
    """Propose nothing to see a slip that no allowed angle brings about."""
    assert choose_to_detect(radius.problem, radius.found, ("contact_slip",)) is None


def tried(name: str, one: Fit, against: Fit) -> Line:
    """A line of the ledger: an effect that was tried and not kept."""
    return Line(Rule.ADD, (name,), one, against, Evidence(), Decision(False, 0.0, ""))


def test_rivals_are_those_that_are_not_told_apart(radius: Short) -> None:
    """Hold what was found against its indistinguishable rivals, and where there is none against the nearest."""
    nothing, level = (fit(radius.problem, Hypothesis(names)) for names in ((), (LEVEL,)))
    both = fit(radius.problem, Hypothesis((RADIUS, LEVEL)))
    entries = [
        tried(name, one, against)
        for name, one, against in (
            (RADIUS, radius.found, nothing),
            (LEVEL, level, nothing),
            (GAIN, radius.rival, nothing),
            (LEVEL, both, radius.found),
        )
    ]
    (asked,) = pairs_of(radius.found, entries, {RADIUS: ((LEVEL,),)}, Criterion())
    assert (asked.found, asked.rival, asked.fit) == (RADIUS, LEVEL, level)
    (nearest,) = pairs_of(radius.found, entries, {RADIUS: ()}, Criterion())
    assert (nearest.found, nearest.rival, nearest.fit) == (RADIUS, GAIN, radius.rival)
    assert nearest.needed == pytest.approx(math.sqrt(DEFAULT.rival))  # as many numbers as the found one
    assert pairs_of(radius.found, entries[:1], {}, Criterion()) == []
    assert pairs_of(radius.found, entries, {RADIUS: (("track_bump",),)}, Criterion()) == [
        nearest
    ]  # never tried in its place


def test_a_law_that_holds_what_was_found_is_no_rival(radius: Short) -> None:
    """Ask for nothing that tells a law from itself with a number more, for no recording does."""
    wider = replace(radius.rival, theta=np.zeros(2), deviance=radius.found.deviance)
    entries = [tried(GAIN, wider, radius.found)]
    assert pairs_of(radius.found, entries, {RADIUS: ()}, Criterion()) == []


def test_recordings_that_have_told_ask_for_no_more(radius: Short) -> None:
    """Propose nothing where what is to be told apart is, and no move would add to it."""
    assert (
        choose_to_discriminate(radius.problem, radius.found, [replace(radius.pair, fit=radius.found, needed=0.0)])
        is None
    )


def test_deviances_of_fits_to_free_runs_tell_nothing_of_the_present_recordings(radius: Short) -> None:
    """Expect of a new recording alone what it separates: such fits are no optima of their deviance, and may be far."""
    found, rival = (
        replace(one, estimator=Estimator.FREE_RUNS, held_out=(0.01,)) for one in (radius.found, radius.rival)
    )
    far = replace(rival, deviance=found.deviance - 1e6)
    (pair,) = pairs_of(found, [tried(GAIN, far, found)], {RADIUS: ((GAIN,),)}, Criterion())
    assert pair.needed == pytest.approx(math.sqrt(6.0))
    proposal = choose_to_discriminate(radius.problem, found, [pair])
    assert proposal is not None
    assert proposal.separations[0].at_hand == 0.0
    assert proposal.separations[0].expected > 0.1


def told(proposal: Proposal, one: Separation) -> str:
    """The sentence for one separation."""
    return sentence(replace(proposal, separations=(one,)))


def test_the_sentence_says_what_to_do(proposal: Proposal) -> None:
    """Name both, the profile and the σ; say how often to repeat it, that it is in vain, or that it is not needed."""
    enough = told(proposal, Separation("a", "b", 0.8, 7.4, 2.4))
    assert enough == (
        f"To distinguish a from b, run the profile “{proposal.profile.name}”: expected separation 7.4 σ "
        "(0.8 σ on the data at hand)."
    )
    thrice = Separation("a", "b", 0.0, 1.5, 2.4)  # 3 · 1.5² > 2.4² > 2 · 1.5²
    assert "To reach the 2.4 σ that distinguish them, run it 3 times." in told(proposal, thrice)
    vain = Separation("a", "b", 0.0, 0.1, 2.4)
    assert vain.runs > MOST_RUNS
    assert told(proposal, vain).startswith("No motion within the operating envelope distinguishes a from b")
    assert "run the profile" not in told(proposal, vain)
    assert told(proposal, Separation("a", "b", 0.0, 7.4, 2.4)).endswith("expected separation 7.4 σ.")
    assert "The recordings distinguish a from b by 9.0 σ" in told(proposal, Separation("a", "b", 9.0, 11.0, 2.4))
    assert "it reveals 1 (lag at 7.0 σ)" in told(proposal, Separation("lag", NOTHING, 0.0, 7.0, 3.7))


def test_an_effect_is_designed_for_at_a_size_that_the_rig_can_have(radius: Short) -> None:
    """Look for a radius smaller than the ball's on a flat rail, where it is the largest there can be."""
    flat = on_flat_rail(radius.problem)
    parameter = CATALOGUE[RADIUS].parameters[0]
    assert parameter.typical > flat.rig.radius  # of the paper's ball, larger than this one
    low, high = parameter.bounds_on(flat.visited, flat.rig)
    assert low < parameter.typical_on(flat.visited, flat.rig) < high
    assert choose_to_detect(flat, fit(flat, Hypothesis(())), [RADIUS]) is not None
