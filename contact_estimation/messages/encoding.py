# Copyright 2026 contact_estimation authors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""Numbers to raw messages: the library writes a template once, afterwards only numbers change."""

from __future__ import annotations

from typing import Any, Sequence

from .codec import Codec
from .decoding import JOINT_STATE_TYPE, TRAJECTORY_TYPE, VECTOR3_TYPE, WRENCH_TYPE
from .fields import Field, FLOAT64, scalars, sequences, set_values, stamp_fields
from .layout import WritingLayout
from .locating import locate

STRING_TYPE = 'std_msgs/msg/String'
POINT_TYPE = 'trajectory_msgs/msg/JointTrajectoryPoint'

_NS_PER_S = 1_000_000_000


class Vector3StampedEncoder:
    """
    Writes geometry_msgs/msg/Vector3Stamped.

    Parameters
    ----------
    codec : Codec
        The message library.
    frame_id : str
        Frame of all messages.

    """

    def __init__(self, codec: Codec, frame_id: str) -> None:
        message = _stamped(codec, VECTOR3_TYPE, frame_id)
        numbers = scalars(('vector',), dict.fromkeys('xyz', FLOAT64))
        self._layout = _writing_layout(codec, message, VECTOR3_TYPE, numbers)

    def encode(self, stamp_ns: int, x: float, y: float, z: float) -> bytes:
        """Return the message with this stamp [ns] and vector."""
        return self._layout.write(*divmod(stamp_ns, _NS_PER_S), x, y, z)


class WrenchEncoder:
    """
    Writes geometry_msgs/msg/WrenchStamped without torque.

    Parameters
    ----------
    codec : Codec
        The message library.
    frame_id : str
        Frame of all messages.

    """

    def __init__(self, codec: Codec, frame_id: str) -> None:
        message = _stamped(codec, WRENCH_TYPE, frame_id)
        numbers = scalars(('wrench', 'force'), dict.fromkeys('xyz', FLOAT64))
        self._layout = _writing_layout(codec, message, WRENCH_TYPE, numbers)

    def encode(self, stamp_ns: int, fx: float, fy: float, fz: float) -> bytes:
        """Return the message with this stamp [ns] and force [N]."""
        return self._layout.write(*divmod(stamp_ns, _NS_PER_S), fx, fy, fz)


class JointStateEncoder:
    """
    Writes sensor_msgs/msg/JointState of one joint, without effort.

    Parameters
    ----------
    codec : Codec
        The message library.
    frame_id : str
        Frame of all messages.
    joint : str
        Name of the joint.
    with_velocity : bool
        If False, the velocity is left empty.

    """

    def __init__(self, codec: Codec, frame_id: str, joint: str, with_velocity: bool) -> None:
        message = _stamped(codec, JOINT_STATE_TYPE, frame_id)
        message.name = [joint]
        filled = ['position', 'velocity'] if with_velocity else ['position']
        for name in filled:
            setattr(message, name, codec.floats([0.0]))
        self._with_velocity = with_velocity
        self._layout = _writing_layout(
            codec, message, JOINT_STATE_TYPE, sequences(message, (), filled)
        )

    def encode(self, stamp_ns: int, position: float, velocity: float) -> bytes:
        """Return the message with this stamp [ns], position [m] and velocity [m/s]."""
        if self._with_velocity:
            return self._layout.write(*divmod(stamp_ns, _NS_PER_S), position, velocity)
        return self._layout.write(*divmod(stamp_ns, _NS_PER_S), position)


class TrajectoryEncoder:
    """
    Writes trajectory_msgs/msg/JointTrajectory with one point, due at its stamp, of one joint.

    Parameters
    ----------
    codec : Codec
        The message library.
    frame_id : str
        Frame of all messages.
    joint : str
        Name of the joint.

    """

    def __init__(self, codec: Codec, frame_id: str, joint: str) -> None:
        message = _stamped(codec, TRAJECTORY_TYPE, frame_id)
        message.joint_names = [joint]
        point = codec.new(POINT_TYPE)
        names = ('positions', 'velocities', 'accelerations', 'effort')
        for name in names:
            setattr(point, name, codec.floats([0.0]))
        message.points = [point]
        numbers = sequences(message, ('points', 0), names)
        self._layout = _writing_layout(codec, message, TRAJECTORY_TYPE, numbers)

    def encode(
        self,
        stamp_ns: int,
        position: float,
        velocity: float,
        acceleration: float,
        effort: float,
    ) -> bytes:
        """Return the message with this stamp [ns] and point [m], [m/s], [m/s^2], [N]."""
        return self._layout.write(
            *divmod(stamp_ns, _NS_PER_S), position, velocity, acceleration, effort
        )


class StringEncoder:
    """
    Writes std_msgs/msg/String; the library is fast enough for texts sent on change.

    Parameters
    ----------
    codec : Codec
        The message library.

    """

    def __init__(self, codec: Codec) -> None:
        self._codec = codec

    def encode(self, text: str) -> bytes:
        """Return the message with this text."""
        message = self._codec.new(STRING_TYPE)
        message.data = text
        return self._codec.serialize(message, STRING_TYPE)


def _stamped(codec: Codec, type_name: str, frame_id: str) -> Any:
    """Build a message with a frame."""
    message = codec.new(type_name)
    message.header.frame_id = frame_id
    return message


def _writing_layout(
    codec: Codec, message: Any, type_name: str, numbers: Sequence[Field]
) -> WritingLayout:
    """Learn where the stamp and these numbers of a template are."""
    fields = [*stamp_fields(), *numbers]
    marked = locate(codec, message, type_name, fields)
    if marked is None:
        raise RuntimeError(f'cannot locate the numbers of {type_name} in its serialisation')
    set_values(message, fields, [0 if f.kind != FLOAT64 else 0.0 for f in fields], codec)
    template = _without_slack(codec, codec.serialize(message, type_name), type_name)
    return WritingLayout(template, marked.slots)


def _without_slack(codec: Codec, data: bytes, type_name: str) -> bytes:
    """
    Cut what the library's buffer has behind the message.

    rmw_fastrtps sizes buffers for the worst alignment; strict readers refuse what is left over.

    """
    message = codec.deserialize(data, type_name)
    while len(data) > 8:
        try:
            if codec.deserialize(data[:-4], type_name) != message:
                return data
        except Exception:  # noqa: B902 - whatever the library raises for too few bytes
            return data
        data = data[:-4]
    return data
