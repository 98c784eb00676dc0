"""Imperfections of the sizes that five measured rigs have, drawn at random.

The five (none of them is part of this package): a laboratory rig at 10 Hz, a student's rig with a ping-pong ball at
19 Hz (infrared sensors, 25 runs), one with a time-of-flight sensor at 50 Hz, a teaching rig with a resistive track at
100 Hz, and oscilloscope records of analogue sensors at 200 Hz (10 runs). How each size was measured:

- *Residuals*: positions minus K ∬α dt² with one K for a rig, and a parabola for each window of 0.5 s (10 and 19 Hz: 2.5
  and 1 s), robustly fitted. What the ball really does beyond s̈ = K (α + α₀) is in them too, so that their
  correlation and drift bound the sensor's from above.
- *Lag*: the delay by two equal first-order lags of α that makes the residuals of windows of 2 s (10 Hz: 5 s) smallest:
  0.00 s (teaching rig), 0.06, 0.12, 0.15 (weakly determined), 0.25 s. Which part of it is the servo's and which the
  sensor's cannot be told from these; two rigs record a command, and theirs are 0.12 and 0.25 s. The upper end of the
  sensor's is what the 0.06 s of a rig that records an encoder leave to it.
- *Noise*: robust standard deviation of second differences, 0.17, 0.9, 2.0, 3.7, 8 mm; the steps in the records are
  0.05 to 1.7 mm. Autocorrelation of the residuals at one step: −0.1 to 0.1 at 20 and 5 ms, 0.28 at 53 ms, 0.35 at
  0.1 s, 0.84 at 10 ms; e^(−Δt/τ) gives τ = 40 to 95 ms where there is any.
- *Spikes*: 2.9 % of the oscilloscope's residuals lie beyond four standard deviations to one side, 33 to 64 mm, and
  0.1 % to the other side. None of the others has outliers to one side only.
- *Repeats*: 25 % of the oscilloscope's positions repeat the one before, in runs of up to 13, where independent noise
  of its size rounded to its steps repeats 6 %; with the others rounding explains what there is. None of the five has
  blank positions: their share here is an assumption.
- *Worn track*: jumps of 3.5 to 9.5 mm (10 to 90 %) in 2.2 % of the readings of the resistive track.
- *Intervals*: standard deviation 6 and 17 % of their mean, the shortest 0.69, the longest 1.9 of it. Consecutive ones
  are uncorrelated (0.00, 0.05), where an error of the stamps alone would make it −0.5: the sampling is
  uneven. Errors of stamps and bunches are assumptions, of a serial line that is read when there is time.
- *Drift*: α₀ of a window of 2 s differs from that of the next by 0.9, 2.9, 3.4, 4.3, 8.8 mrad, of which the noise of
  the positions explains 0.2 to 1 mrad; dry friction and worn places are in the rest. 0.5 to 3 mrad are drawn.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields, replace
from typing import Any

import numpy as np

from analytic.naming import did_you_mean
from harness.errors import InputError
from harness.simulator.experiment import Experiment
from harness.simulator.imperfections import Imperfections, WornPlace

RATES = (10.0, 20.0, 50.0, 100.0, 200.0, 500.0)  # Hz
COARSE_NOISE = (0.8e-3, 8e-3)  # m; finer noise is that of an ordinary recording
SHARE = 0.5  # probability of each kind where none is asked for

Generator = np.random.Generator
Drawn = dict[str, Any]
_OF_RECORD = {one.name for one in fields(Imperfections)}


def _sensor_lag(generator: Generator) -> Drawn:
    return {"sensor_lag": float(generator.uniform(0.01, 0.06))}


def _dropouts(generator: Generator) -> Drawn:
    shares = {"repeated": float(generator.uniform(0.02, 0.20)), "missing": float(generator.uniform(0.0, 0.05))}
    return shares | {"dropout_length": float(generator.uniform(1.0, 4.0))}


def _spikes(generator: Generator) -> Drawn:
    return {
        "spiked": float(generator.uniform(0.005, 0.03)),
        "spike_low": 0.03,
        "spike_high": 0.065,
        "spike_side": int(generator.choice((-1, 1))),
    }


def _worn_track(generator: Generator) -> Drawn:
    starts = np.sort(generator.uniform(0.20, 0.44, int(generator.integers(2, 6)))).tolist()
    return {
        "worn": tuple(
            WornPlace(
                start=_short(start),
                end=_short(start + float(generator.uniform(0.003, 0.015))),
                step=_short(float(generator.uniform(0.0035, 0.0095) * generator.choice((-1.0, 1.0)))),
            )
            for start in starts
        )
    }


def _stamps(generator: Generator) -> Drawn:
    return {
        "uneven": float(generator.uniform(0.05, 0.17)),
        "stamp_error": float(generator.uniform(0.0, 0.1)),
        "bunch": int(generator.integers(1, 5)),
    }


def _coarse_noise(generator: Generator) -> Drawn:
    low, high = np.log(COARSE_NOISE)
    noise = float(np.exp(generator.uniform(low, high)))
    return {
        "position_noise": noise,
        "position_resolution": 1e-4 * max(1, round(noise / 4e-4)),  # a quarter of the noise, in tenths of a millimetre
        "noise_time": float(generator.uniform(0.005, 0.095)),
    }


def _zero_drift(generator: Generator) -> Drawn:
    return {"drift": float(generator.uniform(0.5e-3, 3e-3)), "drift_period": float(generator.uniform(15.0, 60.0))}


def _commanded_angle(generator: Generator) -> Drawn:
    return {
        "servo_lag": float(generator.uniform(0.05, 0.25)),
        "servo_damping": float(generator.uniform(0.6, 1.0)),
        "control_rate": float(generator.choice((20.0, 50.0, 100.0))),
    }


def _sampling(generator: Generator) -> Drawn:
    return {"rate": float(generator.choice(RATES))}


KINDS: Mapping[str, Callable[[Generator], Drawn]] = {
    "sensor_lag": _sensor_lag,
    "dropouts": _dropouts,
    "spikes": _spikes,
    "worn_track": _worn_track,
    "stamps": _stamps,
    "coarse_noise": _coarse_noise,
    "zero_drift": _zero_drift,
    "commanded_angle": _commanded_angle,
    "sampling": _sampling,
}
"""Each kind of imperfection draws attributes of `Imperfections`, or of the experiment that is recorded."""


def with_imperfections(experiment: Experiment, kinds: Sequence[str] = (), *, seed: int) -> Experiment:
    """The same experiment, recorded with imperfections.

    Args:
        experiment: what is recorded; imperfections that it has are replaced.
        kinds: of `KINDS`; without any, each with probability 1/2, and one at least.
        seed: of their sizes; a kind has the same whichever others there are.

    Raises:
        InputError: there is no such kind.
    """
    for name in kinds:
        if name not in KINDS:
            raise InputError(f"no imperfection {name!r}.{did_you_mean(name, KINDS)} There are: {', '.join(KINDS)}.")
    chosen = kinds or kinds_of(seed)
    drawn: Drawn = {}
    for number, (name, draw) in enumerate(KINDS.items()):
        if name in chosen:
            drawn |= draw(np.random.default_rng((seed, number)))
    drawn = {name: _short(value) if isinstance(value, float) else value for name, value in drawn.items()}
    of_record: Drawn = {name: value for name, value in drawn.items() if name in _OF_RECORD}
    of_experiment: Drawn = {name: value for name, value in drawn.items() if name not in _OF_RECORD}
    return replace(experiment, imperfections=Imperfections(**of_record), **of_experiment)


def kinds_of(seed: int) -> tuple[str, ...]:
    """The kinds that a rig with this seed has where none is asked for."""
    generator = np.random.default_rng((seed, len(KINDS)))
    drawn = tuple(name for name in KINDS if generator.uniform() < SHARE)
    return drawn or (str(generator.choice(list(KINDS))),)


def _short(value: float) -> float:
    return float(f"{value:.4g}")
