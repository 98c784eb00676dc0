"""Every number that decides how effects are found: one frozen object, each field with its meaning and reason.

`docs/settings.md` lists them with a sensitivity run: what changes on blind trials when a field is halved or doubled.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields
from typing import Any


def _setting(default: Any, meaning: str, reason: str) -> Any:
    return field(default=default, metadata={"meaning": meaning, "reason": reason})


@dataclass(frozen=True, kw_only=True)
class Settings:
    """Settings of the identification; `described` gives meaning and reason of each field."""

    overdispersion: float = _setting(
        1.75**2,
        "ĉ: deviances are divided by it (quasi-BIC), variances of estimates multiplied [1]",
        "the angle's error is not white as the filter assumes; chosen on blind trials so that intervals cover 95 %",
    )
    keep: float = _setting(
        6.0,
        "decrease of the criterion from which on a term is kept, beyond its price of log n a parameter [1]",
        "strong evidence (Kass and Raftery, JASA 90, 1995), as the best of some twenty candidates",
    )
    rival: float = _setting(
        6.0,
        "difference of the criterion up to which two explanations are not told apart [1]",
        "strong evidence begins at 6 (Kass and Raftery, JASA 90, 1995)",
    )
    pair_penalty: float = _setting(
        1.0,
        "by how much two effects must explain more than the one effect that imitates them [1]",
        "two causes are the rarer explanation; chosen on blind trials, where one true cause was 0.2 behind at most and "
        "two true ones 3.4 ahead at least",
    )
    max_effects: int = _setting(
        4, "effects that are found beside the known ones", "recordings of this length do not tell more apart"
    )
    spline_keep: float = _setting(
        20.0,
        "decrease of the BIC from which on a spline term is kept [1]",
        "eight kinds of twelve parameters each can follow what a law of the catalogue rounds off",
    )
    explained_ratio: float = _setting(
        3.0,
        "root density of the process noise over the input-noise floor up to which nothing is left to explain [1]",
        "the floor is estimated within a factor of two; misspecified models lie a factor of ten above it",
    )
    unexplained_ratio: float = _setting(
        10.0,
        "the same ratio from which on a result without any effect is not identifiable [1]",
        "an order of magnitude: something acts that neither catalogue nor spline term describes",
    )
    unseen_share: float = _setting(
        0.5,
        "share of the catalogue below its detection limit from which on the data cannot tell [1]",
        "more than half of what could act would go unseen",
    )
    screened_slack: float = _setting(
        4.0,
        "by how much a screening fit may miss its price and still be followed by a fit [1]",
        "a screening fit takes one Gauss–Newton step, which leaves a few units of the criterion",
    )
    screened_share: float = _setting(
        0.1,
        "share of the best predicted decrease that a candidate needs to be fitted [1]",
        "nonlinear laws keep less of their predicted decrease than others",
    )
    replacement_share: float = _setting(
        0.4, "the same share for what stands in the place of an effect [1]", "it has to do most of what the effect did"
    )
    max_fitted: int = _setting(
        8, "candidates of a round that are fitted", "of twenty, those far from the best never won in blind trials"
    )
    abandon_behind: float = _setting(
        30.0,
        "distance of the criterion behind the best after one round of fitting, beyond which a fit is abandoned [1]",
        "five times what two explanations are still told apart by",
    )
    absorbed_share: float = _setting(
        0.1,
        "share of the process noise that an effect must leave to count as the main cause [1]",
        "its replacement is then searched from the other effects' values beside it",
    )
    restarts_from: int = _setting(
        4, "runners-up of the first round with which the search may begin anew", "later ones never led further"
    )
    restart_share: float = _setting(
        0.25, "share of the winner's decrease that a runner-up needs for it [1]", "less does not catch up"
    )
    restart_slack: float = _setting(
        10.0,
        "by how much its best screening fit may be behind the result [1]",
        "a fit gains that much over a screening fit",
    )
    spline_nodes: int = _setting(
        12, "nodes of a spline term at first; half as many more where they pay", "a bump of a tenth of the range shows"
    )
    spline_share: float = _setting(
        0.5,
        "share of the best predicted decrease that a spline term needs to be fitted [1]",
        "it is nearly linear in its nodes and keeps what is predicted",
    )
    min_windows: int = _setting(
        12, "windows from which on cross-validation decides", "below, their scatter decides instead"
    )
    validated_candidates: int = _setting(
        3, "candidates that are fitted without each recording, best on all first", "each costs a fit per recording"
    )
    validated_effects: int = _setting(2, "effects that cross-validation may add", "each shares the chance of the next")
    validated_rounds: int = _setting(2, "rounds of a fit without one recording", "it begins where the full fit ended")
    chance: float = _setting(
        0.05,
        "two-sided share of false positives that all candidates of a cross-validation have together [1]",
        "the usual one",
    )
    max_rounds: int = _setting(6, "rounds of parameters and process noise in turn", "three are usual")
    converged: float = _setting(
        0.05, "change of the deviance at which a fit stands [1]", "a hundredth of what decides anything"
    )
    starts_followed: int = _setting(
        2, "starting points that are followed to their ends", "the likeliest after a screening fit"
    )
    noise_floor_share: float = _setting(
        0.25,
        "share of the input-noise floor that the process noise is never below [1]",
        "a flexible term could follow everything else",
    )

    @property
    def inflation(self) -> float:
        """Root of the overdispersion: factor of standard errors [1]."""
        return math.sqrt(self.overdispersion)

    @classmethod
    def described(cls) -> list[tuple[str, Any, str, str]]:
        """Name, default, meaning and reason of every field."""
        return [(one.name, one.default, one.metadata["meaning"], one.metadata["reason"]) for one in fields(cls)]


DEFAULT = Settings()
