"""Recordings of other programs and instruments become a case."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, fields
from pathlib import Path
from typing import Any

from analytic.naming import did_you_mean
from harness.api.asking import Ask, as_before, changed, repeated, understood_with
from harness.api.case import Case, load_case
from harness.api.outputs import sealed_json
from harness.api.writing import all_or_nothing, hashes_of, settle, written
from harness.errors import InputError
from harness.importing import Options, Understood, read_file
from harness.importing.case_text import Role, described, recording_text, rig_text, with_recordings
from harness.provenance import versions
from harness.recording.case import RIG_FILE
from harness.recording.case import load_case as load_checked_case
from harness.recording.findings import warnings_of
from harness.recording.rig_file import KEYS
from harness.recording.source import read_source
from harness.report.tables import Summarised, Summary, Table, texts
from harness.threads import one_blas_thread

FILE = "import.json"
"""How each recording of the case was understood."""

ROLES: Mapping[Role, str] = {
    "identify": "to identify from",
    "predict": "to predict, held out from every fit",
}
"""What each role of a recording means."""


@dataclass(frozen=True, repr=False)
class Imported(Summarised):
    """What was imported, and how it was understood.

    Attributes:
        folder: of the case.
        recordings: how each was understood, by the name of its file in the case.
        case: as it was loaded from the folder.
        answers: what was asked and answered, as options of the command, by the name of the file in the case.
        role: of the recordings in the case, `identify` or `predict`.
        as_before: what was answered as for the recording that the case had last, by the name of the file in the case.
        options: what was chosen for each, by the user and by answers, by the name of the file in the case.
    """

    folder: Path
    recordings: Mapping[str, Understood]
    case: Case
    answers: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    role: Role = "identify"
    as_before: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    options: Mapping[str, Options] = field(default_factory=dict)

    def summary(self) -> Summary:
        """Columns, evidence, what to do next."""
        lines: list[str] = []
        tables = []
        for name, one in self.recordings.items():
            sources = " and ".join(f"{source.path} ({source.kind})" for source in one.sources)
            rows = [
                (line.role, line.column or "(none)", line.evidence, line.unit, line.unit_from, line.range)
                for line in one.lines
            ]
            heads = texts("role", "column", "because of", "unit", "because of", "in SI units")
            tables.append(Table(f"{name} from {sources}", heads, rows))
            lines += [f"{name}: rate {one.rate}", f"{name}: sign {one.sign}"]
            lines += [f"{name}: negated: {' and '.join(one.flipped)}"] if one.flipped else []
            lines += [f"{name}: note: {note}" for note in one.notes]
            said = self.as_before.get(name)
            lines += [f"{name}: as the last recording of the case: {' '.join(said)}"] if said else []
        lines.append(f"{' and '.join(self.recordings)}: {ROLES[self.role]}")
        lines += [str(one) for one in warnings_of(self.case.findings)]
        lines += self._again()
        unknown = [f"[{table}] {key}" for table, key in self._unknown()]
        if unknown:
            lines.append(f"not known, write it into {self.folder / RIG_FILE} if you know it: {', '.join(unknown)}")
        lines.append(f"next: harness diagnose {self.folder}    or: harness run {self.folder}")
        return Summary(f"case: {self.folder} ({', '.join(self.recordings)})", lines, tables)

    def _again(self) -> list[str]:
        """What asks nothing the next time: one text for all files only where all were answered alike."""
        asked = {
            name: tuple(one for one in answers if one not in self.as_before.get(name, ()))
            for name, answers in self.answers.items()
        }
        if len(set(asked.values())) == 1:
            (shared,) = set(asked.values())
            return [f"to import it again without questions, {changed(shared)}"] if shared else []
        return [
            f"{name}: to import {' and '.join(one.path.name for one in self.recordings[name].sources)} again without "
            f"questions, in a command of its own, {changed(answers)}"
            for name, answers in asked.items()
            if answers
        ]

    def _unknown(self) -> list[tuple[str, str]]:
        rig = self.case.rig
        places = {"mass": "ball", "inertia": "ball", "radius": "ball", "rolling_radius": "beam", "eccentricity": "beam"}
        keys = {key.split("_kg")[0].removesuffix("_m"): key for keys in KEYS.values() for key in keys}
        return [(table, keys[name]) for name, table in places.items() if getattr(rig, name) is None]

    def record(self) -> dict[str, Any]:
        """As JSON content."""
        return {
            "case": str(self.folder),
            "role": self.role,
            "recordings": _new_entries(self.recordings, list(self.options.values())),
            "findings": [asdict(one) for one in self.case.findings],
        }


@one_blas_thread()
def import_recording(
    files: str | Path | Sequence[str | Path],
    *,
    out: str | Path | None = None,
    into: str | Path | None = None,
    role: Role = "identify",
    join: bool = False,
    time: str | None = None,
    angle: str | None = None,
    position: str | None = None,
    rate: float | None = None,
    where: Sequence[str] = (),
    linkage: str | None = None,
    flip_angle: bool = False,
    flip_position: bool = False,
    keep_signs: bool = False,
    rig: Mapping[str, float] | None = None,
    origin: str | None = None,
    force: bool = False,
    ask: Ask | None = None,
    command: str = "harness.import_recording",
) -> Imported:
    """Make a case of recordings as MATLAB, Simulink, LabVIEW, oscilloscopes, microcontrollers, spreadsheets
    or ROS write them.

    Args:
        files: a file, or several, one recording each.
        out: folder to write the case into; by default the name of the first file with `_case`.
        into: an existing case to which the recordings are added instead.
        role: of what is added: `identify`, or `predict` for recordings that no fit may use.
        join: whether the files hold the signals of one recording, such as one channel each.
        time: column of the time as `COLUMN` or `COLUMN:UNIT`, where the files do not say it.
        angle: column of the beam's angle, likewise, or as `COLUMN:GAIN UNIT/READING+OFFSET`.
        position: column of the ball's position, likewise; `none` for a recording without positions.
        rate: sampling rate [Hz], where the file has no times.
        where: rows to take, as `COLUMN=VALUE`: those with one of the values of each column named.
        linkage: `r=0.025,L=0.4` [m] where the angle is that of a crank; the beam's is asin(r sin(θ + offset) / L).
        flip_angle: whether to negate the angle, so that a positive one accelerates the ball towards +s.
        flip_position: whether to negate the position, to the same end.
        keep_signs: whether signs stay that the data contradict.
        rig: known quantities as `{"ball.mass_kg": 0.064}`; keys as in `rig.toml`.
        origin: free text on the data; begin it with `simulated` where they are.
        force: replace files that were not written by an import.
        ask: called where something cannot be told; returns one of the choices.
        command: for the record.

    Raises:
        Ambiguity: something cannot be told from a file, and there is nobody to ask; an `InputError`.
        InputError: a file cannot be read, a choice is impossible, or the folder cannot be written.
    """
    paths = [Path(one) for one in ([files] if isinstance(files, str | Path) else files)]
    if not paths:
        raise InputError("no file to import. Name at least one.")
    if out is not None and into is not None:
        raise InputError("--out makes a new case and --into adds to one. Give one of them.")
    if role not in ROLES:
        raise InputError(f"--as {role}: no role of a recording; there are {' and '.join(ROLES)}.")
    if into is None and role == "predict":
        raise InputError("--as predict: a new case needs recordings to identify from; add others to it with --into.")
    quantities = _quantities(rig or {})
    if into is not None and quantities:
        raise InputError("--rig is for a new case; write what is known into rig.toml of the existing one.")
    options = Options(
        time, angle, position, rate, flip_angle, flip_position, keep_signs, linkage, quantities, tuple(where)
    )  # fmt: skip
    sources = [read_file(path) for path in paths]
    kept = {} if into is None else _kept_options(Path(into))
    understood, answered, chosen, like = [], [], [], []
    for group in [tuple(sources)] if join else [(one,) for one in sources]:
        used: list[str] = []
        one, answers, all_options = understood_with(as_before(kept, ask, used) if kept else ask, group, options)
        understood.append(one)
        answered.append(answers)
        chosen.append(all_options)
        like.append(tuple(used))
    command = repeated(command, [one.sources[0].path.name for one in understood], answered)
    if into is not None:
        folder = Path(into)
        recordings = _add(folder, understood, chosen, paths, role=role, command=command)
    else:
        folder = Path(out) if out is not None else Path(f"{paths[0].stem}_case")
        recordings = _write(folder, understood, chosen, paths, quantities, origin=origin, command=command, force=force)
    return Imported(
        folder,
        recordings,
        load_case(folder),
        dict(zip(recordings, answered, strict=True)),
        role,
        dict(zip(recordings, like, strict=True)),
        dict(zip(recordings, chosen, strict=True)),
    )


def _quantities(rig: Mapping[str, float]) -> dict[str, dict[str, float]]:
    made: dict[str, dict[str, float]] = {}
    for name, value in rig.items():
        table, _, key = name.partition(".")
        if table not in ("ball", "beam", "environment", "sensors") or key not in KEYS[table]:
            known = [f"{one}.{each}" for one in ("ball", "beam", "environment", "sensors") for each in KEYS[one]]
            raise InputError(f"--rig {name}: unknown.{did_you_mean(name, known)} Known are {', '.join(known)}.")
        made.setdefault(table, {})[key] = float(value)
    return made


def _write(
    folder: Path,
    understood: Sequence[Understood],
    options: Sequence[Options],
    inputs: Sequence[Path],
    rig: Mapping[str, Mapping[str, float]],
    *,
    origin: str | None,
    command: str,
    force: bool,
) -> dict[str, Understood]:
    recordings = {f"rec_{number:02d}.csv": one for number, one in enumerate(understood, start=1)}
    names = (*recordings, RIG_FILE, FILE)
    with all_or_nothing(folder, record=FILE, names=names, inputs=inputs, force=force) as scratch:
        for name, one in recordings.items():
            _put(scratch / name, recording_text(one))
        _put(scratch / RIG_FILE, rig_text(recordings, rig, origin=origin, command=command))
        _check(scratch, folder, understood)
        _put(scratch / FILE, _record(_new_entries(recordings, options), hashes_of(scratch), command))
    return recordings


def _add(
    folder: Path,
    understood: Sequence[Understood],
    options: Sequence[Options],
    inputs: Sequence[Path],
    *,
    role: Role,
    command: str,
) -> dict[str, Understood]:
    """Add recordings to an existing case; its own files stay, but for the list in its `rig.toml`."""
    file = folder / RIG_FILE
    if not folder.is_dir() or not file.is_file():
        raise InputError(f"{folder}: not a case to add to, as there is no {RIG_FILE}. Make a new one with --out.")
    settle(folder)
    listed = load_checked_case(folder).identify  # what is wrong with it is said before anything is added
    taken = [int(found[1]) for one in folder.iterdir() if (found := re.fullmatch(r"rec_(\d+)\.csv", one.name))]
    first = max(taken, default=0) + 1
    recordings = {f"rec_{number:02d}.csv": one for number, one in enumerate(understood, start=first)}
    comments = [line for name, one in recordings.items() for line in described(name, one)]
    text = with_recordings(str(file), read_source(file).text, tuple(recordings), comments, role=role, before=listed)
    before = _entries(folder)
    # The user's rig.toml is replaced by itself with a longer list; the other names are new.
    with all_or_nothing(folder, record=FILE, inputs=inputs, force=True) as scratch:
        for name, one in recordings.items():
            _put(scratch / name, recording_text(one))
        _put(scratch / RIG_FILE, text)
        hashes = dict(written(folder / FILE))
        hashes.pop(FILE, None)
        entries = [*before, *_new_entries(recordings, options)]
        _put(scratch / FILE, _record(entries, hashes | hashes_of(scratch), command))
    return recordings


def _entries(folder: Path) -> list[dict[str, Any]]:
    """Recordings that are in the record of a case already."""
    if not written(folder / FILE):
        return []
    content = json.loads((folder / FILE).read_text(encoding="utf-8"))
    return list(content.get("recordings", []))


def _new_entries(recordings: Mapping[str, Understood], options: Sequence[Options]) -> list[dict[str, Any]]:
    """How recordings were understood, with what was chosen for each."""
    return [
        {**recording_record(name, one), "options": _given(each)}
        for (name, one), each in zip(recordings.items(), options, strict=True)
    ]


def _given(options: Options) -> dict[str, Any]:
    """The options that are not as they are by themselves; those on the rig are in rig.toml."""
    given = {one.name: getattr(options, one.name) for one in fields(options) if one.name != "rig"}
    return {name: value for name, value in given.items() if value != getattr(Options(), name)}


def _kept_options(folder: Path) -> dict[str, Any]:
    """Options with which the last recording of a case was imported; none where it was not."""
    entries = _entries(folder)
    return dict(entries[-1].get("options", {})) if entries else {}


def _check(scratch: Path, folder: Path, understood: Sequence[Understood]) -> None:
    """Load what is about to be written.

    Raises:
        InputError: it is no case; the message names the files that it comes from.
    """
    try:
        load_checked_case(scratch)
    except InputError as error:
        sources = ", ".join(str(source.path) for one in understood for source in one.sources)
        raise InputError(f"{sources}: cannot become a case: {str(error).replace(str(scratch), str(folder))}") from None


def recording_record(name: str, one: Understood) -> dict[str, Any]:
    """How a recording was understood, as JSON content."""
    return {
        "name": name,
        "sources": [{"name": each.path.name, "sha256": each.sha256, "kind": each.kind} for each in one.sources],
        "columns": [asdict(line) for line in one.lines],
        "linkage": None if one.linkage is None else asdict(one.linkage),
        "negated": list(one.flipped),
        "sign": one.sign,
        "sign_checked": one.sign_checked,
        "rate": one.rate,
        "notes": list(one.notes),
        "angle_resolution_rad": one.angle_resolution,
        "position_resolution_m": one.position_resolution,
    }


def _record(entries: Sequence[Mapping[str, Any]], files: Mapping[str, str], command: str) -> str:
    return sealed_json({"schema": 1, "command": command, "recordings": entries, "files": files, "versions": versions()})


def _put(file: Path, text: str) -> None:
    file.write_text(text, encoding="utf-8", newline="\n")
