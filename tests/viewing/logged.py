"""What a log for Rerun holds, read back by Rerun's own reader."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest

from analytic.motion import FloatArray


class Logged:
    """The entities of a log.

    Attributes:
        entities: paths of all of them.
    """

    def __init__(self, file: Path) -> None:
        """Read a log."""
        chunk = pytest.importorskip("rerun.chunk", reason="the extra rerun is not installed")
        self._chunks = [one for one in chunk.RrdReader(file).stream().to_chunks() if one.entity_path != "/__properties"]
        self.entities = {one.entity_path.removeprefix("/") for one in self._chunks}

    def over_time(self, path: str, component: str) -> tuple[FloatArray, list[list[object]]]:
        """Times, shape (n,) [s], and what a component holds at each."""
        batches = [one.to_record_batch() for one in self._chunks if one.entity_path == f"/{path}" and not one.is_static]
        table = pa.Table.from_batches([one.select(["time", component]) for one in batches])
        nanoseconds = np.array(table["time"].cast(pa.int64()).to_pylist(), dtype=float)
        values = table[component].to_pylist()
        order = np.argsort(nanoseconds, kind="stable")
        return 1e-9 * nanoseconds[order], [values[i] for i in order]

    def scalars(self, path: str) -> tuple[FloatArray, FloatArray]:
        """Times and values of a plotted quantity, shape (n,) each."""
        time, values = self.over_time(path, "Scalars:scalars")
        return time, np.array([one for (one,) in values], dtype=float)

    def ball(self, name: str) -> tuple[FloatArray, FloatArray]:
        """Times, and centres of a ball in the beam's frame [m], NaN where none is drawn; shape (n,) and (n, 3)."""
        time, values = self.over_time(f"world/beam/{name}", "Ellipsoids3D:centers")
        return time, np.array([one[0] if one else (np.nan,) * 3 for one in values], dtype=float)

    def beam(self) -> tuple[FloatArray, FloatArray]:
        """Times, and angles about +y by which the beam is turned, shape (n,) each [rad]."""
        time, values = self.over_time("world/beam", "Transform3D:quaternion")
        quaternions = np.array([one for (one,) in values], dtype=float)
        assert not quaternions[:, [0, 2]].any()
        return time, 2.0 * np.arctan2(quaternions[:, 1], quaternions[:, 3])

    def events(self) -> list[tuple[float, str, str]]:
        """Time [s], level and text of every line."""
        time, texts = self.over_time("events", "TextLog:text")
        _, levels = self.over_time("events", "TextLog:level")
        return [(at, level, text) for at, (level,), (text,) in zip(time.tolist(), levels, texts, strict=True)]

    def static(self, path: str, component: str) -> object:
        """What a component holds at all times."""
        for one in self._chunks:
            batch = one.to_record_batch()
            if one.entity_path == f"/{path}" and one.is_static and component in batch.schema.names:
                return batch[component].to_pylist()[0][0]
        raise AssertionError(f"{path} has no {component}")
