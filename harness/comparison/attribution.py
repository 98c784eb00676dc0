"""Attribution of an engine's error to step size, contact model and physics that all models lack.

The error is the exact sum of three differences between runs from the same start with the same drive:

    engine − measured = (engine − engine at dt → 0) + (engine at dt → 0 − CAM) + (CAM − measured)
                           numerical                    contact model             physics

The limit dt → 0 is extrapolated from runs at 2 dt, dt and dt/2 after Richardson (Roache, "Quantification of
uncertainty in computational fluid dynamics", Annu. Rev. Fluid Mech. 29, 1997), with the observed order of convergence,
which depends on the engine and its contact settings.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analytic.motion import FloatArray
from harness.comparison.setting import Setting
from harness.comparison.sources import SourceRuns, run_engine
from harness.engines.parameters import EngineParameters
from harness.engines.protocol import Engine
from harness.numerics import rms

_MIN_ORDER, _MAX_ORDER = 1.0, 3.0  # first order is guaranteed; cancelling terms of order 1 and 2 may look like 3


@dataclass(frozen=True)
class Attribution:
    """The parts of one engine's error in one free run; arrays at the stamps of the run, shape (k,) [m].

    Attributes:
        source: name of the engine.
        time_step: of the engine [s].
        numerical, contact, physics: the parts; their sum is engine − measured.
        use: stamps with a valid measurement, shape (k,).
        order: observed order of convergence.
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
        return {name: rms(part[self.use]) for name, part in parts.items()}

    def shares(self) -> dict[str, float]:
        """Share of each part in the mean square error; the sum is 1, and a part that compensates others is negative."""
        total = (self.numerical + self.contact + self.physics)[self.use]
        square = float(np.mean(total**2))
        parts = {"numerical": self.numerical, "contact": self.contact, "physics": self.physics}
        return {name: float(np.mean(part[self.use] * total)) / square for name, part in parts.items()}


def attribute(
    setting: Setting, engine: Engine, parameters: EngineParameters, own: SourceRuns, cam: SourceRuns
) -> Attribution | None:
    """Attribution of the error of an engine's free run `own`; `None` if it, or a run at another step, failed."""
    at = {1.0: own}
    for factor in (2.0, 0.5):
        other = parameters.model_copy(update={"time_step": factor * parameters.time_step})
        at[factor] = run_engine(setting, engine, other, own.horizon)
    if any(runs.failures for runs in at.values()):
        return None
    coarse, middle, fine = (at[factor].position for factor in (2.0, 1.0, 0.5))
    measured = setting.recording.position[own.horizon.stamps]
    use = setting.ball.trusted[own.horizon.stamps] & np.isfinite(middle)
    order = _order(coarse[use] - middle[use], middle[use] - fine[use])
    limit = fine + (fine - middle) / (2.0**order - 1.0)
    return Attribution(
        engine.name,
        parameters.time_step,
        numerical=middle - limit,
        contact=limit - cam.position,
        physics=cam.position - measured,
        use=use,
        order=order,
    )


def _order(coarse: FloatArray, fine: FloatArray) -> float:
    """Observed order p: differences shrink by 2^p when the step is halved; clipped to the possible range."""
    before, after = rms(coarse), rms(fine)
    if after == 0.0:
        return _MAX_ORDER
    return float(np.clip(np.log2(before / after), _MIN_ORDER, _MAX_ORDER))
