"""What a verdict says of a fit, without a search."""

from __future__ import annotations

from dataclasses import replace

import pytest

from analytic.effects import acting
from harness.identify.estimate.fit import Fit, fit
from harness.identify.filter.run import deviance
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.selection.decision import Decision, Evidence, Rule
from harness.identify.selection.ledger import Line
from harness.identify.selection.search import Selection
from harness.identify.verdict import judge
from tests.posed import Posed


@pytest.mark.parametrize(
    ("beside", "same"), [((), ()), (("level_error",), ("track_curvature",)), (("viscous_damping",), ())]
)
def test_a_beam_that_bends_beside_a_level_is_a_hill(
    plain: Posed, beside: tuple[str, ...], same: tuple[str, ...]
) -> None:
    """Name a curvature as indistinguishable from a compliance where a level is fitted beside it, and only there."""
    problem = plain.problem
    base, found = (fit(problem, Hypothesis(names)) for names in ((), (*beside, "beam_compliance")))
    effects = {one.name: one for one in judge(Selection(problem, base, found, ())).effects}
    assert effects["beam_compliance"].indistinguishable_from == same


def test_a_hill_has_the_likelihood_of_a_beam_that_bends(plain: Posed) -> None:
    """Take κ (s_c − s) for a level of κ s_c and a compliance of −κ/(m g): the same law to all digits."""
    problem, (curvature, centre) = plain.problem, (-0.02, 0.3)
    weight = problem.rig.mass * problem.rig.gravity
    split = (
        acting("level_error", {"angle": curvature * centre}),
        acting("beam_compliance", {"compliance": -curvature / weight}),
    )
    hill = (acting("track_curvature", {"curvature": curvature, "centre": centre}),)
    terms = fit(problem, Hypothesis(())).terms
    one, other, none = (deviance(problem, replace(terms, effects=each), 1e-4) for each in (hill, split, ()))
    # The filter's slopes are differences over 1 µm and 10 µm/s, of which rounding leaves 1e-8.
    assert one == pytest.approx(other, rel=1e-6)
    assert abs(one - none) > 10.0


@pytest.mark.parametrize("alone", [False, True])
def test_what_only_a_pair_does_is_told_of_the_pair(plain: Posed, alone: bool) -> None:
    """Name a pair as a rival where it fits as well in the place of an effect, unless one of it does so alone."""
    problem, pair = plain.problem, ("level_error", "rolling_resistance")
    base, found = (fit(problem, Hypothesis(names)) for names in ((), ("directional_resistance",)))
    worse = replace(found, deviance=found.deviance + 100.0, quiet_deviance=found.quiet_deviance + 100.0)

    def tried(rule: Rule, effects: tuple[str, ...], like: Fit, against: Fit) -> Line:
        """A line of the ledger with a fit of these effects that is as good as another."""
        made = replace(like, hypothesis=Hypothesis(effects), theta=like.theta[: len(effects)])
        return Line(rule, effects, made, against, Evidence(), Decision(False, 0.0, ""))

    single = found if alone else worse
    ledger = (tried(Rule.ADD, pair[:1], single, base), tried(Rule.SPLIT, pair, found, found))
    (effect,) = judge(Selection(problem, base, found, ledger)).effects
    assert effect.together == (() if alone else (pair,))
    assert effect.indistinguishable_from == (pair[:1] if alone else pair)
