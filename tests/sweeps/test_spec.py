"""A mistake in a sweep.toml has one message: what is wrong, where, and what to write."""

from __future__ import annotations

from pathlib import Path

import pytest

from harness.errors import InputError
from harness.sweeps import read_spec
from harness.sweeps.factors import Factor
from tests.sweeps.made import spec_file

MISTAKES = {
    "sources = [": "not valid TOML",
    "cases = []": "cases is empty; name one at least",
    'cases = "rig"': r'write cases = \["rig"\]',
    'engines = ["mujoco"]': "engines is unknown. Write sources",
    'sorces = ["mujoco"]': "sorces is unknown. Did you mean 'sources'",
    'sources = ["mujco"]': "no 'mujco'. Did you mean 'mujoco'",
    'sources = ["cam", "cam"]': "lists 'cam' twice",
    'design = "gird"': "no 'gird'. Did you mean 'grid'",
    "size = 4": "says nothing of a grid",
    'design = "sobol"': "size is missing",
    'design = "sobol"\nsize = 100': "100 is no power of 2.*write 128",
    'design = "latin_hypercube"\nsize = 4': "samples ranges, and there is none",
    "indices = true": 'indices = true needs design = "sobol"',
    "time_step = []": "time_step is an empty list",
    "time_step = [1e-3, 1e-3]": "lists a value twice",
    "time_step = 0.0": "time_step = 0.0: Input should be greater than 0",
    'time_step = "small"': "time_step = 'small': Input should be a valid number",
    "window_s = -1.0": "window_s = -1.0.*greater than 0",
    "[dart]\ntime_step = 1e-3": "sources leaves dart out",
    "[mujoco]\nfrction = 0.5": "no parameter 'frction'. Did you mean 'friction'",
    "[mujoco]\nfriction = -1.0": "mujoco.friction = -1.0: Input should be greater",
    "[mujoco]\nfriction = { low = 0.1, high = 1.0 }": "mujoco.friction has no levels",
    "[mujoco]\nfriction = { low = 1.0, high = 0.1, levels = 2 }": "mujoco.friction: low 1 is not below high 0.1",
    '[mujoco]\nfriction = { low = 0.0, high = 0.1, scale = "log", levels = 2 }': "no logarithm",
    "[mujoco]\nfriction = { low = 0.1, high = 0.2, steps = 2 }": "mujoco.friction.steps is unknown",
    "[mujoco]\nfriction = { low = 0.1, levels = 2 }": "mujoco.friction.high is missing",
    "[mujoco]\niterations = { low = 1, high = 9, levels = 2 }": "takes single values, not a range",
    "[rig]\nmass = 0.07": "mass is unknown. Did you mean 'mass_kg'",
    '[rig]\nmass_kg = "heavy"': "'heavy' is not a number",
    "[rig]\nmass_kg = [0.07, -0.07]": "rig.mass_kg = -0.07: Input should be greater than 0",
    "[rig]\nradius_m = { low = 0.0, high = 0.01 }": "rig.radius_m = 0.0: Input should be greater than 0",
    "[rig]\nlevel_angle_rad = 2.0": "rig.level_angle_rad = 2.0: level_angle is 2 rad; more than 45°",
    "[effects.rolling_resistence]\ncoefficient = 0.1": "Did you mean 'rolling_resistance'",
    "[effects.rolling_resistance]\ncoeficient = 0.1": "Did you mean 'coefficient'",
    "[effects.rolling_resistance]": "coefficient is missing",
    "[effects.rolling_resistance]\ncoefficient = [0.1, 900.0]": "must lie between",
}


@pytest.mark.parametrize("text", MISTAKES, ids=lambda text: text.replace("\n", " ")[:40])
def test_a_mistake_has_one_message(text: str, tmp_path: Path) -> None:
    """Name the file and the key, in one line."""
    file = spec_file(tmp_path, text, case=False)
    with pytest.raises(InputError, match=MISTAKES[text]) as caught:
        read_spec(file)
    assert str(caught.value).startswith(f"{file}: ")
    assert "\n" not in str(caught.value)
    assert "pydantic" not in str(caught.value)


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("time_step", "s"),
        ("mujoco.friction", "1"),
        ("pybullet.rolling_friction", "m"),
        ("effects.viscous_damping.coefficient", "N s/m"),
        ("rig.mass_kg", ""),
    ],
)
def test_a_factor_has_the_unit_of_what_it_sets(name: str, unit: str) -> None:
    """Take it from the engine's description or the catalogue; that of a rig is part of its name."""
    assert Factor(name).unit == unit
