"""Checks whether a case's own scene can be driven with its recordings, and what differs from `rig.toml`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from harness.api.case import Case, case_of, input_files
from harness.api.outputs import sealed_json
from harness.api.progress import shown
from harness.api.writing import all_or_nothing
from harness.errors import InputError
from harness.progress import Progress
from harness.provenance import versions
from harness.recording import Case as CheckedCase
from harness.recording.case import RIG_FILE
from harness.recording.scene_files import scene_of
from harness.report.tables import Row, Summarised, Summary, Table, texts
from harness.scene import Scene
from harness.threads import one_blas_thread

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from analytic.rig import Rig
    from harness.engines.own_scene.checks import Check, Use
    from harness.engines.own_scene.engine import SceneEngine
    from harness.engines.own_scene.measuring import Measured

FILE = "scene_check.json"
_SUFFIXES = {".xml": "mjcf", ".mjcf": "mjcf", ".urdf": "urdf"}


@dataclass(frozen=True, repr=False)
class SceneCheck(Summarised):
    """What `check_scene` found.

    Attributes:
        path: of the case, or of the scene's file.
        checks: by engine, in the order in which they were made.
        measured: what was measured, by engine; an engine is missing whose scene could not be measured.
        files: SHA-256 of the scene's files and of rig.toml, by name.
        inputs: paths of what was read, which `save` never replaces.
    """

    path: Path
    checks: Mapping[str, tuple[Check, ...]]
    measured: Mapping[str, Measured] = field(default_factory=dict)
    files: Mapping[str, str] = field(default_factory=dict)
    inputs: tuple[Path, ...] = field(default=(), compare=False)

    @property
    def fit(self) -> bool:
        """Whether no check is an error."""
        return not any(one.status == "error" for checks in self.checks.values() for one in checks)

    @property
    def sentence(self) -> str:
        """The answer."""
        found = [one.status.value for checks in self.checks.values() for one in checks]
        counts = {kind: found.count(kind) for kind in ("error", "warning")}
        counted = ", ".join(f"{count} {kind}{'' if count == 1 else 's'}" for kind, count in counts.items())
        engines = " and ".join(self.checks)
        if self.fit:
            return f"The scene can be driven and compared in {engines} ({counted})."
        return f"The scene is not fit to be compared: {counted}."

    def summary(self) -> Summary:
        """The answer and every check."""
        tables = [
            Table(
                f"Scene of {engine}",
                texts("check", "status", "finding"),
                [Row((one.name, one.status.value, one.text), _CLASSES[one.status.value]) for one in checks],
            )
            for engine, checks in self.checks.items()
        ]
        return Summary(f"Scene of {self.path}", [self.sentence], tables)

    def plot(self) -> Figure:
        """The track as it was measured in each engine's scene: how far it carries the ball, and at which height.

        Raises:
            InputError: no scene could be measured.
        """
        from harness.report.plots import drawing

        if not self.measured:
            raise InputError(f"{self.path}: no scene could be measured, see checks")
        figure = drawing(2.4)
        axes = figure.subplots()
        for engine, seen in self.measured.items():
            ends = np.array(seen.track)
            height = 1e3 * (seen.height - np.tan(seen.slope) * (ends - seen.at))
            (line,) = axes.plot(ends, height, label=f"{engine}: centre of the ball")
            axes.plot(ends, height - 1e3 * seen.rolling_radius, color=line.get_color(), linestyle=":")
        axes.plot(0.0, 0.0, "k+", label="pivot axis")
        axes.set(xlabel="s [m]", ylabel="height [mm]")
        axes.legend()
        return figure

    def record(self) -> dict[str, Any]:
        """Content of scene_check.json, without its seal."""
        return {
            "schema": 1,
            "case": str(self.path),
            "fit": self.fit,
            "sentence": self.sentence,
            "engines": {
                engine: {
                    "checks": [asdict(one) for one in checks],
                    "measured": asdict(self.measured[engine]) if engine in self.measured else None,
                }
                for engine, checks in self.checks.items()
            },
            "inputs": {"hashes": dict(self.files), "versions": versions()},
        }

    def save(self, folder: str | Path, *, force: bool = False) -> Path:
        """Write scene_check.json.

        Args:
            folder: to write into.
            force: replace a file that this did not write, or that has been changed since, too.

        Returns:
            The folder.

        Raises:
            InputError: the folder cannot be written, or a file is in the way.
        """
        folder = Path(folder)
        with all_or_nothing(folder, record=FILE, names=(FILE,), inputs=self.inputs, force=force) as scratch:
            (scratch / FILE).write_text(sealed_json(self.record()), encoding="utf-8")
        return folder


_CLASSES = {"ok": "", "warning": "apart", "error": "failed"}


@one_blas_thread()
def check_scene(
    case: CheckedCase | str | Path,
    *,
    beam_joint: str | None = None,
    ball: str | None = None,
    direction: int | None = None,
    driven_joint: str | None = None,
    progress: bool | Progress = False,
) -> SceneCheck:
    """Check whether a scene of your own can be driven with the recorded angle, and what differs from the rig.

    Args:
        case: as of `load_case`, or its path, with a table `[scene]` in rig.toml; or the path of an MJCF or URDF alone,
            which is then measured and compared with nothing.
        beam_joint: hinge of the beam, in place of the table's; likewise the next three.
        ball: body of the ball in an MJCF.
        direction: 1 if α grows with the joint's angle, -1 if it falls.
        driven_joint: joint of the crank that turns the beam.
        progress: show a bar on stderr, or a function to be told.

    Raises:
        InputError: there is no scene, or a file of it cannot be used. What is wrong within a scene is a check.
    """
    names = {"beam_joint": beam_joint, "ball": ball, "direction": direction, "driven_joint": driven_joint}
    given = {name: value for name, value in names.items() if value is not None}
    if direction not in (None, 1, -1):
        raise InputError(f"direction: {direction} is neither 1 nor -1")
    with shown(progress) as tell:
        tell("reading the scene", share=0.0)
        path, scene, known = _scene_of(case, given)
        from harness.engines.catalogue import ENGINES, engine_of

        checks: dict[str, tuple[Check, ...]] = {}
        measured: dict[str, Measured] = {}
        engines = [name for name in ENGINES if scene.file_of(name) is not None]
        for number, name in enumerate(engines):
            tell(f"measuring the scene of {name}", share=(number + 0.5) / len(engines))
            engine: SceneEngine[Any] = engine_of(name, scene)  # type: ignore[assignment]
            checks[name] = tuple(_checks(engine, known))
            seen = engine.last_measured
            if seen is not None:
                measured[name] = seen
    hashes = dict(scene.sha256)
    if known is not None and known.sha256 is not None:
        hashes[RIG_FILE] = known.sha256
    return SceneCheck(path, checks, measured, hashes, scene.files if known is None else input_files(known))


def _scene_of(case: CheckedCase | str | Path, given: Mapping[str, Any]) -> tuple[Path, Scene, Case | None]:
    """Path, scene and case; no case if the scene's file alone was named."""
    if not isinstance(case, CheckedCase) and Path(case).suffix.lower() in _SUFFIXES:
        file = Path(case)
        if not file.is_file():
            raise InputError(f"{file}: there is no such file. Check the path.")
        kind = _SUFFIXES[file.suffix.lower()]
        table = {name: getattr(Scene, name) for name in ("beam_joint", "ball", "direction", "level_joint_angle")}
        table |= {"mjcf": None, "urdf": None, "ball_urdf": None, "driven_joint": None, kind: file.name}
        return file, scene_of(file.parent / RIG_FILE, **(table | dict(given))), None
    read = case_of(case)
    if read.scene is None:
        raise InputError(
            f'{read.path}: has no scene of its own. Write [scene] and mjcf = "my_beam.xml" into rig.toml, as in '
            "docs/scenes.md, or name the scene's file."
        )
    return read.path, replace(read.scene, **given), read


def _checks(engine: SceneEngine[Any], case: Case | None) -> Iterator[Check]:
    from analytic.rig import Rig
    from harness.engines.own_scene.checks import Check, Status, Use

    try:
        if case is None:
            yield from engine.checks(Rig(), Use(), compared=False)
        else:
            rig, complete = _rig(case)
            yield from engine.checks(rig, _use(case), compared=complete)
    except InputError as error:
        yield Check("can be driven", Status.ERROR, str(error).removeprefix(f"{engine.file}: "))


def _rig(case: Case) -> tuple[Rig, bool]:
    """The case's rig, and whether all of it is known; the paper's quantities where they are not."""
    from analytic.rig import Rig

    paper = {name: value for name, value in asdict(Rig()).items() if name not in ("level_angle",)}
    if case.rig.radius is not None and case.rig.rolling_radius is None:
        paper["rolling_radius"] = case.rig.radius
    if case.rig.rolling_radius is not None and case.rig.radius is None:
        paper["radius"] = case.rig.rolling_radius
    return case.rig.complete(**paper), not case.rig.unknown


def _use(case: Case) -> Use:
    """Where the ball rolls and how far the beam turns in the recordings."""
    from harness.engines.own_scene.checks import Use

    every = [case.recordings[name] for name in dict.fromkeys((*case.identify, *case.predict))]
    positions = np.concatenate([one.position[one.known & one.usable] for one in every])
    angles = np.concatenate([one.angle[np.isfinite(one.angle)] for one in every])
    return Use(
        (float(positions.min()), float(positions.max())) if positions.size else None,
        (float(angles.min()), float(angles.max())) if angles.size else None,
    )
