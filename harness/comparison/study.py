"""The complete comparison of one recording, the input of report, tables and tolerance checks."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from analytic.models import CAM, MODELS, Reading
from analytic.motion import FloatArray
from harness.comparison.ablation import Combination, ablate, one_radius
from harness.comparison.attribution import Attribution, attribute
from harness.comparison.horizons import Horizon
from harness.comparison.paper import Claim, Difference, Inputs, claims, differences
from harness.comparison.setting import Setting
from harness.comparison.sources import SourceRuns, run_all
from harness.comparison.uncertainty import displacements, uncertainty
from harness.engines.health import Failure
from harness.engines.parameters import EngineParameters
from harness.engines.protocol import Engine
from harness.errors import EngineFailure
from harness.metrics import OwnMetric, RunComparison, Score, own_value, score
from harness.numerics import rms
from harness.progress import Progress, Stage, silent

# Shares of the whole time at which stages begin and end: of the bundled recording, on two cores.
_RUNS = (0.1, 0.4)
_SCORES = 0.5
_STEPS = (0.5, 0.75)


@dataclass(frozen=True)
class Study:
    """Runs, scores and explanations of all sources on one recording.

    Attributes:
        setting: input, rig, drive, start, horizons.
        engines: engines with their parameters.
        runs: every source on every horizon, models first; horizons in the order of `setting`.
        scores: one per entry of `runs`.
        u_val: at the stamps of each horizon of `setting`, shape (k,) [m].
        headline: the longest informative horizon; see `headline_of`.
        attributions: one per engine whose free run succeeded.
        combinations, differences, claims: ablation and the paper's claims, on the headline horizon.
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

    @property
    def engine_failures(self) -> tuple[EngineFailure, ...]:
        """Those of which an engine is to blame; where the ball lifts off, `lift_offs` says so of all sources."""
        return tuple(failure for failure in self.failures if not failure.of_the_rig)

    @property
    def lift_offs(self) -> Mapping[str, str]:
        """By source when and why the ball lifts off the beam for the first time; empty if it does not."""
        first: dict[str, float] = {}
        for run in self.runs:
            for time in run.lifted_off:
                first[run.source] = min(time, first.get(run.source, math.inf))
        return {source: f"t = {time:.3f} s: {Failure.LIFTED_OFF.value}" for source, time in first.items()}

    @property
    def sources_by_lift_off(self) -> Mapping[str, tuple[str, ...]]:
        """What `lift_offs` says, with the sources that say it."""
        said = self.lift_offs
        return {text: tuple(one for one in said if said[one] == text) for text in said.values()}

    def run_of(self, source: str, horizon: Horizon) -> SourceRuns:
        """The runs of one source on one horizon."""
        return next(r for r in self.runs if r.source == source and r.horizon.name == horizon.name)

    def score_of(self, source: str, horizon: Horizon) -> Score:
        """The score of one source on one horizon."""
        return next(s for s in self.scores if s.source == source and s.horizon == horizon.name)

    def u_val_of(self, horizon: Horizon) -> FloatArray:
        """u_val at the stamps of one horizon, shape (k,) [m]."""
        names = [one.name for one in self.setting.horizons]
        return self.u_val[names.index(horizon.name)]

    def own_metrics(self, metrics: Mapping[str, OwnMetric]) -> dict[str, tuple[float, ...]]:
        """Values of metrics of the user's own by name, one for each entry of `scores`.

        Raises:
            InputError: one of them fails, or gives what is not a number.
        """
        windows = [compared_windows(self.setting, run, self.u_val_of(run.horizon)) for run in self.runs]
        return {
            name: tuple(
                own_value(name, function, each, f"{run.source}, horizon {run.horizon.name}")
                for run, each in zip(self.runs, windows, strict=True)
            )
            for name, function in metrics.items()
        }

    def floor(self, horizon: Horizon) -> float:
        """RMS of u_val on one horizon [m]: the expected error of a perfect model."""
        return float(np.sqrt(np.mean(self.u_val_of(horizon) ** 2)))


def study(
    setting: Setting,
    engines: Sequence[tuple[Engine, EngineParameters]],
    progress: Progress = silent,
) -> Study:
    """Runs and scores all sources; engine failures are part of the result and not raised."""
    every = len(setting.horizons) * (len(engines) + 1)
    runs = run_all(setting, list(MODELS.values()), engines, Stage(progress, *_RUNS, every))
    progress("uncertainty of start and angle", share=_RUNS[1])
    displaced = displacements(setting)
    u_val = [uncertainty(setting, one) for one in displaced]
    headline = headline_of(setting, u_val)
    u_val_by_horizon = {h.name: u for h, u in zip(setting.horizons, u_val, strict=True)}
    inputs = Inputs(u_val_by_horizon[headline.name], displaced[setting.horizons.index(headline)])
    progress("scores", share=_SCORES)
    scores = [
        score(
            run.source,
            compared_windows(setting, run, u_val_by_horizon[run.horizon.name]),
            horizon=run.horizon.name,
            tolerance=setting.choices.tolerance,
        )
        for run in runs
    ]
    whole = setting.horizons[0]
    by_name = {run.source: run for run in runs if run.horizon is whole}
    attributions = []
    for number, (engine, parameters) in enumerate(engines):
        done = number / len(engines)
        progress(f"{engine.name}, other steps", share=_STEPS[0] + done * (_STEPS[1] - _STEPS[0]))
        one = attribute(setting, engine, parameters, by_name[engine.name], by_name[CAM.name])
        if one is not None:
            attributions.append(one)
    progress("ablation", share=_STEPS[1])
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
        differences=tuple(differences(combinations, once=one_radius(setting.rig))),
        claims=tuple(claims(setting, headline, combinations, inputs)),
    )


def headline_of(setting: Setting, u_val: Sequence[FloatArray]) -> Horizon:
    """The longest horizon at whose end u_val (RMS) is below the standard deviation of the ball's position.

    On longer horizons the uncertainty of angle and start exceeds the ball's own motion, so that a run carries no
    information about a model. If no horizon passes, the shortest is returned.
    """
    position = setting.ball.position
    longest_first = sorted(zip(setting.horizons, u_val, strict=True), key=lambda each: -(each[0].seconds or math.inf))
    for horizon, u in longest_first:
        ends = np.array([piece[-1] for piece in horizon.pieces(u)])
        motion = np.array([np.std(position[where]) for where in horizon.slices()])
        if rms(ends) < rms(motion):
            return horizon
    return longest_first[-1][0]


def compared_windows(setting: Setting, run: SourceRuns, u_val: FloatArray) -> list[RunComparison]:
    """The runs of a source on a horizon beside the measurement, each window from its own start."""
    ball, horizon = setting.ball, run.horizon
    pieces = zip(*map(horizon.pieces, (run.position, run.velocity, u_val)), strict=True)
    return [
        RunComparison(
            time=setting.time[where],
            measured=setting.recording.position[where],
            model=position,
            measured_velocity=ball.velocity[where],
            model_velocity=velocity,
            use=ball.trusted[where],
            uncertainty=uncertainty,
            start=float(ball.position[where][0]),
        )
        for where, (position, velocity, uncertainty) in zip(horizon.slices(), pieces, strict=True)
    ]
