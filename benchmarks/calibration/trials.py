"""The plan: which trials there are, each fixed by its name alone, so that any part can be run by itself."""

from __future__ import annotations

import hashlib
import json
import zlib
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, replace

import numpy as np

from analytic.effects import CATALOGUE, LEVEL_ERROR, ROLLING_RESISTANCE
from benchmarks.calibration.imperfect import IMPERFECTIONS, names_for
from benchmarks.calibration.sizes import PAIRS, POWER, POWER_ERRORS, SCALES, SIZES, UNLISTED_SCALES
from harness.errors import InputError
from harness.identify.problem.settings import DEFAULT, Settings

Values = dict[str, dict[str, float]]

STUDIES = ("null", "confusion", "power", "imperfect")
NULL_TRIALS, SEEDS = 200, 5  # of the committed tables
FINE, PAPER = 40_000, 4_096  # counts per turn
RIG = "virtual_rig"
# The engines' scenes take two places of five, each with either encoder in turn.
PLANTS = (RIG, RIG, RIG, "mujoco", "pybullet")
# Selection by cross-validation needs twelve windows of 2 s known and 3 s predicted: four in each recording of 16 s. It
# decides where nothing of the catalogue explains the data, hence every fourth trial without a hidden effect has three.
RECORDINGS, MORE_RECORDINGS, _EVERY = 2, 3, 4

_SEED = 20290417  # another number plans other trials
_SPIKED, _SPIKES = 0.2, 0.005  # share of trials that have spikes, and of their readings
_NOISE = (0.2e-3, 0.6e-3)  # of the position [m]
# What the owner of a rig may have declared, with its probability and range; the sign of a level error is drawn.
_ROLLING, _LEVEL = (0.6, 0.001, 0.004), (0.25, 0.001, 0.005)


@dataclass(frozen=True, kw_only=True)
class Trial:
    """One blind trial.

    Attributes:
        study: `null`, `confusion`, `power` or `imperfect`.
        name: of what is hidden; `none`, or names joined by " + ".
        factor: its size over the middle one; 0 where nothing is hidden [1].
        errors: its size in standard errors, to which `hidden` is scaled when the trial is posed; 0 where `hidden` is
            what acts [1].
        number: counts trials that are alike but for what is drawn.
        plant: `virtual_rig`, or the engine whose scene moves the ball.
        counts: of the encoder per turn.
        noise: standard deviation of a position reading [m].
        spikes: share of readings that are spoilt [1].
        hidden, unlisted, declared: what acts (SI).
        seed: of moves and noise.
        recordings: how many there are.
        imperfection: kind of what is wrong with the record, or `several`; empty where nothing is.
        setting, scale: a setting of the search, and the factor by which it is changed [1]; empty and 1 where none is.
    """

    study: str
    name: str
    factor: float
    number: int
    plant: str
    counts: int
    noise: float
    spikes: float
    hidden: Values
    unlisted: Values
    declared: Values
    seed: int
    recordings: int = RECORDINGS
    errors: float = 0.0
    imperfection: str = ""
    setting: str = ""
    scale: float = 1.0

    @property
    def settings(self) -> Settings:
        """Of the search; a whole number stays whole, and at least one."""
        if not self.setting:
            return DEFAULT
        default = getattr(DEFAULT, self.setting)
        value = default * self.scale
        return replace(DEFAULT, **{self.setting: max(1, round(value)) if isinstance(default, int) else value})

    @property
    def size(self) -> str:
        """Name of its size, or its factor, or standard errors."""
        if self.errors:
            return f"{self.errors:g} standard errors"
        return next((name for name, factor in SIZES.items() if factor == self.factor), f"{self.factor:g}")

    @property
    def encoder(self) -> str:
        """`fine` or `paper`."""
        return "paper" if self.counts == PAPER else "fine"

    @property
    def spec(self) -> str:
        """Sixteen hexadecimal digits that change with anything in the trial."""
        return hashlib.sha256(json.dumps(asdict(self), sort_keys=True).encode()).hexdigest()[:16]


def plan(
    studies: Sequence[str] = STUDIES, *, count: int = NULL_TRIALS, seeds: int = SEEDS, only: Sequence[str] = ()
) -> tuple[Trial, ...]:
    """The trials of these studies.

    Args:
        count: of effect-free trials.
        seeds: trials of each effect and size.
        only: names of what is hidden, to leave out all else; single effects, unlisted ones, or pairs "a + b".

    Raises:
        InputError: a name that no study has.
    """
    made: list[Trial] = []
    if "null" in studies:
        made += _null(count)
    if "confusion" in studies:
        made += _confusion(seeds)
    if "power" in studies:
        made += _power(seeds)
    if "imperfect" in studies:
        made += _imperfect(seeds)
    unknown = set(only) - {trial.name for trial in made}
    if unknown:
        raise InputError(
            f"no trial hides {sorted(unknown)[0]!r}; there are: {', '.join(sorted({trial.name for trial in made}))}"
        )
    return tuple(trial for trial in made if not only or trial.name in only)


def _null(count: int) -> Iterator[Trial]:
    for number in range(count):
        yield _trial("null", (), 0.0, number, fine=number // len(PLANTS) % 2 == 0)


def _confusion(seeds: int) -> Iterator[Trial]:
    """Every effect at every size, then unlisted structures and pairs at the middle one."""
    for row, name in enumerate(SCALES):
        for column, factor in enumerate(SIZES.values()):
            for number in range(seeds):
                yield _trial("confusion", (name,), factor, number, fine=(row + column + number) % 2 == 0)
    for row, names in enumerate([*((name,) for name in UNLISTED_SCALES), *PAIRS]):
        for number in range(seeds):
            yield _trial("confusion", names, 1.0, number, fine=(row + number) % 2 == 0)


def _power(seeds: int) -> Iterator[Trial]:
    for row, name in enumerate(POWER):
        for column, errors in enumerate(POWER_ERRORS):
            for number in range(seeds):
                fine = (row + column + number) % 2 == 0
                yield _trial("power", (name,), 1.0, number, fine=fine, errors=errors)


def _imperfect(seeds: int) -> Iterator[Trial]:
    """Every kind of imperfection without a hidden effect, and with one of middle size, the catalogue in turn."""
    for number in range(seeds):  # outermost, so that a study that is stopped has of every kind
        for row, kind in enumerate(IMPERFECTIONS):
            fine = (row + number) % 2 == 0
            yield _trial("imperfect", (), 0.0, number, fine=fine, imperfection=kind)
            others = [name for name in SCALES if name not in names_for(kind)]
            hidden = others[(row + number * len(IMPERFECTIONS)) % len(others)]
            yield _trial("imperfect", (hidden,), 1.0, number, fine=fine, imperfection=kind)


def _trial(
    study: str,
    names: Sequence[str],
    factor: float,
    number: int,
    *,
    fine: bool,
    errors: float = 0.0,
    imperfection: str = "",
) -> Trial:
    name = " + ".join(names) or "none"
    # crc32 rather than hash(): the same in every process
    text = f"{study} {name} {factor:g} {number}" + (f" {imperfection}" if imperfection else "")
    text += f" {errors:g} errors" if errors else ""
    generator = np.random.default_rng((_SEED, zlib.crc32(text.encode())))
    hidden = {each: SCALES[each].drawn(factor, generator) for each in names if each in SCALES}
    unlisted = {each: UNLISTED_SCALES[each].drawn(factor, generator) for each in names if each in UNLISTED_SCALES}
    return Trial(
        study=study,
        name=name,
        factor=factor,
        number=number,
        plant=PLANTS[number % len(PLANTS)] if all(map(in_engines, hidden)) and not imperfection else RIG,
        counts=FINE if fine else PAPER,
        noise=round(float(generator.uniform(*_NOISE)), 6),
        spikes=_SPIKES if generator.uniform() < _SPIKED and not imperfection else 0.0,
        hidden=hidden,
        unlisted=unlisted,
        declared=_declared(generator, hidden),
        seed=int(generator.integers(2**31)),
        recordings=RECORDINGS if hidden or number % _EVERY else MORE_RECORDINGS,
        errors=errors,
        imperfection=imperfection,
    )


def in_engines(name: str) -> bool:
    """Whether the engines' scenes can show this effect."""
    return SCALES[name].engines


def _declared(generator: np.random.Generator, hidden: Values) -> Values:
    """What acts and is declared; nothing that would make the hidden effect one of degree."""
    declared: Values = {}
    probability, low, high = _ROLLING
    rolling = generator.uniform() < probability, float(generator.uniform(low, high))
    like_it = set(ROLLING_RESISTANCE.relations.nested_in)
    if rolling[0] and not any(like_it & set(CATALOGUE[name].relations.nested_in) for name in hidden):
        declared[ROLLING_RESISTANCE.name] = {"coefficient": round(rolling[1], 5)}
    probability, low, high = _LEVEL
    level = generator.uniform() < probability, float(generator.uniform(low, high) * generator.choice((-1.0, 1.0)))
    if level[0] and LEVEL_ERROR.name not in hidden:
        declared[LEVEL_ERROR.name] = {"angle": round(level[1], 5)}
    return declared
