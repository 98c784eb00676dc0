"""The data common to all sections of the comparison report."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from analytic.motion import FloatArray
from harness.comparison.horizons import Horizon
from harness.comparison.study import Study
from harness.formatting import brief
from harness.report.answer import horizon_text
from harness.report.standing import Standing, standings
from harness.tolerances import Checked


@dataclass(frozen=True)
class Subject:
    """A study with the data of its report.

    Attributes:
        study: the comparison.
        manifest: as written to manifest.json.
        checks: of tolerances.
        command: to repeat the run.
    """

    study: Study
    manifest: Mapping[str, object]
    checks: tuple[Checked, ...]
    command: str

    @property
    def simulated(self) -> bool:
        """Whether the recording is simulated, not measured."""
        return self.study.setting.case.simulated

    @property
    def measured(self) -> str:
        """Adjective for the recording: `measured` or `simulated`."""
        return "simulated" if self.simulated else "measured"

    @cached_property
    def ranked(self) -> list[Standing]:
        """Sources on the headline horizon, the closest first."""
        return standings(self.study, self.study.headline)

    @property
    def whole(self) -> Horizon:
        """The free run over the whole recording."""
        return self.study.setting.horizons[0]

    @property
    def duration(self) -> float:
        """Of the free run [s]."""
        time = self.study.setting.time
        return float(time[-1] - time[self.whole.first[0]])

    @property
    def subtitle(self) -> str:
        """Recording, length, samples, origin."""
        setting = self.study.setting
        rate = 1.0 / float(np.median(np.diff(setting.time)))
        parts = [
            f"{brief(self.duration)} s, {len(setting.time)} samples at {brief(rate)} Hz",
            f"{int(setting.recording.known.sum())} positions known",
        ]
        if setting.case.origin:
            parts.append(f"origin: {setting.case.origin}")
        return "; ".join(parts)

    @cached_property
    def drawn(self) -> NDArray[np.bool_]:
        """Stamps drawn in lines of the recording, shape (n,): all but outliers; unknown positions are gaps."""
        return self.study.setting.ball.trusted | ~self.study.setting.recording.known

    def over(self, horizon: Horizon) -> str:
        """`over windows of 5 s`, `over the whole 16 s`."""
        return horizon_text(horizon.seconds, self.duration)

    def error(self, source: str, horizon: Horizon) -> FloatArray:
        """e_s at the stamps of a horizon, shape (k,), NaN at invalid ones [m]."""
        setting, stamps = self.study.setting, horizon.stamps
        error = self.study.run_of(source, horizon).position - setting.recording.position[stamps]
        return np.where(setting.ball.trusted[stamps], error, np.nan)
