"""A case: a folder with `rig.toml` and recordings, or one recording of the paper's rig."""

from __future__ import annotations

import difflib
from dataclasses import dataclass, replace
from pathlib import Path

from analytic.rig import Rig
from harness.errors import InputError
from harness.recording.findings import Finding, quoted
from harness.recording.known_rig import Declared, KnownRig, Sensors, known_rig_of
from harness.recording.recording import Recording, load_recording
from harness.recording.resolution import inferred_resolution
from harness.recording.rig_file import RigFile, read_rig_file

BUNDLED = Path(__file__).parents[1] / "data" / "paper_protocol"
"""The case that ships with the package: simulated, the paper's protocol."""
RIG_FILE = "rig.toml"
EXAMPLE = '[recordings] identify = ["rec_01.csv"]'
PAPER_TEXT = "no rig.toml; the rig of the paper is assumed. Write one to declare another rig, its sensors and effects."


BESIDE_TEXT = "the rig.toml beside it is not used, the rig of the paper is assumed. Name the folder to use it."


@dataclass(frozen=True, eq=False)
class Case:
    """What a user hands in, checked.

    Attributes:
        path: the folder or file as given.
        origin: where the data come from, in words (`simulated …`); `None` when the rig file does not say.
        rig: what is known of the rig.
        sensors: what is known of the sensors.
        declared: effects known to act.
        recordings: by name as listed; those to identify from first.
        identify: names of the recordings to identify from.
        predict: names of the recordings to predict.
        findings: of the rig file and of all recordings.
        sha256: of the rig file; `None` when there is none.
    """

    path: Path
    origin: str | None
    rig: KnownRig
    sensors: Sensors
    declared: tuple[Declared, ...]
    recordings: dict[str, Recording]
    identify: tuple[str, ...]
    predict: tuple[str, ...]
    findings: tuple[Finding, ...]
    sha256: str | None


def load_case(path: str | Path) -> Case:
    """Reads a case: a folder, its `rig.toml`, or a single CSV recording.

    Raises:
        InputError: anything in it cannot be used; nothing is returned in part.
    """
    path = Path(path)
    if not path.exists():
        names = [entry.name for entry in path.parent.iterdir()] if path.parent.is_dir() else []
        close = difflib.get_close_matches(path.name, names, 1)
        hint = f"Did you mean {path.parent / close[0]}?" if close else "Check the path."
        raise InputError(f"{path}: there is no such file or folder. {hint}")
    if path.is_dir():
        if (path / RIG_FILE).exists():
            return _with_rig_file(path, path / RIG_FILE)
        return _of_paper(path, [path / name for name in _csv_names(path)])
    if path.suffix.lower() == ".toml":
        return _with_rig_file(path, path)
    return _of_paper(path, [path])


def _with_rig_file(path: Path, file: Path) -> Case:
    content = read_rig_file(file)
    folder = file.parent
    identify, predict, findings = _lists(file, content)
    recordings: dict[str, Recording] = {}
    for name in dict.fromkeys((*identify, *predict)):
        try:
            recordings[name] = load_recording(folder / name, rig=content.rig, sensors=content.sensors)
        except InputError as error:
            if content.identify is not None:
                raise
            raise InputError(f"{error} If it is no recording, list those that are in {file}: {EXAMPLE}.") from None
    findings += [*_same_twice(recordings, (*identify, *predict), file.name), *_without_positions(recordings, identify)]
    return Case(
        path=path,
        origin=content.origin,
        rig=content.rig,
        sensors=content.sensors,
        declared=content.declared,
        recordings=recordings,
        identify=identify,
        predict=predict,
        findings=(*content.findings, *findings, *_all_findings(recordings)),
        sha256=content.sha256,
    )


def _of_paper(path: Path, files: list[Path]) -> Case:
    rig = known_rig_of(Rig())
    recordings = {file.name: load_recording(file, rig=rig) for file in files}
    where = path.resolve().name  # "." has no name of its own
    beside = path.is_file() and (path.parent / RIG_FILE).exists()
    findings = [
        Finding("warning", where, BESIDE_TEXT)
        if beside
        else Finding("warning" if path.is_dir() else "note", where, PAPER_TEXT),
        *_same_twice(recordings, tuple(recordings), where),
    ]
    identify = tuple(recordings)
    sensors = Sensors(
        angle_resolution=_coarsest(recordings, "angle"), position_resolution=_coarsest(recordings, "position")
    )
    return Case(
        path=path,
        origin=None,
        rig=rig,
        sensors=sensors,
        declared=(),
        recordings=recordings,
        identify=identify,
        predict=(),
        findings=(*findings, *_without_positions(recordings, identify), *_all_findings(recordings)),
        sha256=None,
    )


def _coarsest(recordings: dict[str, Recording], channel: str) -> float | None:
    """One sensor made all recordings: the coarsest step seen is safe for each."""
    seen = (inferred_resolution(getattr(recording, channel)) for recording in recordings.values())
    return max((step for step in seen if step is not None), default=None)


def _lists(file: Path, content: RigFile) -> tuple[tuple[str, ...], tuple[str, ...], list[Finding]]:
    folder = file.parent
    if content.identify is None or content.predict is None:
        names = tuple(_csv_names(folder))
        text = f"no table [recordings]; all recordings of the folder are used to identify: {', '.join(names)}."
        return names, (), [Finding("note", file.name, text)]
    listed = (*content.identify, *content.predict)
    if not listed:
        raise InputError(f"{file}: [recordings] lists no recording. Write identify = [{quoted(_csv_names(folder))}].")
    missing = [name for name in listed if not (folder / name).is_file()]
    if missing:
        present = _csv_names(folder)
        close = difflib.get_close_matches(missing[0], present, 1)
        hint = f" Did you mean '{close[0]}'?" if close else ""
        raise InputError(
            f"{file}: [recordings] lists {quoted(missing)}, which {folder} does not hold.{hint} "
            f"It holds {quoted(present)}. Correct the list or add the file."
        )
    for key, names in (("identify", content.identify), ("predict", content.predict)):
        twice = sorted({name for name in names if names.count(name) > 1})
        if twice:
            raise InputError(f"{file}: [recordings] {key} lists {quoted(twice)} more than once. List each once.")
    return content.identify, content.predict, []


def _csv_names(folder: Path) -> list[str]:
    names = sorted(entry.name for entry in folder.iterdir() if entry.suffix.lower() == ".csv" and entry.is_file())
    if not names:
        raise InputError(f"{folder}: holds no CSV recording. Put recordings there, or name another folder.")
    return names


def _same_twice(recordings: dict[str, Recording], listed: tuple[str, ...], where: str) -> list[Finding]:
    first: dict[str, str] = {}
    findings = []
    for name in listed:
        sha256 = recordings[name].sha256
        if sha256 in first:
            same = "is listed twice" if first[sha256] == name else f"and {first[sha256]} are the same file"
            text = f"{name} {same}; count a recording once and do not predict what was identified from."
            findings.append(Finding("warning", where, text))
        first.setdefault(sha256, name)
    return findings


def _without_positions(recordings: dict[str, Recording], identify: tuple[str, ...]) -> list[Finding]:
    return [
        Finding("warning", recordings[name].name, "holds no ball positions: nothing can be identified from it.")
        for name in identify
        if not recordings[name].known.any()
    ]


def _all_findings(recordings: dict[str, Recording]) -> list[Finding]:
    """Of every recording, the place given by the name it is listed under."""
    return [
        replace(finding, where=name + finding.where.removeprefix(recording.name))
        for name, recording in recordings.items()
        for finding in recording.findings
    ]
