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

"""Raw messages of an arm as inputs of a session."""

from __future__ import annotations

from typing import Sequence

from .inputs import MessageInputs
from .result import AxesEstimates, Result
from .session import ContactSession
from ..exceptions import ContactEstimationError, MessageError
from ..messages import ForceTorqueDecoder, SomeJointsDecoder
from ..signals.joint_merging import JointMerger

_PARTS = 10  # messages over which the joints of an arm may be split


class ArmInputs:
    """
    The entrance of raw wrenches and joint states of an arm to a session.

    A message that cannot be used is counted as rejected and gives no result: so is every message
    before the session has a description.

    Parameters
    ----------
    session : ContactSession
        With an arm configured.

    Attributes
    ----------
    frame_id : str
        Frame of the wrenches: as configured, else that of the first wrench; '' before it.

    """

    def __init__(self, session: ContactSession) -> None:
        self._session = session
        self.frame_id = session.parameters.frame_id
        self._wrench = ForceTorqueDecoder()
        self._joints: SomeJointsDecoder | None = None
        self._complete, self._incomplete = False, 0

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
            stamp_ns, wrench = self._wrench.decode(raw)
        except MessageError as error:
            self._session.count_rejected(f'wrench_{error.reason}', str(error))
            return []
        if not self._accepts(self._wrench.frame_id):
            return []
        return self._session.add_wrench(stamp_ns, *wrench)

    def process_joints(self, raw: bytes) -> list[Result]:
        """
        Process a raw joint state, which may have some of the joints or others.

        Parameters
        ----------
        raw : bytes
            CDR of sensor_msgs/msg/JointState.

        Returns
        -------
        results : list of Result
            One for each sample completed by this joint state.

        """
        if self._joints is None and not self._prepared():
            return []
        assert self._joints is not None
        try:
            row = self._merger.add(*self._joints.decode(raw))
        except MessageError as error:
            if error.reason != 'joint_unknown' or not self._complete:
                self._session.count_rejected(f'joint_states_{error.reason}', str(error))
            return []  # once the arm is complete, other joints on the topic are of no concern
        if row is not None:
            self._complete = True
            return self._session.add_motion(row[0], *row[1])
        if not self._complete:
            self._count_lacking()
        return []

    def process_pairs(
        self, wrenches: Sequence[bytes], joints: Sequence[bytes]
    ) -> list[AxesEstimates] | None:
        """Return None: the samples of an arm are processed one by one."""
        return None

    def _count_lacking(self) -> None:
        arm, missing = self._session.arm, self._merger.missing
        self._incomplete += 1
        if arm is not None and missing and self._incomplete > _PARTS:
            names = ', '.join(arm.model.joint_names[place] for place in missing)
            self._session.count_rejected(
                'joint_lacking', f'no joint state has {names}, which moves '
                f'{arm.model.tip} relative to {arm.model.base}; check joint_states and '
                'kinematics.*')

    def _prepared(self) -> bool:
        arm = self._session.arm
        if arm is None:
            self._session.count_rejected(
                'robot_description_missing', self._session.problem)
            return False
        self._joints = SomeJointsDecoder(arm.model.joint_names)
        self._merger = JointMerger(arm.model.continuous)
        return True

    def _accepts(self, frame_id: str) -> bool:
        """Check the frame of a wrench; without a configured frame the first one is adopted."""
        arm = self._session.arm
        if arm is None:
            self._session.count_rejected(
                'robot_description_missing', self._session.problem)
            return False
        if arm.sensor and frame_id == self.frame_id:
            return True
        self.frame_id = self.frame_id or frame_id
        if frame_id != self.frame_id:
            self._session.count_rejected(
                'wrench_frame_id', f'expected {self.frame_id!r}, got {frame_id!r}; set frame_id')
            return False
        try:
            arm.use_sensor(arm.sensor or frame_id)
        except ContactEstimationError as error:
            self.frame_id = ''
            self._session.count_rejected(
                'wrench_frame_unknown', f'{error}; or name the link in force_sensor.frame')
            return False
        return True


def inputs_of(session: ContactSession) -> MessageInputs | ArmInputs:
    """Return the inputs that fit the parameters of a session."""
    return ArmInputs(session) if session.parameters.kinematics.tip else MessageInputs(session)
