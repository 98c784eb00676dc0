"""Why an engine disagrees with the measurement: step size, contact model, or physics that no model here has.

The engine's error is split without remainder along a chain of runs from the same start, driven alike:

    engine − measured = (engine − engine at dt → 0) + (engine at dt → 0 − CAM) + (CAM − measured)
                           numerical                    contact model             physics

The limit dt → 0 is extrapolated from runs at dt and dt/2 after Richardson; both engines converge with order 1 (their
tests fit it), so the limit is twice the finer run less the coarser.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from analytic.motion import FloatArray
from harness.compare.setting import Setting
from harness.compare.sources import SourceRuns, run_engine
from harness.engines.protocol import Engine, EngineParameters


@dataclass(frozen=True)
class Attribution:
    """The parts of one engine's error over one free run; arrays of shape (n,), NaN outside the run [m].

    Attributes:
        source: the engine.
        time_step: its step [s].
        numerical, contact, physics: the parts; they add up to engine − measured.
        use: stamps at which the measurement counts, shape (n,).
    """

    source: str
    time_step: float
    numerical: FloatArray
    contact: FloatArray
    physics: FloatArray
    use: np.ndarray

    def rms(self) -> dict[str, float]:
        """RMS of each part and of their sum, `total` [m]."""
        parts = {"numerical": self.numerical, "contact": self.contact, "physics": self.physics}
        parts["total"] = self.numerical + self.contact + self.physics
        return {name: float(np.sqrt(np.mean(part[self.use] ** 2))) for name, part in parts.items()}

    def shares(self) -> dict[str, float]:
        """Share of each part in the mean square error; they add up to 1, and one is negative where it compensates."""
        total = (self.numerical + self.contact + self.physics)[self.use]
        square = float(np.mean(total**2))
        parts = {"numerical": self.numerical, "contact": self.contact, "physics": self.physics}
        return {name: float(np.mean(part[self.use] * total)) / square for name, part in parts.items()}


def attribute(
    setting: Setting, engine: Engine, parameters: EngineParameters, coarse: SourceRuns, cam: SourceRuns
) -> Attribution | None:
    """Split the error of an engine's free run `coarse`; `None` when it, or the run at half the step, failed."""
    half = parameters.model_copy(update={"time_step": 0.5 * parameters.time_step})
    fine = run_engine(setting, engine, half, coarse.horizon)
    if coarse.failures or fine.failures:
        return None
    limit = 2.0 * fine.position[0] - coarse.position[0]
    measured = setting.recording.position
    use = setting.ball.trusted & np.isfinite(coarse.position[0])
    return Attribution(
        engine.name,
        parameters.time_step,
        numerical=coarse.position[0] - limit,
        contact=limit - cam.position[0],
        physics=cam.position[0] - measured,
        use=use,
    )
