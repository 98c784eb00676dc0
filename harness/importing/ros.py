"""ROS 1 bags, ROS 2 bags (folder, .db3, .mcap): every number in a message is a signal, every topic a group."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from harness.errors import INTERRUPTS, InputError
from harness.importing.bytes import sha256_of
from harness.importing.signals import Group, Signal, SourceFile, group_of

_MAGIC = (b"#ROSBAG V", b"SQLite format 3\x00", b"\x89MCAP0\r\n")
METADATA = "metadata.yaml"
MOST_NUMBERS = 64  # of a message; images and scans have more
DEEPEST = 8


def is_bag(path: Path) -> bool:
    """Whether this is a bag: by its first bytes, or a folder with a bag's description."""
    try:
        if path.is_dir():
            return (path / METADATA).is_file()
        if not path.is_file():
            return False
        with path.open("rb") as stream:
            return stream.read(16).startswith(_MAGIC)
    except OSError:
        return False


def read_bag(path: Path) -> SourceFile:
    """Reads all topics whose messages hold numbers.

    The time of a message is that in its header, where it has one, else when it was recorded.

    Raises:
        InputError: rosbags is missing, the bag is damaged, or holds no numbers.
    """
    try:
        from rosbags.typesys import Stores, get_typestore
    except ImportError:
        raise InputError(
            f"{path}: ROS bags need the package rosbags. Install it: pip install 'ball-beam-harness[ros]'."
        ) from None
    try:
        topics: dict[str, list[tuple[float, dict[str, float]]]] = {}
        for topic, stamp, message in _messages(path, get_typestore(Stores.LATEST)):
            fields = dict(itertools.islice(_numbers("", message, 0), MOST_NUMBERS + 1))
            if fields and len(fields) <= MOST_NUMBERS:
                topics.setdefault(topic, []).append((stamp, fields))
    except (InputError, *INTERRUPTS):
        raise
    except Exception as error:  # readers raise whatever a damaged file leads to
        raise InputError(f"{path}: cannot be read as a ROS bag ({type(error).__name__}: {error}).") from None
    groups = tuple(_group(topic, content) for topic, content in sorted(topics.items()) if len(content) >= 3)
    if not groups:
        raise InputError(f"{path}: no topic in it has numbers to read. Record the topics of angle and position.")
    file = path / METADATA if path.is_dir() else path
    return SourceFile(path, sha256_of(file), "ROS bag", groups)


def _messages(path: Path, types: Any) -> Iterator[tuple[str, float, Any]]:
    """Topic, time of recording [s] and content of every message."""
    from rosbags.highlevel import AnyReader

    if path.is_dir() or path.suffix.lower() == ".bag":
        with AnyReader([path], default_typestore=types) as reader:
            for connection, stamp, raw in reader.messages():
                yield connection.topic, stamp * 1e-9, reader.deserialize(raw, connection.msgtype)
        return
    yield from _single_file(path, types)


def _single_file(path: Path, types: Any) -> Iterator[tuple[str, float, Any]]:
    """Messages of a file that lies without the folder and the description of its bag."""
    from rosbags.rosbag2.storage_mcap import McapReader
    from rosbags.rosbag2.storage_sqlite3 import Sqlite3Reader
    from rosbags.typesys import get_types_from_msg

    with path.open("rb") as stream:
        storage = (McapReader if stream.read(8).startswith(_MAGIC[2]) else Sqlite3Reader)(path)
    storage.open()
    try:
        for connection in storage.connections:
            if connection.msgdef.data and connection.msgdef.format.name == "MSG":
                new = get_types_from_msg(connection.msgdef.data, connection.msgtype)
                types.register({name: one for name, one in new.items() if name not in types.fielddefs})
        for connection, stamp, raw in storage.messages(storage.connections, None, None):
            yield connection.topic, stamp * 1e-9, types.deserialize_cdr(raw, connection.msgtype)
    finally:
        storage.close()


def _numbers(name: str, node: Any, depth: int) -> Iterator[tuple[str, float]]:
    """The numbers in a message by the name of their field."""
    if isinstance(node, bool | int | float | np.number):
        yield name or "data", float(node)
    elif isinstance(node, np.ndarray | list | tuple):
        for at, value in enumerate(node[: MOST_NUMBERS + 1]):
            yield from _numbers(f"{name}[{at}]", value, depth + 1)
    elif hasattr(node, "__dataclass_fields__") and depth < DEEPEST:
        if {"sec", "nanosec"} <= set(node.__dataclass_fields__):
            yield name, float(node.sec) + 1e-9 * float(node.nanosec)
            return
        for field in node.__dataclass_fields__:
            if not field.startswith("__"):
                yield from _numbers(f"{name}.{field}" if name else field, getattr(node, field), depth + 1)


def _group(topic: str, content: list[tuple[float, dict[str, float]]]) -> Group:
    names = list(dict.fromkeys(name for _, fields in content for name in fields))
    columns = {name: np.array([fields.get(name, np.nan) for _, fields in content]) for name in names}
    recorded = np.array([stamp for stamp, _ in content])
    header = columns.pop("header.stamp", None)
    columns.pop("header.seq", None)
    stamps, source = (
        (header, "the header's stamps")
        if header is not None and np.any(header > 0.0)
        else (recorded, "when it was recorded")
    )
    signals = [Signal("stamp", stamps, "s", source), *(Signal(name, values) for name, values in columns.items())]
    return group_of(topic, signals, time="stamp")
