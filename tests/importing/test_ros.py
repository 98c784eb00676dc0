"""ROS bags of both versions, as folders and as files alone."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import Stores, get_typestore

from harness.errors import InputError
from harness.importing import Options, read_file, understand
from tests.importing import made

BEGIN = 1_700_000_000  # of the recording, in seconds since 1970
CHOSEN = Options(angle="/beam/joint_states/position[0]:rad", position="/ball/point.x:m")


def write_ros2(folder: Path, storage: StoragePlugin) -> Path:
    """Joint states at 100 Hz, and every third position as a stamped point, 4 ms late."""
    types = get_typestore(Stores.ROS2_HUMBLE)
    joints, point, header, stamp, xyz = (
        types.types[name]
        for name in (
            "sensor_msgs/msg/JointState", "geometry_msgs/msg/PointStamped", "std_msgs/msg/Header",
            "builtin_interfaces/msg/Time", "geometry_msgs/msg/Point",
        )
    )  # fmt: skip
    time, angle, position = made.truth()
    with Writer2(folder, version=9, storage_plugin=storage) as bag:
        beam = bag.add_connection("/beam/joint_states", joints.__msgtype__, typestore=types)
        ball = bag.add_connection("/ball", point.__msgtype__, typestore=types)
        for at, seconds in enumerate(time):
            now = BEGIN * 10**9 + round(seconds * 1e9)
            head = header(stamp=stamp(sec=now // 10**9, nanosec=now % 10**9), frame_id="beam")
            none = np.zeros(0)
            message = joints(header=head, name=["tilt"], position=np.array([angle[at]]), velocity=none, effort=none)
            bag.write(beam, now, types.serialize_cdr(message, joints.__msgtype__))
            if at % 3 == 0:
                late = now + 4_000_000
                head = header(stamp=stamp(sec=late // 10**9, nanosec=late % 10**9), frame_id="beam")
                message = point(header=head, point=xyz(x=float(position[at]), y=0.0, z=0.02))
                bag.write(ball, late, types.serialize_cdr(message, point.__msgtype__))
    return folder


@pytest.mark.parametrize("storage", list(StoragePlugin))
@pytest.mark.parametrize("alone", [False, True])
def test_topics_and_fields_of_ros_2(tmp_path: Path, storage: StoragePlugin, alone: bool) -> None:
    """Read chosen fields of two topics by their own stamps, from a bag's folder or from its file alone."""
    path = write_ros2(tmp_path / "bag", storage)
    path = next(one for one in path.iterdir() if one.suffix in (".mcap", ".db3")) if alone else path
    understood = understand([read_file(path)], CHOSEN)
    time, angle, position = made.truth()
    known = np.isfinite(understood.position)
    np.testing.assert_array_equal(understood.position[known], position[::3][: known.sum()])
    # Stamps since 1970 in doubles are 2.4e-7 s apart.
    np.testing.assert_allclose(understood.time[known], time[::3][: known.sum()] + 0.004, atol=5e-7)
    # The angle between stamps 10 ms apart: α̈ T²/8 with α̈ up to 0.25 rad/s² is 3e-6 rad, and its rounding 8e-5 rad.
    np.testing.assert_allclose(understood.angle, np.interp(understood.time, time, angle), atol=9e-5)


def test_a_bag_asks_for_the_topics(tmp_path: Path) -> None:
    """List topics and fields where their names do not say what they are."""
    path = write_ros2(tmp_path / "bag", StoragePlugin.MCAP)
    with pytest.raises(InputError, match=r"--angle '/beam/joint_states/position\[0\]'"):
        understand([read_file(path)], Options())


def test_ros_1_with_topics_that_say_what_they_are(tmp_path: Path) -> None:
    """Read messages with one number by the name of their topic, and the time of recording."""
    types = get_typestore(Stores.ROS1_NOETIC)
    number = types.types["std_msgs/msg/Float64"]
    time, angle, position = made.truth()
    path = tmp_path / "log.bag"
    with Writer1(path) as bag:
        topics = {
            name: bag.add_connection(name, number.__msgtype__, typestore=types)
            for name in ("/beam_angle", "/ball_position")
        }
        for t, *values in zip(time, angle, position, strict=True):
            for connection, value in zip(topics.values(), values, strict=True):
                stamp = BEGIN * 10**9 + round(t * 1e9)
                bag.write(connection, stamp, types.serialize_ros1(number(data=float(value)), number.__msgtype__))
    understood = understand([read_file(path)], Options())
    np.testing.assert_allclose(understood.time, time, atol=5e-7)
    np.testing.assert_array_equal(understood.angle, angle)
    np.testing.assert_array_equal(understood.position, position)


def test_a_damaged_bag_is_told(tmp_path: Path) -> None:
    """Say that a bag that was cut off cannot be read."""
    path = tmp_path / "cut.mcap"
    folder = write_ros2(tmp_path / "bag", StoragePlugin.MCAP)
    path.write_bytes((folder / "bag.mcap").read_bytes()[:3000])
    with pytest.raises(InputError, match="ROS bag"):
        read_file(path)
