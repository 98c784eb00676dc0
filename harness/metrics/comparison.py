"""One model run beside the measurement of it: what every metric starts from."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analytic.motion import FloatArray
from harness.errors import InputError


def trapezoid_weights(time: FloatArray) -> FloatArray:
    """Weights w of the trapezoidal rule, ∫ f dt ≈ Σ w f, on uneven stamps.

    Args:
        time: strictly increasing, shape (n,) [s].

    Returns:
        shape (n,) [s]; they add up to time[-1] − time[0]. A single stamp weighs 0.
    """
    half = 0.5 * np.diff(time)
    weights = np.zeros(len(time))
    weights[:-1] += half
    weights[1:] += half
    return weights


@dataclass(frozen=True)
class Comparison:
    """A model's run and what was measured meanwhile, on common stamps.

    Only *valid* stamps enter a metric: the measured position is known (finite) there and `use` does not exclude it. A
    model that ran away to infinity is no error here: its metrics are infinite or NaN, and meet no limit.

    Attributes:
        time: strictly increasing, uneven is fine, shape (n,) [s].
        measured: ball position, NaN where it is not known, shape (n,) [m].
        model: the model's ball position, shape (n,) [m].
        measured_velocity: a smoothed estimate of the ball's velocity, NaN where there is none, shape (n,) [m/s].
        model_velocity: the model's ball velocity, shape (n,) [m/s].
        use: False at outliers, shape (n,); None for all.
        uncertainty: u_val, one standard deviation of `model` − `measured` to be expected of a perfect model,
            shape (n,) [m]; None if it is not known.
        start: the measured start of the run, from which displacements are counted [m]; None for the first valid
            position. Where the sensor is noisy, give the estimated start.

    Raises:
        ValueError: shapes differ, stamps do not increase, or an uncertainty is not positive.
        InputError: no valid position.
    """

    time: FloatArray
    measured: FloatArray
    model: FloatArray
    measured_velocity: FloatArray | None = None
    model_velocity: FloatArray | None = None
    use: NDArray[np.bool_] | None = None
    uncertainty: FloatArray | None = None
    start: float | None = None

    def __post_init__(self) -> None:
        for name in ("measured", "model", "measured_velocity", "model_velocity", "use", "uncertainty"):
            array = getattr(self, name)
            if array is not None and array.shape != self.time.shape:
                raise ValueError(f"{name} has shape {array.shape}, time has {self.time.shape}")
        if self.time.ndim != 1 or not np.all(np.diff(self.time) > 0.0):
            raise ValueError("time must be one-dimensional and strictly increasing")
        if self.uncertainty is not None and not np.all(self.uncertainty > 0.0):
            raise ValueError("uncertainty must be positive at every stamp")
        if not self.valid.any():
            raise InputError(
                f"no ball position is known between t = {self.time[0]:g} s and {self.time[-1]:g} s, so there is "
                "nothing to compare with; choose another horizon or leave this stretch out"
            )

    @property
    def valid(self) -> NDArray[np.bool_]:
        """Where the measured position counts, shape (n,)."""
        known = np.isfinite(self.measured)
        return known if self.use is None else known & self.use

    @property
    def velocity_valid(self) -> NDArray[np.bool_]:
        """Where the measured velocity counts: at valid stamps at which there is an estimate, shape (n,)."""
        if self.measured_velocity is None or self.model_velocity is None:
            return np.zeros(self.time.shape, dtype=np.bool_)
        return self.valid & np.isfinite(self.measured_velocity)

    @property
    def error(self) -> FloatArray:
        """e_s = s_model − s_measured at the valid stamps [m]; infinite where the model is not finite."""
        return _difference(self.model[self.valid], self.measured[self.valid])

    @property
    def velocity_error(self) -> FloatArray:
        """e_v = ṡ_model − ṡ_measured where the velocity counts [m/s]; infinite where the model is not finite."""
        if self.measured_velocity is None or self.model_velocity is None:
            return np.empty(0)
        where = self.velocity_valid
        return _difference(self.model_velocity[where], self.measured_velocity[where])

    @property
    def displacement(self) -> tuple[FloatArray, FloatArray]:
        """(measured, model) at the valid stamps, both counted from the measured start [m]."""
        measured = self.measured[self.valid]
        start = float(measured[0]) if self.start is None else self.start
        return measured - start, self.model[self.valid] - start


def _difference(model: FloatArray, measured: FloatArray) -> FloatArray:
    return np.where(np.isfinite(model), model - measured, np.inf)
