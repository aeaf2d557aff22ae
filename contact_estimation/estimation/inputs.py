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

"""Raw messages as inputs of a session: decoded, checked and passed on, for all its axes."""

from __future__ import annotations

from operator import itemgetter
from typing import Any, Callable, Sequence

import numpy as np

from .events import EstimationEvent
from .result import AxesEstimates, Result
from .session import ContactSession
from ..exceptions import MessageError
from ..messages import SeveralJointsDecoder, WrenchDecoder

_FORCES = {'x': 2, 'y': 3, 'z': 4}  # places in a WrenchReading


class MessageInputs:
    """
    The entrance of raw wrenches and joint states to a session.

    A message that cannot be used is counted as rejected and gives no result.

    Parameters
    ----------
    session : ContactSession
        Where measurements go.

    Attributes
    ----------
    frame_id : str
        Frame of the wrenches: as configured, else that of the first wrench; '' before it.
    events : list of EstimationEvent
        Always empty, see `ArmInputs`.

    """

    def __init__(self, session: ContactSession) -> None:
        self._session = session
        self.events: list[EstimationEvent] = []
        self._wrenches = session.checks.wrenches
        self.frame_id = session.parameters.frame_id
        joints = session.parameters.joints
        self._wrench = WrenchDecoder()
        self._joints = SeveralJointsDecoder(list(joints.values()))
        places = [_FORCES[axis] for axis in joints]
        self._columns = ['xyz'.index(axis) for axis in joints]
        self._sign = session.parameters.force_sign
        one = slice(places[0], places[0] + 1)
        self._forces: Callable[..., Any] = itemgetter(*places if len(places) > 1 else (one,))

    def process_wrench(self, raw: bytes) -> list[Result]:
        """
        Process a raw wrench.

        Parameters
        ----------
        raw : bytes
            CDR of geometry_msgs/msg/WrenchStamped.

        Returns
        -------
        results : list of Result
            One for each sample completed by this wrench.

        """
        try:
            reading = self._wrench.decode(raw)
        except MessageError as error:
            self._session.count_rejected(f'wrench_{error.reason}', str(error))
            return []
        if reading.frame_id != self.frame_id and not self._accepts(reading.frame_id):
            self._session.count_rejected(
                'wrench_frame_id', f'expected {self.frame_id!r}, got {reading.frame_id!r}; set '
                'frame_id')
            return []
        self._wrenches.append((reading[0], reading[2], reading[3], reading[4]))
        forces = self._forces(reading)
        if self._sign < 0.0:
            forces = [-force for force in forces]
        return self._session.add_wrench(reading.stamp_ns, *forces)

    def process_joints(self, raw: bytes) -> list[Result]:
        """
        Process a raw joint state.

        Parameters
        ----------
        raw : bytes
            CDR of sensor_msgs/msg/JointState.

        Returns
        -------
        results : list of Result
            One for each sample completed by this joint state.

        """
        try:
            stamp_ns, positions, velocities = self._joints.decode(raw)
        except MessageError as error:
            self._session.count_rejected(f'joint_states_{error.reason}', str(error))
            return []
        return self._session.add_motion(stamp_ns, *positions, *velocities)

    def process_pairs(
        self, wrenches: Sequence[bytes], joints: Sequence[bytes]
    ) -> list[AxesEstimates] | None:
        """
        Process raw wrenches and joint states that have the same stamps, many at once.

        Parameters
        ----------
        wrenches, joints : sequence of bytes
            Equally many of each.

        Returns
        -------
        estimates : list of tuple of Estimate, or None
            One a pair; None where the messages are irregular and must be processed one by one.

        """
        forces = self._wrench.decode_many(wrenches)
        motions = self._joints.decode_many(joints) if forces else None
        if not forces or not motions or not np.array_equal(forces[0], motions[0]):
            return None
        if not self._accepts(self._wrench.frame_id):
            return None
        stamps_ns, *components = forces
        columns = [self._sign * components[column] for column in self._columns]
        self._wrenches.extend(zip(stamps_ns.tolist(), *(c.tolist() for c in components)))
        estimates = self._session.add_pairs(stamps_ns, columns, *motions[1:])
        if estimates is None:
            for _ in wrenches:
                self._wrenches.pop()
        return estimates

    def _accepts(self, frame_id: str) -> bool:
        """Check the frame of a wrench; without a configured frame the first one is adopted."""
        self.frame_id = self.frame_id or frame_id
        return frame_id == self.frame_id
