"""Random beam motions whose derivatives are known in closed form, and the exact solution on them."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

from analytic.kernel import simulate
from analytic.law import acceleration
from analytic.lift_off import normal_acceleration
from analytic.models import CAM, coefficients
from analytic.motion import FloatArray, State, Trajectory, beam_states
from analytic.rig import Rig

DURATION = 10.0  # [s]
FARTHEST = 2.4  # from the pivot that a ball may get; it gets a tenth of that at least [m]
RTOL = 1e-12
_FAINT = 0.5  # least normal force, over the ball's weight: real rigs are moved more gently
_GRIP = 0.1  # most friction that rolling may need, over the normal force; the engines have 0.5
_LONGEST_STEP = 0.05  # of the reference solution [s]: none of the motions is shorter


@dataclass(frozen=True)
class RampedSines:
    """Σ a sin(ω t + p), which a smooth ramp from 0 to 1 in the first seconds lets in.

    Attributes:
        terms: a [rad], ω [rad/s], p [rad].
        ramp: duration of the ramp [s].
    """

    terms: tuple[tuple[float, float, float], ...]
    ramp: float

    def evaluate(self, time: FloatArray) -> FloatArray:
        """α [rad]."""
        return self._sum(time, 0) * self._ramp(time)[0]

    def derivative(self, time: FloatArray, order: int = 1) -> FloatArray:
        """α̇ [rad/s] or α̈ [rad/s²]."""
        value, slope, bend = self._ramp(time)
        if order == 1:
            return self._sum(time, 1) * value + self._sum(time, 0) * slope
        return self._sum(time, 2) * value + 2.0 * self._sum(time, 1) * slope + self._sum(time, 0) * bend

    def _sum(self, time: FloatArray, order: int) -> FloatArray:
        total = np.zeros_like(time)
        for size, omega, phase in self.terms:
            total = total + size * omega**order * np.sin(omega * time + phase + 0.5 * math.pi * order)
        return total

    def _ramp(self, time: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """10 x³ − 15 x⁴ + 6 x⁵ and its first two derivatives by time, 1 after the ramp."""
        x = np.clip(time / self.ramp, 0.0, 1.0)
        slope = 30.0 * x**2 * (1.0 - x) ** 2 / self.ramp
        bend = 60.0 * x * (1.0 - x) * (1.0 - 2.0 * x) / self.ramp**2
        return x**3 * (10.0 - 15.0 * x + 6.0 * x**2), slope, bend


@dataclass(frozen=True)
class Drawn:
    """A motion with a start, and the exact path of the ball at `time`, shape (n,) [m]."""

    number: int
    motion: RampedSines
    start: State
    time: FloatArray
    position: FloatArray


def drawn(number: int, rig: Rig, seed: int = 0) -> Drawn:
    """A motion on which a rolling ball stays on the beam: one to three sines of up to 5° in all, 0.1 to 1.5 Hz each.

    A ramp of 0.2 to 3 s lets them in; the ball starts within 0.5 m of the pivot at up to 0.2 m/s. Motions on which it
    would get farther than 2.4 m, or hardly move, lift off, or need much friction, are drawn again. What is drawn
    depends on the number and the seed alone.
    """
    generator = np.random.default_rng((seed, number))
    while True:
        found = _tried(generator, number, rig)
        if found is not None:
            return found


def _tried(generator: np.random.Generator, number: int, rig: Rig) -> Drawn | None:
    many = int(generator.integers(1, 4))
    shares = generator.dirichlet(np.ones(many)) * math.radians(float(generator.uniform(0.5, 5.0)))
    omegas = 2.0 * math.pi * np.exp(generator.uniform(math.log(0.1), math.log(1.5), many))
    phases = generator.uniform(-math.pi, math.pi, many)
    terms = tuple((float(a), float(w), float(p)) for a, w, p in zip(shares, omegas, phases, strict=True))
    motion = RampedSines(terms, float(generator.uniform(0.2, 3.0)))
    start = State(float(generator.uniform(-0.5, 0.5)), float(generator.uniform(-0.2, 0.2)))
    time = np.arange(round(DURATION * 100) + 1) / 100.0
    (path,) = simulate([CAM], rig, motion, start, time)  # fast, and exact to some nanometres
    farthest = float(np.max(np.abs(path.position)))
    if not 0.1 * FARTHEST <= farthest <= FARTHEST or not _rolls(path, motion, rig):
        return None
    return Drawn(number, motion, start, time, exact(rig, motion, start, time))


def _rolls(path: Trajectory, motion: RampedSines, rig: Rig) -> bool:
    beam = beam_states(motion, path.time)
    pressed = normal_acceleration(path.position, path.velocity, beam, rig)
    # The friction that turns the ball: J φ̈/r, φ̈ = s̈/r + α̈, over the mass.
    forward = np.gradient(path.velocity, path.time)
    inertia = rig.inertia / (rig.mass * rig.rolling_radius)
    needed = np.abs(inertia * (forward / rig.rolling_radius + beam[:, 2]))
    return bool(pressed.min() > _FAINT * rig.gravity and np.all(needed < _GRIP * pressed))


def exact(rig: Rig, motion: RampedSines, start: State, time: FloatArray) -> FloatArray:
    """s of CAM (eq. 14) at `time`, shape (n,) [m], at a tolerance of 1e-12 by DOP853 (Hairer, Nørsett, Wanner 1993).

    Raises:
        RuntimeError: the solver failed; with its own message.
    """
    p = coefficients(CAM, rig)

    def slope(t: float, y: FloatArray) -> tuple[float, float]:
        angle, rate, angular = beam_states(motion, np.array([t]))[0]
        return y[1], acceleration(y[0], y[1], angle, rate, angular, p)

    solution = solve_ivp(
        slope, (float(time[0]), float(time[-1])), (start.position, start.velocity), method="DOP853", t_eval=time,
        rtol=RTOL, atol=RTOL, max_step=_LONGEST_STEP,
    )  # fmt: skip
    if not solution.success:
        raise RuntimeError(f"reference solution: {solution.message}")
    return np.asarray(solution.y[0], dtype=np.float64)
