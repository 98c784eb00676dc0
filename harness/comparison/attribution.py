"""Why an engine disagrees with the measurement: step size, contact model, or physics that no model here has.

The engine's error is split without remainder along a chain of runs from the same start, driven alike:

    engine − measured = (engine − engine at dt → 0) + (engine at dt → 0 − CAM) + (CAM − measured)
                           numerical                    contact model             physics

The limit dt → 0 is extrapolated from runs at 2 dt, dt and dt/2 after Richardson (Roache, "Quantification of
uncertainty in computational fluid dynamics", Annu. Rev. Fluid Mech. 29, 1997), with the order of convergence that these
three show: it depends on the engine and on its contact settings.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analytic.motion import FloatArray
from harness.comparison.setting import Setting
from harness.comparison.sources import SourceRuns, run_engine
from harness.engines.protocol import Engine, EngineParameters

_LOWEST, _HIGHEST = 1.0, 3.0  # the least that a driven run promises; what a mixture of orders 1 and 2 may look like


@dataclass(frozen=True)
class Attribution:
    """The parts of one engine's error over one free run; arrays of shape (n,), NaN outside the run [m].

    Attributes:
        source: the engine.
        time_step: its step [s].
        numerical, contact, physics: the parts; they add up to engine − measured.
        use: stamps at which the measurement counts, shape (n,).
        order: of the convergence that the three runs show.
    """

    source: str
    time_step: float
    numerical: FloatArray
    contact: FloatArray
    physics: FloatArray
    use: NDArray[np.bool_]
    order: float

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
    setting: Setting, engine: Engine, parameters: EngineParameters, own: SourceRuns, cam: SourceRuns
) -> Attribution | None:
    """Split the error of an engine's free run `own`; `None` when it, or a run at another step, failed."""
    at = {1.0: own}
    for factor in (2.0, 0.5):
        other = parameters.model_copy(update={"time_step": factor * parameters.time_step})
        at[factor] = run_engine(setting, engine, other, own.horizon)
    if any(runs.failures for runs in at.values()):
        return None
    coarse, middle, fine = (at[factor].position[0] for factor in (2.0, 1.0, 0.5))
    measured = setting.recording.position
    use = setting.ball.trusted & np.isfinite(middle)
    order = _order(coarse[use] - middle[use], middle[use] - fine[use])
    limit = fine + (fine - middle) / (2.0**order - 1.0)
    return Attribution(
        engine.name,
        parameters.time_step,
        numerical=middle - limit,
        contact=limit - cam.position[0],
        physics=cam.position[0] - measured,
        use=use,
        order=order,
    )


def _order(coarse: FloatArray, fine: FloatArray) -> float:
    """p of differences that shrink by 2^p when the step is halved, within what these integrators can have."""
    before, after = np.sqrt(np.mean(coarse**2)), np.sqrt(np.mean(fine**2))
    if after == 0.0:
        return _HIGHEST
    return float(np.clip(np.log2(before / after), _LOWEST, _HIGHEST))
