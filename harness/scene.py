"""A scene of the user's own: which files and names a case gives in the table `[scene]` of `rig.toml`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path


@dataclass(frozen=True)
class Scene:
    """Files that engines load in place of the built-in scene, and what is what in them.

    Attributes:
        folder: of the case; every file lies in it.
        mjcf: for MuJoCo; `None` for the built-in scene.
        urdf: for PyBullet; `None` for the built-in scene.
        ball_urdf: the ball beside `urdf`; `None` for a sphere with the quantities of `rig.toml`.
        beam_joint: name of the hinge that carries the beam.
        ball: name of the ball's body in `mjcf`.
        direction: +1 if α grows with the joint's angle, −1 if it falls.
        level_joint_angle: angle of the joint at which α is 0 [rad].
        driven_joint: name of the joint in `mjcf` that a motor turns and that moves the beam through a linkage; `None`
            if the beam's joint itself is driven.
        sha256: of every file, included ones and meshes too, by path within the folder.
        rolls_at: position at which the ball rolls in the recordings, where the scene is measured [m]; `None` for where
            the scene itself has the ball.
    """

    folder: Path
    mjcf: Path | None = None
    urdf: Path | None = None
    ball_urdf: Path | None = None
    beam_joint: str = "pivot"
    ball: str = "ball"
    direction: int = 1
    level_joint_angle: float = 0.0
    driven_joint: str | None = None
    sha256: Mapping[str, str] = field(default_factory=dict)
    rolls_at: float | None = None

    @property
    def files(self) -> tuple[Path, ...]:
        """Every file that belongs to it."""
        return tuple(self.folder / name for name in self.sha256)

    def file_of(self, engine: str) -> Path | None:
        """What this engine loads; `None` for its built-in scene."""
        return {"mujoco": self.mjcf, "pybullet": self.urdf}.get(engine)
