"""The whole comparison of one recording: what the report, the tables and the checks are made from."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from analytic.models import CAM, MODELS, Reading
from analytic.motion import FloatArray
from harness.comparison.ablation import Combination, ablate
from harness.comparison.attribution import Attribution, attribute
from harness.comparison.horizons import Horizon
from harness.comparison.paper import Claim, Difference, Inputs, claims, differences
from harness.comparison.setting import Setting
from harness.comparison.sources import Progress, SourceRuns, run_all
from harness.comparison.uncertainty import displacements, uncertainty
from harness.engines.protocol import Engine, EngineParameters
from harness.errors import EngineFailure
from harness.metrics import Comparison, Score, score


@dataclass(frozen=True)
class Study:
    """What one recording says of every source.

    Attributes:
        setting: input, rig, drive, start, horizons.
        engines: the engines and the parameters they ran with.
        runs: every source on every horizon, models first; order of horizons as in `setting`.
        scores: one per entry of `runs`.
        u_val: of every horizon of `setting`, shape (runs, n) [m].
        headline: the longest horizon on which a run still means something; see `headline_of`.
        attributions: one per engine whose free run succeeded.
        combinations, differences, claims: the paper's page, on the headline's runs.
    """

    setting: Setting
    engines: tuple[tuple[Engine, EngineParameters], ...]
    runs: tuple[SourceRuns, ...]
    scores: tuple[Score, ...]
    u_val: tuple[FloatArray, ...]
    headline: Horizon
    attributions: tuple[Attribution, ...]
    combinations: Mapping[tuple[str, bool, bool, Reading], Combination]
    differences: tuple[Difference, ...]
    claims: tuple[Claim, ...]

    @property
    def sources(self) -> tuple[str, ...]:
        """Names of all sources, in the order they ran."""
        return tuple(dict.fromkeys(run.source for run in self.runs))

    @property
    def failures(self) -> tuple[EngineFailure, ...]:
        """Every engine run that failed."""
        return tuple(failure for run in self.runs for failure in run.failures)

    def run_of(self, source: str, horizon: Horizon) -> SourceRuns:
        """The runs of one source on one horizon."""
        return next(r for r in self.runs if r.source == source and r.horizon.name == horizon.name)

    def score_of(self, source: str, horizon: Horizon) -> Score:
        """The score of one source on one horizon."""
        return next(s for s in self.scores if s.source == source and s.horizon == horizon.name)

    def u_val_of(self, horizon: Horizon) -> FloatArray:
        """u_val on one horizon, shape (runs, n), NaN outside a run [m]."""
        names = [one.name for one in self.setting.horizons]
        return self.u_val[names.index(horizon.name)]


def study(
    setting: Setting,
    engines: Sequence[tuple[Engine, EngineParameters]],
    progress: Progress = lambda _: None,
) -> Study:
    """Run, score and explain everything. Engine failures are kept in the result, not raised."""
    runs = run_all(setting, list(MODELS.values()), engines, progress)
    progress("uncertainty of start and angle")
    moved = displacements(setting)
    u_val = [uncertainty(setting, one) for one in moved]
    headline = headline_of(setting, u_val)
    spread = {h.name: u for h, u in zip(setting.horizons, u_val, strict=True)}
    inputs = Inputs(spread[headline.name], moved[setting.horizons.index(headline)])
    progress("scores")
    scores = [_score(setting, run, spread[run.horizon.name]) for run in runs]
    whole = setting.horizons[0]
    by_name = {run.source: run for run in runs if run.horizon is whole}
    attributions = []
    for engine, parameters in engines:
        progress(f"{engine.name}, other steps")
        one = attribute(setting, engine, parameters, by_name[engine.name], by_name[CAM.name])
        if one is not None:
            attributions.append(one)
    progress("ablation")
    combinations = ablate(setting, headline)
    return Study(
        setting=setting,
        engines=tuple(engines),
        runs=tuple(runs),
        scores=tuple(scores),
        u_val=tuple(u_val),
        headline=headline,
        attributions=tuple(attributions),
        combinations=combinations,
        differences=tuple(differences(combinations)),
        claims=tuple(claims(setting, headline, combinations, inputs)),
    )


def headline_of(setting: Setting, u_val: Sequence[FloatArray]) -> Horizon:
    """The longest horizon at whose ends a perfect model would still be told from a ball that does not move.

    Where angle and start alone leave the position at the end of a run more uncertain than the ball's own motion in it,
    the run says nothing about a model; if no horizon passes, the shortest stands.
    """
    position = setting.ball.position
    for horizon, u in zip(
        (setting.horizons[0], *reversed(setting.horizons[1:])), (u_val[0], *reversed(u_val[1:])), strict=True
    ):
        ends = np.array([u[i, last] for i, last in enumerate(horizon.last)])
        motion = np.array([np.std(position[where]) for where in horizon.slices()])
        if np.sqrt(np.mean(ends**2)) < np.sqrt(np.mean(motion**2)):
            return horizon
    return setting.horizons[-1] if len(setting.horizons) == 1 else setting.horizons[1]


def _score(setting: Setting, run: SourceRuns, u_val: FloatArray) -> Score:
    ball, measured = setting.ball, setting.recording.position
    windows = [
        Comparison(
            time=setting.time[where],
            measured=measured[where],
            model=run.position[i, where],
            measured_velocity=ball.velocity[where],
            model_velocity=run.velocity[i, where],
            use=ball.trusted[where],
            uncertainty=u_val[i, where],
            start=float(ball.position[where][0]),
        )
        for i, where in enumerate(run.horizon.slices())
    ]
    return score(run.source, windows, horizon=run.horizon.name, tolerance=setting.choices.tolerance)
