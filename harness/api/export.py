"""Writes the identified model of a diagnosis in a form that other programs take."""

from __future__ import annotations

import json
import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, get_args

from harness.api.effects import Given, beside_catalogue, files_of
from harness.api.outputs import sealed_json, to_json
from harness.api.same_rig import changed_since
from harness.api.saved import LoadedDiagnosis, load_diagnosis
from harness.api.writing import all_or_nothing, hashes_of, written
from harness.errors import InputError
from harness.report.tables import Summarised, Summary, Table, texts
from harness.threads import one_blas_thread

if TYPE_CHECKING:
    from harness.exports.carried import Carried
    from harness.exports.model import ExportModel

Format = Literal["fmu", "mjcf", "urdf", "c", "python", "statespace"]
FORMATS: tuple[str, ...] = get_args(Format)
RECORD, README = "export.json", "README.txt"
_WIDTH = 110  # of README.txt


@dataclass(frozen=True, repr=False)
class Export(Summarised):
    """What `export` wrote.

    Attributes:
        to: the format.
        folder: where the files are.
        files: their names, README.txt and export.json included.
        carried: every effect of the model, and a law that no catalogue lists: its name, whether the files have it, and
            how, or what to do.
        model: the rig, the effects and the spline term that were written.
        warning: that the diagnosis is not as `diagnose` wrote it; empty if it is.
    """

    to: str
    folder: Path
    files: tuple[str, ...]
    carried: tuple[Carried, ...]
    model: ExportModel = field(compare=False)
    warning: str = ""

    @property
    def complete(self) -> bool:
        """Whether the files have every effect, and a law that no catalogue lists."""
        return all(one.carried for one in self.carried)

    def content(self) -> dict[str, Any]:
        """As JSON."""
        rows = [{"name": one.name, "carried": one.carried, "how": one.how} for one in self.carried]
        return {"to": self.to, "out": str(self.folder), "files": self.files, "complete": self.complete, "effects": rows}

    def summary(self) -> Summary:
        """The files, and every effect."""
        rows = [(f"`{one.name}`", "yes" if one.carried else "no", one.how) for one in self.carried]
        tables = [Table("Effects", texts("effect", "carried", "how"), rows)] if rows else []
        return Summary(f"Export to {self.to}: {self.folder}", [", ".join(self.files)], tables)


@one_blas_thread()
def export(
    diagnosis: LoadedDiagnosis | str | Path,
    to: Format,
    *,
    out: str | Path | None = None,
    fmi: Literal[2, 3] | None = None,
    at: Mapping[str, float] | None = None,
    pade: int | None = None,
    effects: Sequence[Given] = (),
    force: bool = False,
) -> Export:
    """Write the identified model as source code, FMU, scene or linear model; all files of it or none.

    Args:
        diagnosis: a diagnosis, or a diagnosis.json or its folder.
        to: "c" or "python", source code without dependencies; "fmu", for co-simulation; "mjcf" or "urdf", a scene with
            the effects that it can carry; "statespace", linearised.
        out: folder to write into; `export_<to>` beside the diagnosis if none is given.
        fmi: version of the FMU's standard, 2 or 3; 2 if none is given.
        at: operating point of the linear model, `position` [m] and `angle` [rad], 0 by default.
        pade: order of a Padé approximation of the delay, beside the linear model without it; 1 … 10.
        effects: effects of your own that the diagnosis was made with, as Python files or as `Effect` objects.
        force: replace files that no export wrote, or that have been changed since, or an export to another format, too.

    Raises:
        InputError: the diagnosis cannot be used, the format cannot take its model, an option is of another format, a
            compiler is missing, or the files cannot be written; nothing has been written then.
    """
    _check(to, fmi, at, pade)
    kept = diagnosis if isinstance(diagnosis, LoadedDiagnosis) else load_diagnosis(diagnosis, effects=effects)
    beside = kept.origin.parent if kept.origin.suffix == ".json" else Path("reports") / kept.origin.stem
    folder = Path(out) if out is not None else beside / f"export_{to}"
    if folder.exists() and not folder.is_dir():
        raise InputError(f"{folder}: is no folder; name a folder to write into with --out")
    if not force:
        _refuse_another_format(folder, to)
    with beside_catalogue(effects or kept.own_effects):
        from harness.exports.model import export_model

        model = export_model(kept.record, str(kept.origin))
        carried = _carried(model, to)
        readme = _readme(model, to, carried, fmi or 2)
        files = _files(model, to, readme, fmi=fmi or 2, at=at or {}, pade=pade) | {README: readme}
        inputs = [one for one in (kept.origin, *files_of(effects)) if one.is_file()]
        names = (*files, RECORD)
        writing = all_or_nothing(folder, record=RECORD, names=names, inputs=inputs, force=force, supersede=True)
        with writing as scratch:
            for name, content in files.items():
                (scratch / name).write_bytes(content if isinstance(content, bytes) else content.encode())
            told = {
                "command": "export",
                "to": to,
                "diagnosis": kept.record.sealed,
                "effects": [{"name": one.name, "carried": one.carried, "how": one.how} for one in carried],
                "files": hashes_of(scratch),
            }
            (scratch / RECORD).write_text(sealed_json(told), encoding="utf-8")
        return Export(to, folder, names, tuple(carried), model, changed_since(kept.record, kept.origin))


def _refuse_another_format(folder: Path, to: str) -> None:
    """Refuse to write into a folder with an export to another format, whose README.txt and record would be lost."""
    record = folder / RECORD
    if not written(record):  # none, or changed, which is told when the files are written
        return
    other = json.loads(record.read_bytes()).get("to")
    if other != to:
        raise InputError(
            f"{folder}: holds an export to {other}, and one to {to} needs a folder of its own; choose another --out, "
            f"such as {folder.with_name(f'{folder.name}_{to}')}, or replace all of it with --force"
        )


def _check(to: str, fmi: int | None, at: Mapping[str, float] | None, pade: int | None) -> None:
    """Refuse formats that there are not, and options of another format."""
    if to not in FORMATS:
        raise InputError(f"there is no format {to!r}; there are {', '.join(FORMATS)}")
    if fmi is not None and to != "fmu":
        raise InputError(f"a version of FMI is for fmu, not for {to}")
    if fmi not in (None, 2, 3):
        raise InputError(f"there is no FMI {fmi} to export to; there are 2 and 3")
    if to != "statespace" and (at is not None or pade is not None):
        raise InputError(f"an operating point and a Padé approximation are for statespace, not for {to}")
    unknown = set(at or {}) - {"position", "angle"}
    if unknown:
        raise InputError(f"an operating point has position and angle, not {', '.join(sorted(unknown))}")


def _carried(model: ExportModel, to: str) -> list[Carried]:
    from harness.exports.carried import in_linear, in_scene, in_source, spline_in

    if to in ("mjcf", "urdf"):
        effects = in_scene(model, slips=to == "mjcf")
    else:
        effects = in_linear(model) if to == "statespace" else in_source(model, to)
    return [*effects, *spline_in(model, to)]


def _files(
    model: ExportModel, to: str, readme: str, *, fmi: Literal[2, 3], at: Mapping[str, float], pade: int | None
) -> dict[str, str | bytes]:
    """Content by name."""
    if to == "c":
        from harness.exports.code_files import c_files

        return dict(c_files(model))
    if to == "python":
        from harness.exports.code_files import python_files

        return dict(python_files(model))
    if to == "fmu":
        from harness.exports.fmu import fmu_bytes

        return {"ball_beam.fmu": fmu_bytes(model, fmi, readme)}
    if to == "statespace":
        from harness.exports.beam import check_point
        from harness.exports.linear import Point, linearise
        from harness.exports.statespace_files import content_of, statespace_files

        point = Point(**at)
        check_point(model, point.position, point.angle)
        linear = linearise(model, point)
        return statespace_files(linear, pade, to_json(content_of(linear, pade)) + "\n")
    from harness.exports.scenes import mjcf_files, urdf_files

    return dict(mjcf_files(model) if to == "mjcf" else urdf_files(model))


def _readme(model: ExportModel, to: str, carried: Sequence[Carried], fmi: int) -> str:
    from harness.exports.beam import beam_told
    from harness.exports.source import render

    title, text = _TEXTS[to]
    told = text.format(fmi=fmi, beam=beam_told(model), late=_late(model.sensor.delay, to))
    filled = "\n\n".join(
        part if part.startswith(" ") else textwrap.fill(part, _WIDTH) for part in told.strip().split("\n\n")
    )
    return render("README.txt", {"title": title, "text": filled, "model": model, "carried": carried})


def _late(delay: float, to: str) -> str:
    """What to do about a negative delay [s]; empty for any other."""
    if delay >= 0.0:
        return ""
    if to == "statespace":
        return (
            f"The delay is negative, the angle is late by {-delay:.6g} s, which no approximation has: feed the model "
            f"the angle {-delay:.6g} s early, at t that of t + {-delay:.6g} s."
        )
    return (
        f"The delay is negative, the angle is late by {-delay:.6g} s: what is printed of the last {-delay:.6g} s would "
        "need angles after the last row, and is left blank. Give rows that go on for longer."
    )


_ROWS = (
    "Rows hold time [s], beam angle [rad], its rate [rad/s] and angular acceleration [rad/s2]; between rows the "
    "angle is the "
    "quintic through them. Rows of time and angle alone are taken too: rate and acceleration then come from a local "
    "cubic, fitted by least squares over +-0.1 s. That smooths more than `harness predict` does, which estimates the "
    "angle with the noise of its sensor: after 14 to 16 s the ball was 0.9 to 18 mm elsewhere on the records tried. "
    "Where millimetres matter, give all four columns. The delay of the "
    "sensor shifts what is printed: the position at t is recorded at t + delay.\n\n{late}"
)
_TEXTS = {
    "c": (
        "The identified ball-and-beam model in C",
        "C99 and libm, nothing else. ball_beam.h has the functions, ball_beam.c the equations, main.c an example:\n\n"
        "    cc -O2 -o ball_beam main.c ball_beam.c -lm\n    ./ball_beam 0.36 < rows.csv > positions.csv\n\n" + _ROWS,
    ),
    "python": (
        "The identified ball-and-beam model in Python",
        "Python 3.10 or newer, its standard library, nothing else; ball_beam.py is module and example:\n\n"
        "    python ball_beam.py 0.36 < rows.csv > positions.csv\n\n" + _ROWS,
    ),
    "fmu": (
        "The identified ball-and-beam model as an FMU",
        "ball_beam.fmu is for co-simulation by FMI {fmi}.0, with a binary for the platform it was made on and its "
        "sources. "
        "Inputs: angle, rate, angular_acceleration of the beam; parameters: start_position, start_velocity, "
        "phase; outputs: "
        "position (what the sensor records), ball_position, ball_velocity.\n\n"
        "All three inputs are needed; from the angle alone derive them as `--to python` does (bb_derive in sources/). "
        "Within a step the angular acceleration is taken to change as it did before, and the step is made again "
        "as soon as "
        "the motion at its end is known, so that steps of 10 ms give 2 micrometres, of 5 ms 0.2.\n\n"
        "A positive delay of the sensor is in `position`. A negative one, an angle that is late, would need "
        "angles of the "
        "future: `position` is then without it, unless the inputs are fed that much early. An input or a start "
        "that is no finite number is refused with a message.",
    ),
    "mjcf": (
        "The identified rig as a scene for MuJoCo",
        "ball_beam.xml loads in MuJoCo and its viewer:\n\n    python -m mujoco.viewer --mjcf=ball_beam.xml\n\n"
        "The actuator `angle` is a servo for the beam angle [rad], which is the viewer's and not identified.\n\n"
        "{beam}",
    ),
    "urdf": (
        "The identified rig as URDF",
        "ball_beam.urdf is stand and beam, ball.urdf the ball. URDF has no gravity: load_in_pybullet.py sets it, "
        "and puts "
        "the ball on the beam. The joint `pivot` turns the beam.\n\n{beam}",
    ),
    "statespace": (
        "The identified ball-and-beam model, linearised",
        "statespace.json, statespace.mat (fields A B C D, states, delay, and the ends of 95 % intervals A_low, "
        "A_high ...) and "
        "statespace.py, which makes a StateSpace of python-control. Input: deviation of the recorded beam angle [rad]; "
        "output: deviation of the recorded position [m]. The delay is a number of its own and not in the matrices; "
        "A_pade ... have it as a Pade approximation where one was asked for.\n\n"
        "The states are shifted by multiples of the angle, so that the term with the angular acceleration needs no "
        "derivative of the input; `physical` in the JSON has position and velocity themselves, with three inputs."
        "\n\n{late}",
    ),
}
