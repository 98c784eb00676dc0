"""Which scene each engine runs, in words."""

from __future__ import annotations

from collections.abc import Iterable

from harness.report.palette import label_of
from harness.scene import Scene

BUILT_IN = "built-in scene, made for the rig"


def scenes_in_words(scene: Scene | None, engines: Iterable[str]) -> str:
    """`MuJoCo: crank.xml; PyBullet: built-in scene`; empty where every engine runs the built-in one.

    Args:
        scene: of the user's own.
        engines: names of those that run.
    """
    if scene is None:
        return ""
    files = {name: scene.file_of(name) for name in engines}
    if not any(files.values()):
        return ""
    return "; ".join(
        f"{label_of(name)}: " + (BUILT_IN if file is None else f"`{file.relative_to(scene.folder).as_posix()}`")
        for name, file in files.items()
    )
