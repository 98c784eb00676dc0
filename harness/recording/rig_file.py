"""Reads `rig.toml`: schema, validation with remedies, conversion to `KnownRig`, `Sensors` and `Declared`."""

import math
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from analytic.naming import did_you_mean
from analytic.rig import RigError
from harness.errors import InputError
from harness.recording.findings import DataFinding
from harness.recording.known_rig import Declared, KnownRig, Sensors
from harness.recording.scene_files import scene_of
from harness.recording.source import read_source
from harness.scene import Scene
from harness.toml_text import parse_toml

Positive = Annotated[float, Field(gt=0.0)]
DENSITIES = (10.0, 23_000.0)  # kg/m³: foam, and above osmium
NotNegative = Annotated[float, Field(ge=0.0)]


class _Table(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False)


def _quantity(key: str, default: float | None = None) -> Any:
    """A quantity that a table has under `key`, with its unit, and the product without."""
    return Field(default, alias=key)


class _Ball(_Table):
    mass: Positive | None = _quantity("mass_kg")
    inertia: Positive | None = _quantity("inertia_kg_m2")
    radius: Positive | None = _quantity("radius_m")


class _Beam(_Table):
    rolling_radius: Positive | None = _quantity("rolling_radius_m")
    eccentricity: float | None = _quantity("eccentricity_m")
    length: Positive | None = _quantity("length_m")
    level_angle: float | None = _quantity("level_angle_rad")


class _Environment(_Table):
    gravity: Positive | None = _quantity("gravity_m_s2")


class _Sensors(_Table):
    angle_resolution: Positive | None = _quantity("angle_resolution_rad")
    angle_noise: NotNegative | None = _quantity("angle_noise_rad")
    position_noise: NotNegative | None = _quantity("position_noise_m")
    position_resolution: Positive | None = _quantity("position_resolution_m")


class _Declared(BaseModel):
    model_config = ConfigDict(extra="allow", strict=True, allow_inf_nan=False)
    __pydantic_extra__: dict[str, float] = Field(init=False)
    name: str


class _Recordings(_Table):
    identify: list[str] = []
    predict: list[str] = []


class _Scene(_Table):
    mjcf: str | None = None
    urdf: str | None = None
    ball_urdf: str | None = None
    beam_joint: str = Scene.beam_joint
    ball: str = Scene.ball
    direction: Literal[1, -1] = 1
    level_joint_angle: float = _quantity("level_joint_angle_rad", 0.0)
    driven_joint: str | None = None


class _RigFile(_Table):
    origin: str | None = None
    ball: _Ball = _Ball()
    beam: _Beam = _Beam()
    environment: _Environment = _Environment()
    sensors: _Sensors = _Sensors()
    declared: list[_Declared] = []
    recordings: _Recordings | None = None
    scene: _Scene | None = None


TABLES: dict[str, type[_Table]] = {
    "ball": _Ball,
    "beam": _Beam,
    "environment": _Environment,
    "sensors": _Sensors,
    "recordings": _Recordings,
    "scene": _Scene,
}
KEYS = {
    table: tuple(field.alias or name for name, field in model.model_fields.items()) for table, model in TABLES.items()
}


@dataclass(frozen=True)
class RigFile:
    """The content of a `rig.toml`.

    Attributes:
        origin: free text on where the data come from; `None` if absent.
        rig: the known quantities.
        sensors: declared sensor properties.
        declared: declared effects.
        identify, predict: names of recordings as written; both `None` without a table `[recordings]`.
        findings: warnings and notes on the file.
        sha256: of the file's bytes.
        scene: the user's own scene; `None` without a table `[scene]`.
    """

    origin: str | None
    rig: KnownRig
    sensors: Sensors
    declared: tuple[Declared, ...]
    identify: tuple[str, ...] | None
    predict: tuple[str, ...] | None
    findings: tuple[DataFinding, ...]
    sha256: str
    scene: Scene | None = None


def read_rig_file(path: Path) -> RigFile:
    """Reads and checks a `rig.toml`.

    Raises:
        InputError: the file is not TOML, has unknown tables or keys or invalid values, or describes an impossible
            rig. The message names table and key.
    """
    source = read_source(path)
    text = source.text
    try:
        content = _RigFile.model_validate(parse_toml(text))
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{path}: not valid TOML: {error}.{_quoted_line(text, str(error))}") from None
    except ValidationError as error:
        raise InputError(f"{path}: {_advice(error.errors()[0])}{_more(error)}") from None
    try:
        parts = (content.ball, content.beam, content.environment)
        rig = KnownRig(**{name: value for part in parts for name, value in part})
    except RigError as error:
        raise InputError(f"{path}: impossible rig: {error}. Correct the values or their units.") from None
    names = [one.name for one in content.declared]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise InputError(
            f"{path}: [[declared]] lists '{twice}' {names.count(twice)} times, and effects add up. Declare it "
            "once, with the values that act."
        )
    listed = content.recordings
    return RigFile(
        origin=content.origin,
        rig=rig,
        sensors=Sensors(**dict(content.sensors)),
        declared=tuple(Declared(one.name, dict(one.__pydantic_extra__)) for one in content.declared),
        identify=None if listed is None else tuple(listed.identify),
        predict=None if listed is None else tuple(listed.predict),
        findings=tuple(_findings(path, rig)),
        sha256=source.sha256,
        scene=None if content.scene is None else scene_of(path, **dict(content.scene)),
    )


def _findings(path: Path, rig: KnownRig) -> list[DataFinding]:
    findings: list[DataFinding] = []
    if rig.unknown:
        text = (
            f"unknown: {', '.join(rig.unknown)}; estimated if the recordings allow it, otherwise results are per unit."
        )
        if rig.inertia is None and rig.mass is not None and rig.radius is not None:
            text += " For a solid ball, add inertia_kg_m2 = 2/5 m R² to [ball]."
        findings.append(DataFinding("note", path.name, text, "unknown-quantities"))
    if rig.inertia is not None and rig.mass is not None and rig.radius is not None:
        ratio = rig.inertia / (rig.mass * rig.radius**2)
        if not 0.3 <= ratio <= 0.7:
            text = f"is {ratio:.3g} m R²; a solid ball has 0.4, a thin shell 0.667. Check mass, radius and inertia."
            findings.append(DataFinding("warning", f"{path.name}, [ball] inertia_kg_m2", text, "inertia"))
    if rig.mass is not None and rig.radius is not None:
        density = rig.mass / (4.0 / 3.0 * math.pi * rig.radius**3)
        if not DENSITIES[0] <= density <= DENSITIES[1]:
            text = (
                f"{rig.mass:g} kg in a ball of radius {rig.radius:g} m is a density of {density:.3g} kg/m³; steel "
                "has 7800, a table-tennis ball 80. Check the units of mass and radius."
            )
            findings.append(DataFinding("warning", f"{path.name}, [ball]", text, "density"))
    if rig.gravity is not None and not 9.7 <= rig.gravity <= 9.9:
        text = f"is {rig.gravity:g} m/s²; on Earth it lies between 9.76 and 9.84."
        findings.append(DataFinding("warning", f"{path.name}, [environment] gravity_m_s2", text, "gravity"))
    return findings


def _quoted_line(text: str, error: str) -> str:
    """The line that a TOML error refers to, with a hint for decimal commas."""
    _, found, after = error.partition("(at line ")
    if not found:
        return ""
    line = text.split("\n")[int(after.split(",")[0]) - 1].strip()
    hint = " Use a decimal point." if "," in line.partition("=")[2] and '"' not in line else ""
    return f" The line reads '{line}'.{hint}"


def _key(location: tuple[str | int, ...]) -> str:
    if location[0] == "declared" and len(location) > 1:
        rest = ".".join(str(part) for part in location[2:] if part != "__pydantic_extra__")
        return f"[[declared]] number {int(location[1]) + 1}{f', {rest}' if rest else ''}"
    table, rest = str(location[0]), ".".join(str(part) for part in location[1:])
    return f"[{table}] {rest}".rstrip()


def _advice(error: Any) -> str:
    location, kind, value = error["loc"], error["type"], error["input"]
    where = _key(location)
    if kind == "extra_forbidden":
        return _unknown(location, value)
    if kind == "missing":
        return f"{where} is missing. Name the effect as the catalogue in docs/diagnosis.md does."
    if kind == "float_type":
        return f"{where} = {value!r} is not a number. Write a plain number such as 0.0132, without quotes or unit."
    if kind in ("string_type", "list_type"):
        wanted = 'text, such as "rec_01.csv"' if kind == "string_type" else 'a list, such as ["rec_01.csv"]'
        if location[0] == "declared" and kind == "list_type":
            return "[declared] must be a list of tables. Write [[declared]] with two brackets."
        return f"{where} = {value!r} has the wrong type. Write {wanted}."
    if kind == "literal_error":
        return f"{where} = {value!r}: write {error['ctx']['expected']}."
    if kind in ("greater_than", "greater_than_equal"):
        bound = "positive" if kind == "greater_than" else "zero or positive"
        return f"{where} = {value!r} must be {bound}. Correct it, or delete the line if it is unknown."
    if kind == "finite_number":
        return f"{where} = {value!r} must be finite. Delete the line if it is unknown."
    if kind in ("model_type", "dict_type", "model_attributes_type"):
        name = "[[declared]]" if location[0] == "declared" else f"[{location[0]}]"
        return f"{where} = {value!r} must be a table. Write {name} on a line of its own and its keys below."
    return f"{where} = {value!r}: {error['msg']}."


def _unknown(location: tuple[str | int, ...], value: object) -> str:
    key = str(location[-1])
    if len(location) == 1 and isinstance(value, dict | list):
        tables = tuple(_RigFile.model_fields)
        return f"[{key}] is an unknown table.{did_you_mean(key, tables)} Tables are {', '.join(tables)}."
    home = next((table for table, keys in KEYS.items() if key in keys), None)
    if home is not None:
        return f"{_key(location) if len(location) > 1 else key} is in the wrong table. Move it to [{home}]."
    if len(location) == 1:
        every = tuple(name for keys in KEYS.values() for name in keys)
        return f"{key} is unknown and outside any table.{did_you_mean(key, every)}"
    keys = KEYS[str(location[0])]
    return f"{_key(location)} is unknown.{did_you_mean(key, keys)} Keys of [{location[0]}] are {', '.join(keys)}."


def _more(error: ValidationError) -> str:
    others = error.error_count() - 1
    return f" ({others} more {'problem' if others == 1 else 'problems'} in this file.)" if others else ""
