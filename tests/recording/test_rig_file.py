"""`rig.toml` says what is known; anything it cannot mean is refused with table, key and remedy."""

from __future__ import annotations

from pathlib import Path

import pytest

from analytic.rig import Rig, RigError
from harness.errors import InputError
from harness.recording import Declared, KnownRig, Sensors
from harness.recording.rig_file import read_rig_file

FULL = """
[ball]
mass_kg = 0.071
inertia_kg_m2 = 4.948e-6
radius_m = 0.0132

[beam]
rolling_radius_m = 0.0118
eccentricity_m = 0.035
length_m = 1
level_angle_rad = -0.002

[environment]
gravity_m_s2 = 9.81

[sensors]
angle_resolution_rad = 0.00157
angle_noise_rad = 0
position_noise_m = 0.0003
position_resolution_m = 0.0001

[[declared]]
name = "rolling_resistance"
coefficient = 0.002

[[declared]]
name = "track_bump"
height = 1e-4
centre = 0.3
width = 0.02

[recordings]
identify = ["rec_01.csv"]
predict = ["rec_02.csv"]
"""


def write(folder: Path, text: str, encoding: str = "utf-8") -> Path:
    """A rig.toml with this text."""
    path = folder / "rig.toml"
    path.write_bytes(text.encode(encoding))
    return path


def test_an_effect_is_declared_once(tmp_path: Path) -> None:
    """Refuse an effect that is declared twice, whose values would be added."""
    effect = '[[declared]]\nname = "rolling_resistance"\ncoefficient = 0.002\n'
    with pytest.raises(InputError, match=r"rig\.toml: \[\[declared\]\] lists 'rolling_resistance' 2 times"):
        read_rig_file(write(tmp_path, effect + effect))


def test_a_density_that_no_ball_has(tmp_path: Path) -> None:
    """Warn of a mass and a radius that no ball has, as of a mass in grams; steel, foam and hollow balls are sound."""

    def codes(mass: float, radius: float) -> list[str]:
        text = f"[ball]\nmass_kg = {mass}\nradius_m = {radius}\n"
        return [one.code for one in read_rig_file(write(tmp_path, text)).findings if one.severity == "warning"]

    assert codes(71.0, 0.0132) == ["density"]
    assert codes(0.071, 1.32) == ["density"]
    for mass, radius in ((0.071, 0.0132), (0.0027, 0.02), (0.001, 0.02)):
        assert codes(mass, radius) == []


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16"])
def test_everything_is_read(tmp_path: Path, encoding: str) -> None:
    """Read every key of the contract, whole numbers included, whatever the encoding."""
    content = read_rig_file(write(tmp_path, FULL, encoding))
    assert content.rig == KnownRig(
        mass=0.071,
        inertia=4.948e-6,
        radius=0.0132,
        rolling_radius=0.0118,
        eccentricity=0.035,
        gravity=9.81,
        level_angle=-0.002,
        length=1.0,
    )
    assert content.sensors == Sensors(
        angle_resolution=0.00157, angle_noise=0.0, position_noise=0.0003, position_resolution=0.0001
    )
    assert content.declared == (
        Declared("rolling_resistance", {"coefficient": 0.002}),
        Declared("track_bump", {"height": 1e-4, "centre": 0.3, "width": 0.02}),
    )
    assert (content.identify, content.predict) == (("rec_01.csv",), ("rec_02.csv",))
    assert content.findings == ()


def test_nothing_is_assumed(tmp_path: Path) -> None:
    """Leave every quantity of an empty file unknown."""
    content = read_rig_file(write(tmp_path, ""))
    assert content.rig == KnownRig()
    assert content.rig.unknown == ("mass", "inertia", "radius", "rolling_radius", "eccentricity", "gravity")
    assert content.sensors == Sensors()
    assert content.identify is None


def test_inertia_is_not_guessed(tmp_path: Path) -> None:
    """Leave the inertia unknown although mass and radius are known, and say how to declare a solid ball."""
    content = read_rig_file(write(tmp_path, "[ball]\nmass_kg = 0.071\nradius_m = 0.0132\n"))
    assert content.rig.inertia is None
    assert "2/5 m R²" in content.findings[0].text


BAD = {
    "syntax": ("[ball]\nmass_kg = \n", ("not valid TOML", "line 2", "'mass_kg ='")),
    "decimal comma": ("[ball]\nradius_m = 0,0132\n", ("line 2", "'radius_m = 0,0132'", "Use a decimal point")),
    "unit": ("[ball]\nradius_m = 13.2 mm\n", ("not valid TOML", "line 2", "'radius_m = 13.2 mm'")),
    "unknown table": ("[bal]\nmass_kg = 1\n", ("[bal] is an unknown table", "Did you mean 'ball'?")),
    "unknown key": ("[ball]\nradius_mm = 13.2\n", ("[ball] radius_mm", "Did you mean 'radius_m'?")),
    "foreign key": ("[beam]\nradius_m = 0.0132\n", ("[beam] radius_m", "wrong table", "[ball]")),
    "key outside": ("mass_kg = 1\n", ("mass_kg", "wrong table", "[ball]")),
    "strange key outside": ("masss = 1\n", ("masss", "outside any table")),
    "text for a number": ('[ball]\nmass_kg = "71 g"\n', ("[ball] mass_kg = '71 g'", "not a number", "without quotes")),
    "true for a number": ("[ball]\nmass_kg = true\n", ("[ball] mass_kg", "not a number")),
    "zero": ("[ball]\nmass_kg = 0\n", ("[ball] mass_kg", "positive", "delete the line")),
    "negative": ("[sensors]\nangle_noise_rad = -1e-3\n", ("[sensors] angle_noise_rad", "zero or positive")),
    "not finite": ("[beam]\neccentricity_m = nan\n", ("[beam] eccentricity_m", "finite")),
    "number for a table": ("ball = 3\n", ("[ball] = 3", "must be a table")),
    "one bracket": ('[declared]\nname = "x"\n', ("[[declared]] with two brackets",)),
    "no name": ("[[declared]]\ncoefficient = 0.1\n", ("[[declared]] number 1, name", "missing")),
    "text parameter": (
        '[[declared]]\nname = "viscous_damping"\ncoefficient = "small"\n',
        ("[[declared]] number 1, coefficient = 'small'", "not a number"),
    ),
    "text for a list": (
        '[recordings]\nidentify = "a.csv"\n',
        ("[recordings] identify", 'a list, such as ["rec_01.csv"]'),
    ),
    "number for a name": ("[recordings]\nidentify = [1]\n", ("[recordings] identify.0", "text")),
    "r above R": (
        "[ball]\nradius_m = 0.01\n[beam]\nrolling_radius_m = 0.0118\n",
        ("impossible rig", "rolling_radius 0.0118", "0.01 m", "units"),
    ),
    "inertia of a wheel": ("[ball]\nmass_kg = 0.071\nradius_m = 0.0132\ninertia_kg_m2 = 4.9e-3\n", ("m R²", "units")),
    "level in degrees": ("[beam]\nlevel_angle_rad = 3\n", ("level_angle", "45°")),
    "two faults": ("[ball]\nmass_kg = -1\nradius_m = -1\n", ("mass_kg", "1 more problem")),
}


@pytest.mark.parametrize("name", BAD)
def test_refused_with_key_and_advice(tmp_path: Path, name: str) -> None:
    """Refuse the file in one line that names it, the key, the fault and the remedy."""
    text, parts = BAD[name]
    path = write(tmp_path, text)
    with pytest.raises(InputError) as caught:
        read_rig_file(path)
    message = str(caught.value)
    assert message.startswith(str(path))
    assert "\n" not in message
    assert "pydantic" not in message
    for part in parts:
        assert part in message


@pytest.mark.parametrize(
    ("text", "part"),
    [
        ("[ball]\nmass_kg = 0.071\nradius_m = 0.0132\ninertia_kg_m2 = 1e-6\n", "a solid ball has 0.4"),
        ("[environment]\ngravity_m_s2 = 98.1\n", "on Earth"),
    ],
    ids=("inertia", "gravity"),
)
def test_unlikely_values_are_questioned(tmp_path: Path, text: str, part: str) -> None:
    """Warn about what is possible but unlikely."""
    content = read_rig_file(write(tmp_path, text))
    assert any(finding.severity == "warning" and part in finding.text for finding in content.findings)


def test_estimates_complete_a_rig() -> None:
    """Fill in only what is unknown: what is known wins over an estimate."""
    rig = KnownRig(mass=0.033, radius=0.010).complete(
        mass=1.0, inertia=1.3e-6, rolling_radius=0.009, eccentricity=0.0, gravity=9.8, friction_coefficient=0.1
    )
    assert rig == Rig(
        mass=0.033,
        inertia=1.3e-6,
        radius=0.010,
        rolling_radius=0.009,
        eccentricity=0.0,
        gravity=9.8,
        friction_coefficient=0.1,
    )


def test_incomplete_rig_names_what_is_missing() -> None:
    """Name the quantities that are neither known nor estimated."""
    with pytest.raises(InputError, match="inertia, eccentricity must be known"):
        KnownRig(mass=0.07, radius=0.0132, rolling_radius=0.0118).complete(gravity=9.81)


def test_impossible_completion() -> None:
    """Refuse an estimate that makes an impossible rig."""
    known = KnownRig(mass=0.07, inertia=5e-6, radius=0.0132, eccentricity=0.035, gravity=9.81)
    with pytest.raises(InputError, match="impossible: rolling_radius"):
        known.complete(rolling_radius=0.02)


def test_strange_estimate() -> None:
    """Refuse an estimate of something a rig does not have."""
    with pytest.raises(TypeError, match="colour"):
        KnownRig().complete(colour=1.0)


@pytest.mark.parametrize("length", [0.0, -1.0, float("inf")])
def test_impossible_length(length: float) -> None:
    """Refuse a beam without length."""
    with pytest.raises(RigError, match="length"):
        KnownRig(length=length)
