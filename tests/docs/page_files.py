"""The files that a page speaks of, for a reader who has them: cases, logs of instruments, specs, scenes."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Mapping
from pathlib import Path

from rosbags.rosbag2 import StoragePlugin

from harness.simulator import Experiment, Plant, write_case
from tests.comparison.made import COARSE, KNOWN, sensors, swing
from tests.comparison.made import write_case as write_made
from tests.docs.pages import ROOT
from tests.importing import made
from tests.importing.test_ros import write_ros2
from tests.own_scenes import FLAT, flat_track

EXAMPLES = ROOT / "docs" / "examples"
DIAGNOSIS = ROOT / "benchmarks" / "fuzz" / "seeds" / "diagnosis.json"
SCENE = '\n[scene]\nmjcf = "plank.xml"\nbeam_joint = "tilt"\nball = "marble"\ndirection = -1\n'
SPEC = 'cases = ["my_rig"]\nsources = ["mujoco", "cam"]\ntime_step = [4e-3, 2e-3]\n'
LISTED = '\n[recordings]\nidentify = ["rec_01.csv", "rec_02.csv"]\n'


def _case(folder: Path) -> None:
    """A case of two recordings of 3 s and a third that it does not list, with copies of that beside it."""
    used = sensors(COARSE)
    recordings = [swing(seed, Plant(), used, 3.0) for seed in (21, 22, 23)]
    case = write_made(folder / "my_rig", recordings, used, known=KNOWN).folder
    with (case / "rig.toml").open("a", encoding="utf-8") as file:
        file.write(LISTED)
    for name in ("swing.csv", "swing_07.csv"):
        shutil.copy(case / "rec_03.csv", folder / name)


def _diagnosed(folder: Path) -> None:
    """The same with a diagnosis of it."""
    _case(folder)
    (folder / "reports" / "my_rig").mkdir(parents=True)
    shutil.copy(DIAGNOSIS, folder / "reports" / "my_rig")


def _examples(folder: Path) -> None:
    """The repository's own examples where README's reader has them."""
    shutil.copytree(EXAMPLES, folder / "docs" / "examples")


def _magnet(folder: Path) -> None:
    """The file that the page shows."""
    shutil.copy(EXAMPLES / "magnet.py", folder)


def _readme(folder: Path) -> None:
    """What README's commands name."""
    _case(folder)
    _examples(folder)
    _magnet(folder)
    made.vectors(folder / "log.mat")


def _logs(folder: Path) -> None:
    """Logs of every kind, and the halves that the TDS series writes."""
    for name, (write, _) in made.FILES.items():
        write(folder / name)
    for channel in (1, 2):
        made.tektronix_channel(folder / f"F0001CH{channel}.CSV", channel)
    write_ros2(folder / "bag", StoragePlugin.SQLITE3)


def _scene(folder: Path) -> None:
    """A rig with a scene of its own, and that scene as a file alone."""
    write_case(folder / "my_rig", Experiment(rig=FLAT, duration=3.0, identify=1, predict=0))
    text = flat_track().replace('"bearing"', '"tilt"')
    for path in (folder / "my_rig" / "plank.xml", folder / "my_beam.xml"):
        path.write_text(text, encoding="utf-8")
    with (folder / "my_rig" / "rig.toml").open("a", encoding="utf-8") as file:
        file.write(SCENE)


def _spec(folder: Path) -> None:
    """A sweep of four runs."""
    _case(folder)
    (folder / "sweep.toml").write_text(SPEC, encoding="utf-8")


def _slipping(folder: Path) -> None:
    """A ball that slips on a beam that is not level: there is something to tune."""
    hidden = {"contact_slip": {"friction_coefficient": 0.0085}, "level_error": {"angle": 0.002}}
    sampled = {"duration": 9.0, "rate": 25.0, "counts": 4096, "seed": 501}
    write_case(folder / "my_rig", Experiment(hidden=hidden, identify=1, predict=0, **sampled))


def _gallery(folder: Path) -> None:
    """The spec of its sweep."""
    shutil.copy(EXAMPLES / "sweep.toml", folder)


def _diagnosis(folder: Path) -> None:
    """A case and the file of an effect."""
    _case(folder)
    _magnet(folder)


FILES: Mapping[str, Callable[[Path], None]] = {
    "README.md": _readme,
    "check.md": _case,
    "diagnosis.md": _diagnosis,
    "export.md": _diagnosed,
    "gallery.md": _gallery,
    "import.md": _logs,
    "own_effect.md": _magnet,
    "scenes.md": _scene,
    "sweeps.md": _spec,
    "tolerances.md": _case,
    "tuning.md": _slipping,
    "view.md": _diagnosed,
}
"""Who writes the files of a page; a page that is not named begins in an empty folder."""
