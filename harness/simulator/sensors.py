"""The rig's two sensors: an incremental encoder on the beam's axis and a laser that looks along the beam."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from analytic.motion import FloatArray


@dataclass(frozen=True, kw_only=True)
class Encoder:
    """Counts of a turn, rounded to the nearest.

    Attributes:
        counts: per turn; the paper's encoder has 1024 P/R, 4096 counts in quadrature.
        noise: standard deviation of the angle before it is counted [rad].
    """

    counts: int = 4096
    noise: float = 0.0

    @property
    def resolution(self) -> float:
        """One count [rad]."""
        return 2.0 * math.pi / self.counts

    def measure(self, angle: FloatArray, generator: np.random.Generator) -> FloatArray:
        """What is read at beam angle α [rad], any shape; the same shape [rad]."""
        shaken = angle + self.noise * generator.standard_normal(np.shape(angle))
        # + 0.0 turns a counted −0 into 0
        return np.rint(shaken / self.resolution) * self.resolution + 0.0


@dataclass(frozen=True, kw_only=True)
class Laser:
    """A triangulating distance sensor at s = 0, so that the distance it reads is the ball's position.

    Defaults: Panasonic HG-C1400-P, the paper's sensor. Its data sheet gives a repeatability of 300 µm from 200 to
    400 mm and of 800 µm from 400 to 600 mm and does not say whether this is a spread or a standard deviation. It is
    taken for the standard deviation of independent Gaussian samples: the pessimistic reading.

    Attributes:
        near, far: ends of the measuring range [m]; nothing is read outside.
        change: distance at which the noise changes [m].
        noise_near, noise_far: standard deviation below and from `change` on [m].
        resolution: of the recorded value [m].
    """

    near: float = 0.2
    far: float = 0.6
    change: float = 0.4
    noise_near: float = 0.3e-3
    noise_far: float = 0.8e-3
    resolution: float = 0.1e-3

    def deviation(self, position: FloatArray) -> FloatArray:
        """Standard deviation of the noise at s [m], any shape; the same shape [m]."""
        return np.where(np.asarray(position) < self.change, self.noise_near, self.noise_far)

    def measure(self, position: FloatArray, generator: np.random.Generator) -> FloatArray:
        """What is read at position s [m], any shape; the same shape, NaN out of range [m]."""
        return self.read(position, generator.standard_normal(np.shape(position)))

    def read(self, position: FloatArray, normal: FloatArray) -> FloatArray:
        """The same with given noise of variance 1, of the shape of `position`."""
        noisy = position + self.deviation(position) * normal
        inside = (np.asarray(position) >= self.near) & (np.asarray(position) <= self.far)
        return np.where(inside, np.rint(noisy / self.resolution) * self.resolution, np.nan)
