"""One model run and the measurement on common time stamps: the input of every metric."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analytic.motion import FloatArray
from harness.errors import InputError


def trapezoid_weights(time: FloatArray) -> FloatArray:
    """Weights w of the trapezoidal rule, ∫ f dt ≈ Σ w f, on unevenly spaced stamps.

    Args:
        time: strictly increasing, shape (n,) [s].

    Returns:
        shape (n,) [s]; their sum is time[-1] − time[0]. A single stamp has weight 0.
    """
    half = 0.5 * np.diff(time)
    weights = np.zeros(len(time))
    weights[:-1] += half
    weights[1:] += half
    return weights


@dataclass(frozen=True)
class RunComparison:
    """A model run and the measurement, on common time stamps.

    Metrics use *valid* stamps only: the measured position is finite and not excluded by `use`. A diverged model raises
    no error; its metrics are infinite or NaN, and satisfy no limit.

    Attributes:
        time: strictly increasing, possibly uneven, shape (n,) [s].
        measured: ball position, NaN if unknown, shape (n,) [m].
        model: the model's ball position, shape (n,) [m].
        measured_velocity: smoothed estimate of the ball's velocity, NaN if unknown, shape (n,) [m/s].
        model_velocity: the model's ball velocity, shape (n,) [m/s].
        use: False at outliers, shape (n,); None to use all stamps.
        uncertainty: u_val, the standard deviation of `model` − `measured` for a perfect model, shape (n,) [m]; None if
            unknown.
        start: measured start of the run, the zero of displacements [m]; None for the first valid position. Pass the
            estimated start if the sensor is noisy.

    Raises:
        ValueError: shapes differ, stamps are not increasing, or an uncertainty is not positive.
        InputError: there is no valid position.
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
                f"no ball position is known between t = {self.time[0]:g} s and {self.time[-1]:g} s to compare "
                "with; choose another horizon or leave this part out"
            )

    @property
    def valid(self) -> NDArray[np.bool_]:
        """Stamps with a valid measured position, shape (n,)."""
        known = np.isfinite(self.measured)
        return known if self.use is None else known & self.use

    @property
    def velocity_valid(self) -> NDArray[np.bool_]:
        """Valid stamps with a velocity estimate, shape (n,)."""
        if self.measured_velocity is None or self.model_velocity is None:
            return np.zeros(self.time.shape, dtype=np.bool_)
        return self.valid & np.isfinite(self.measured_velocity)

    @property
    def error(self) -> FloatArray:
        """e_s = s_model − s_measured at the valid stamps [m]; infinite if the model is not finite."""
        return _difference(self.model[self.valid], self.measured[self.valid])

    @property
    def velocity_error(self) -> FloatArray:
        """e_v = ṡ_model − ṡ_measured at valid stamps with a velocity [m/s]; infinite if the model is not finite."""
        if self.measured_velocity is None or self.model_velocity is None:
            return np.empty(0)
        where = self.velocity_valid
        return _difference(self.model_velocity[where], self.measured_velocity[where])

    @property
    def displacement(self) -> tuple[FloatArray, FloatArray]:
        """(measured, model) at the valid stamps, relative to the measured start [m]."""
        measured = self.measured[self.valid]
        start = float(measured[0]) if self.start is None else self.start
        return measured - start, self.model[self.valid] - start


def _difference(model: FloatArray, measured: FloatArray) -> FloatArray:
    return np.where(np.isfinite(model), model - measured, np.inf)
