"""A case: a folder with `rig.toml` and recordings, or one recording of the paper's rig."""

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from analytic.naming import did_you_mean
from analytic.rig import Rig
from harness.errors import InputError
from harness.recording.end_stops import common_stops
from harness.recording.findings import DataFinding, quoted
from harness.recording.known_rig import Declared, KnownRig, Sensors, known_rig_of
from harness.recording.own_files import OWN_FILES, is_own
from harness.recording.recording import Recording, load_recording
from harness.recording.rig_file import RigFile, read_rig_file
from harness.recording.slow_angle import slow_angle_findings
from harness.scene import Scene

_DATA = Path(__file__).parents[1] / "data"
BUNDLED = _DATA / "paper_protocol"
"""The default case: simulated, the paper's protocol."""
MEASURED = _DATA / "open_ball_beam"
"""A measured recording of another rig, under the MIT licence (LICENSE in its folder)."""
BUILT_IN = {path.name: path for path in (BUNDLED, MEASURED)}
"""Cases that ship with the package, by the names that stand for their paths."""
RIG_FILE = "rig.toml"
EXAMPLE = '[recordings] identify = ["rec_01.csv"]'
NO_RIG_FILE = (
    "no rig.toml; the rig of the paper is assumed. Add a rig.toml to describe another rig, its sensors and effects."
)
RIG_FILE_NOT_USED = "rig.toml beside it is ignored and the rig of the paper is assumed. Pass the folder to use it."


@dataclass(frozen=True, eq=False)
class Case:
    """The user's input, validated.

    Attributes:
        path: the folder or file passed by the user.
        origin: free text on where the data come from (`simulated …`); `None` if the rig file has none.
        rig: what is known of the rig.
        sensors: what is known of the sensors.
        declared: declared effects, known to be present.
        recordings: by name as listed; recordings for identification come first. Parts of a recording that a push or
            an end stop parts are recordings of their own, `rec_01.csv (part 2)`, the longest under the name listed.
        identify: names of the recordings for identification.
        predict: names of the recordings to predict.
        findings: warnings and notes on the rig file and on all recordings.
        sha256: of the rig file; `None` if there is none.
        scene: the user's own scene, which engines run in place of the built-in one; `None` without one.
        rig_from: names of the files that give quantities of `rig` in place of the rig file, by quantity.
    """

    path: Path
    origin: str | None
    rig: KnownRig
    sensors: Sensors
    declared: tuple[Declared, ...]
    recordings: dict[str, Recording]
    identify: tuple[str, ...]
    predict: tuple[str, ...]
    findings: tuple[DataFinding, ...]
    sha256: str | None
    scene: Scene | None = None
    rig_from: Mapping[str, str] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """For headings and folders."""
        return case_name(self.path)

    def findings_on(self, names: Collection[str]) -> tuple[DataFinding, ...]:
        """Findings on these recordings, and on the rig file or the case as a whole."""
        others = [name for name in self.recordings if name not in names]
        return tuple(one for one in self.findings if not any(f"{one.where},".startswith(f"{name},") for name in others))

    @property
    def simulated(self) -> bool:
        """Whether the recordings are simulated, not measured, according to their origin."""
        return (self.origin or "").lower().startswith("simulated")


def case_name(path: Path) -> str:
    """Name of the case at `path`: of its folder, or of its recording."""
    path = path.resolve()
    return path.parent.name if path.name == RIG_FILE else path.stem


def case_path(path: str | Path) -> Path:
    """The path of a case; of a built-in one, if this is its name and no file or folder with recordings in it."""
    path = Path(path)
    built_in = BUILT_IN.get(str(path))
    if built_in is None or (_holds(path.exists) and not _holds(lambda: _without_recordings(path))):
        return path
    return built_in


def typed_path(path: Path) -> Path:
    """What a user types for a case: the name of a built-in one, the path of any other."""
    return next((Path(name) for name, one in BUILT_IN.items() if one == path), path)


def _without_recordings(folder: Path) -> bool:
    """Whether there is neither a `rig.toml` nor a recording in a folder, as in one of results."""
    return not (folder / RIG_FILE).exists() and all(is_own(entry) for entry in _csv_files(folder))


def _holds(question: Callable[[], bool]) -> bool:
    """The answer to a question about a path; no where there can be none of this name, such as one that is too long."""
    try:
        return question()
    except OSError:
        return False


def load_case(path: str | Path) -> Case:
    """Reads a case: a folder, its `rig.toml`, a single CSV recording, or a built-in case by its name.

    Raises:
        InputError: any part of the case is invalid.
    """
    path = case_path(path)
    if not _holds(path.exists):
        names = [entry.name for entry in path.parent.iterdir()] if _holds(path.parent.is_dir) else []
        names += BUILT_IN if len(path.parts) == 1 else []
        hint = did_you_mean(path.name, names) or " Check the path."
        raise InputError(f"{path}: there is no such file or folder.{hint}")
    if path.is_dir():
        if (path / RIG_FILE).exists():
            return _with_rig_file(path, path / RIG_FILE)
        return _with_paper_rig(path, [path / name for name in _csv_names(path)])
    if path.suffix.lower() == ".toml":
        return _with_rig_file(path, path)
    return _with_paper_rig(path, [path])


def _with_rig_file(path: Path, file: Path) -> Case:
    content = read_rig_file(file)
    folder = file.parent
    identify, predict, findings = _recording_lists(file, content)
    files = {name: folder / name for name in (*identify, *predict)}
    try:
        recordings = _loaded(files, content.rig, content.sensors)
    except InputError as error:
        if content.identify is not None:
            raise
        raise InputError(f"{error} If it is not a recording, list the recordings in {file}: {EXAMPLE}.") from None
    findings += [*_duplicates(recordings, (*identify, *predict), file.name)]
    findings += _of_recordings(recordings, identify, content.sensors)
    recordings, identify = _with_parts(_of_one_sensor(recordings), identify)
    return Case(
        path=path,
        origin=content.origin,
        rig=content.rig,
        sensors=content.sensors,
        declared=content.declared,
        recordings=recordings,
        identify=identify,
        predict=predict,
        findings=(*content.findings, *findings),
        sha256=content.sha256,
        scene=None if content.scene is None else replace(content.scene, rolls_at=_rolls_at(recordings)),
    )


def _rolls_at(recordings: dict[str, Recording]) -> float | None:
    """Median of all known positions [m]."""
    known = [one.position[one.known] for one in recordings.values()]
    return float(np.median(np.concatenate(known))) if any(map(len, known)) else None


def _with_paper_rig(path: Path, files: list[Path]) -> Case:
    rig = known_rig_of(Rig())
    recordings = _loaded({file.name: file for file in files}, rig, Sensors())
    where = path.resolve().name  # "." has no name of its own
    if path.is_file() and (path.parent / RIG_FILE).exists():
        about_rig = DataFinding("warning", where, RIG_FILE_NOT_USED, "rig-file-ignored")
    else:
        about_rig = DataFinding("warning" if path.is_dir() else "note", where, NO_RIG_FILE, "no-rig-file")
    own = _own_files(path) if path.is_dir() else []
    names = tuple(recordings)
    findings = (about_rig, *own, *_duplicates(recordings, names, where), *_of_recordings(recordings, names, Sensors()))
    recordings, identify = _with_parts(_of_one_sensor(recordings), names)
    return Case(
        path=path,
        origin=None,
        rig=rig,
        sensors=Sensors(
            angle_resolution=_coarsest(recordings, "angle"), position_resolution=_coarsest(recordings, "position")
        ),
        declared=(),
        recordings=recordings,
        identify=identify,
        predict=(),
        findings=findings,
        sha256=None,
    )


def _loaded(files: Mapping[str, Path], rig: KnownRig, sensors: Sensors) -> dict[str, Recording]:
    """The recordings by name; where others tell of an end stop that one does not, it is looked for there too.

    Raises:
        InputError: a file is invalid.
    """
    found = {name: load_recording(file, rig=rig, sensors=sensors) for name, file in files.items()}
    common = common_stops([one.stops for one in found.values()])
    again = [name for name, one in found.items() if common.adds_to(one.stops)]
    return found | {name: load_recording(files[name], rig=rig, sensors=sensors, stops=common) for name in again}


def _with_parts(
    recordings: dict[str, Recording], identify: tuple[str, ...]
) -> tuple[dict[str, Recording], tuple[str, ...]]:
    """The same, with every part of a recording to identify from as a recording of its own, behind the longest one."""
    named: dict[str, Recording] = {}
    for name in identify:
        one = recordings[name]
        named[name] = one
        named |= {name + part.name.removeprefix(one.name): part for part in one.further}
    return named | recordings, tuple(named)


def _of_one_sensor(recordings: dict[str, Recording]) -> dict[str, Recording]:
    """The same; where too few different readings tell a step, as on a beam that stands still, it is that of the others.

    They share one sensor, and the coarsest step is too fine for none.
    """
    angle_step, position_step = (_coarsest(recordings, channel) for channel in ("angle", "position"))

    def completed(one: Recording) -> Recording:
        return replace(
            one,
            angle_step=one.angle_step or angle_step,
            position_step=one.position_step or position_step,
            further=tuple(map(completed, one.further)),
        )

    return {name: completed(one) for name, one in recordings.items()}


def _coarsest(recordings: dict[str, Recording], channel: str) -> float | None:
    """Largest step of a channel, "angle" [rad] or "position" [m], over the recordings, which share one sensor."""
    seen = (getattr(recording, f"{channel}_step") for recording in recordings.values())
    return max((step for step in seen if step is not None), default=None)


def _recording_lists(file: Path, content: RigFile) -> tuple[tuple[str, ...], tuple[str, ...], list[DataFinding]]:
    folder = file.parent
    if content.identify is None or content.predict is None:
        names = tuple(_csv_names(folder))
        text = f"no table [recordings]; all recordings of the folder are used for identification: {', '.join(names)}."
        return names, (), [DataFinding("note", file.name, text, "all-recordings"), *_own_files(folder)]
    listed = (*content.identify, *content.predict)
    if not listed:
        raise InputError(f"{file}: [recordings] is empty. Write identify = [{quoted(_csv_names(folder))}].")
    missing = [name for name in listed if not _holds((folder / name).is_file)]
    if missing:
        _refuse_dead_link(file, folder / missing[0])
        present = _csv_names(folder)
        hint = did_you_mean(missing[0], present)
        raise InputError(
            f"{file}: [recordings] lists {quoted(missing)}, not found in {folder}.{hint} "
            f"The folder contains {quoted(present)}. Correct the list or add the file."
        )
    for key, names in (("identify", content.identify), ("predict", content.predict)):
        twice = sorted({name for name in names if names.count(name) > 1})
        if twice:
            raise InputError(f"{file}: [recordings] {key} lists {quoted(twice)} more than once. List each once.")
    return content.identify, content.predict, []


def _refuse_dead_link(file: Path, path: Path) -> None:
    if _holds(path.is_symlink):
        raise InputError(
            f"{file}: [recordings] lists '{path.name}', a symbolic link to {path.readlink()}, which does not exist. "
            "Correct the link, or put the recording there."
        )


def _csv_names(folder: Path) -> list[str]:
    names = sorted(entry.name for entry in _csv_files(folder) if not is_own(entry))
    if not names:
        raise InputError(f"{folder}: contains no CSV recording. Put recordings there, or pass another folder.")
    return names


def _csv_files(folder: Path) -> list[Path]:
    return [entry for entry in folder.iterdir() if entry.suffix.lower() == ".csv" and entry.is_file()]


def _own_files(folder: Path) -> list[DataFinding]:
    """A note on files that the harness wrote, which are not taken for recordings."""
    own = sorted(entry.name for entry in _csv_files(folder) if is_own(entry))
    text = f"{quoted(own)}: written by the harness, not recordings; left out. List them in rig.toml if they are meant."
    return [DataFinding("note", folder.resolve().name, text, OWN_FILES)] if own else []


def _duplicates(recordings: dict[str, Recording], listed: tuple[str, ...], where: str) -> list[DataFinding]:
    first: dict[str, str] = {}
    findings = []
    for name in listed:
        sha256 = recordings[name].sha256
        if sha256 in first:
            same = "is listed twice" if first[sha256] == name else f"and {first[sha256]} are the same file"
            text = f"{name} {same}; use each recording once, and do not predict a recording used for identification."
            findings.append(DataFinding("warning", where, text, "duplicate"))
        first.setdefault(sha256, name)
    return findings


def _no_positions(recording: Recording) -> str:
    text = "contains no ball positions; it cannot be used for identification."
    unused = [one.text[:1].upper() + one.text[1:] for one in recording.findings if one.code == "unused-columns"]
    return " ".join([text, *unused])


def _of_recordings(recordings: dict[str, Recording], identify: tuple[str, ...], sensors: Sensors) -> list[DataFinding]:
    """Recordings without positions, then findings of each, located by the name under which it is listed."""
    without = [name for name in identify if not recordings[name].known.any()]
    return [
        *(DataFinding("warning", name, _no_positions(recordings[name]), "no-positions") for name in without),
        *slow_angle_findings(recordings, sensors),
        *(
            replace(finding, where=name + finding.where.removeprefix(recording.name))
            for name, recording in recordings.items()
            for finding in recording.findings
        ),
    ]
