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

"""Several joints of one joint state."""

from __future__ import annotations

from typing import Any, Sequence

from .codec import Codec
from .decoding import JointStateDecoder


class SeveralJointsDecoder:
    """
    Reads several joints of sensor_msgs/msg/JointState, which must stand in one message.

    Parameters
    ----------
    codec : Codec
        The message library.
    joints : sequence of str
        Names of the joints, at least one.

    """

    def __init__(self, codec: Codec, joints: Sequence[str]) -> None:
        self._decoders = [JointStateDecoder(codec, joint) for joint in joints]

    def decode(self, raw: bytes) -> tuple[int, tuple[float, ...], tuple[float, ...]]:
        """
        Read one message.

        Parameters
        ----------
        raw : bytes
            CDR with its encapsulation header.

        Returns
        -------
        stamp_ns, positions, velocities : int, tuple of float, tuple of float
            Stamp [ns], positions [m] and velocities [m/s] in the order of the joints, NaN for
            velocities that the message does not have.

        Raises
        ------
        MessageError
            As `JointStateDecoder.decode`, for the first joint that is not there.

        """
        stamps, positions, velocities = zip(*[d.decode(raw) for d in self._decoders])
        return stamps[0], positions, velocities

    def decode_many(self, raws: Sequence[bytes]) -> tuple[Any, Any, Any] | None:
        """
        Read many messages at once.

        Parameters
        ----------
        raws : sequence of bytes
            Messages, at least one.

        Returns
        -------
        stamps_ns, positions, velocities : ndarray, tuple of ndarray, tuple of ndarray, or None
            As of `decode`, one array of shape (N,) a joint; None where they must be read one by
            one.

        """
        readings = [decoder.decode_many(raws) for decoder in self._decoders]
        columns = [reading for reading in readings if reading is not None]
        if len(columns) < len(readings):
            return None
        stamps, positions, velocities = zip(*columns)
        return stamps[0], positions, velocities
