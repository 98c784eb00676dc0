"""Tuning constants of the identification: one frozen object, each field with its meaning and its reason."""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from typing import Any


def _setting(default: Any, meaning: str, reason: str) -> Any:
    return field(default=default, metadata={"meaning": meaning, "reason": reason})


@dataclass(frozen=True, kw_only=True)
class Settings:
    """Settings of the identification; `described` gives meaning and reason of each field."""

    keep: float = _setting(
        6.0,
        "smallest decrease of the BIC for which an effect is kept [1]",
        "one of 25 candidates that do nothing exceeds 6 + log n with a probability of 1.1 % for n = 600 readings and "
        "0.5 % for 3200; an effect of four standard errors does so with 68 % and 60 %, one of six with 99 %",
    )
    rival: float = _setting(
        6.0,
        "largest difference of the criterion for which two hypotheses are indistinguishable [1]",
        "strong evidence begins at 6 (Kass and Raftery, JASA 90, 1995)",
    )
    pair_penalty: float = _setting(
        3.0,
        "prior penalty on two effects in place of one that imitates them [1]",
        "two causes are the rarer explanation; chosen on blind trials: the pair gained at most 0.6 where one effect "
        "acted, at least 10 where two did",
    )
    max_effects: int = _setting(
        4, "largest number of effects that are selected", "recordings of this length do not identify more"
    )
    spline_keep: float = _setting(
        20.0,
        "smallest decrease of the BIC for which a spline term is kept, and difference of the BIC up to which another "
        "regressor is named too [1]",
        "ten kinds with twelve parameters each can fit small errors in the law of a catalogue effect",
    )
    at_floor_ratio: float = _setting(
        3.0,
        "ratio of root process noise to the input-noise floor up to which nothing is left to explain [1]",
        "what the model leaves out then disturbs the ball as little as the angle error does, within the factor of two "
        "to which the floor is known; misspecified models are a factor of ten above it",
    )
    above_floor_ratio: float = _setting(
        10.0,
        "the same ratio above which a result without any effect is not identifiable [1]",
        "an order of magnitude: something acts that neither the catalogue nor a spline term describes",
    )
    unseen_share: float = _setting(
        0.5,
        "share of the candidates below their detection limit above which the verdict is not_identifiable [1]",
        "more than half of the possible effects would not be detected",
    )
    screened_slack: float = _setting(
        4.0,
        "increase of the criterion that a screening fit may predict for a candidate that is still fitted [1]",
        "one Gauss–Newton step misses the optimum by a few units of the criterion",
    )
    screened_share: float = _setting(
        0.1,
        "share of the best predicted decrease that a candidate needs to be fitted, and of the decrease that remains "
        "within which a further starting point is followed [1]",
        "nonlinear laws reach less of their predicted decrease than others",
    )
    replacement_share: float = _setting(
        0.4, "the same share for the replacement of a main effect [1]", "it has to explain most of what the effect did"
    )
    max_fitted: int = _setting(
        8, "largest number of candidates fitted in a round", "in blind trials no later candidate was ever the best"
    )
    abandon_behind: float = _setting(
        30.0,
        "difference of the criterion from the best after one round of fitting beyond which a fit is abandoned [1]",
        "five times the difference below which two hypotheses are indistinguishable",
    )
    main_effect_ratio: float = _setting(
        0.1,
        "ratio of process noise with and without an effect below which it is the main effect [1]",
        "the fit without a main effect has distorted values, so its replacements start from those with it",
    )
    restarts_from: int = _setting(
        4, "runners-up of the first round from which the search may restart", "in blind trials no later one helped"
    )
    restart_share: float = _setting(
        0.25, "share of the winner's decrease that a restart needs [1]", "in blind trials no smaller share caught up"
    )
    restart_slack: float = _setting(
        30.0,
        "difference by which the best screening fit of a restart may exceed the criterion of the result [1]",
        "a full fit gains about as much over a screening fit",
    )
    spline_nodes: int = _setting(
        12,
        "initial number of nodes of a spline term; doubled while that pays, up to 96",
        "resolves a bump of a tenth of the range",
    )
    spline_share: float = _setting(
        0.5,
        "share of the best predicted decrease that a spline term needs to be fitted [1]",
        "it is nearly linear in its nodes, so that it reaches the predicted decrease",
    )
    explained_least: float = _setting(
        0.25,
        "smallest share of the density of the process noise that an effect has to take away where that is far above "
        "the input-noise floor after it [1]",
        "each of four effects of one size that act together takes away a quarter; what explains less follows from a "
        "likelihood whose noise model is wrong",
    )
    given_up_from: int = _setting(
        400,
        "number of coarse readings from which the stepwise search may be given up for what they tell [1]",
        "thirty for each node of a spline term; of shorter recordings the whole search takes seconds",
    )
    min_blocks: int = _setting(
        4, "smallest number of held-out blocks of 3 s that decide", "with fewer, a bootstrap has no meaning"
    )
    poor_errors: float = _setting(
        1.25,
        "ratio of the median error of predictions over 3 s to that of a complete model above which they are poor [1]",
        "0.45 to 1.07 in six simulated cases with the right effects; what is missing then costs 0.75 of the errors of "
        "readings and angle",
    )
    held_out_least: float = _setting(
        0.2,
        "smallest share by which effects tried together have to reduce the held-out error [1]",
        "a dozen sets of effects are tried; chance reduces the error of few blocks by less",
    )
    held_out_share: float = _setting(
        0.02,
        "share of the held-out error by which each parameter has to reduce it; a spline term counts as one, and so "
        "does an effect with a value for each recording [1]",
        "a smaller share is no use to anyone who predicts, and errors of a few dozen blocks scatter by more",
    )
    held_out_rival: float = _setting(
        0.05,
        "share of the held-out error within which two hypotheses are indistinguishable, and of the in-sample loss by "
        "which an exchange has to lower it where held-out errors leave it open [1]",
        "the standard error of a paired difference over a few dozen blocks",
    )
    validated_candidates: int = _setting(
        3,
        "candidates of a round that are cross-validated, best in sample first",
        "each costs a fit per group of blocks",
    )
    chance: float = _setting(
        0.1,
        "two-sided significance level of a reduction of the held-out error, divided among candidates [1]",
        "one in twenty for a reduction that chance makes (Bonferroni among candidates)",
    )
    max_rounds: int = _setting(6, "alternations of parameters and process noise", "three are usual")
    converged: float = _setting(
        0.05, "change of the deviance at which a fit has converged [1]", "a hundredth of any decision threshold"
    )
    starts_followed: int = _setting(
        2, "starting points that are fitted fully", "those of lowest deviance after a screening fit"
    )
    noise_floor_share: float = _setting(
        0.02,
        "lower bound of the root process noise over the input-noise floor [1]",
        "so small a process noise changes no innovation",
    )

    @classmethod
    def described(cls) -> list[tuple[str, Any, str, str]]:
        """Name, default, meaning and reason of every field."""
        return [(one.name, one.default, one.metadata["meaning"], one.metadata["reason"]) for one in fields(cls)]


DEFAULT = Settings()
