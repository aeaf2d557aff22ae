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
        self._lacking = ''

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
            self._session.count_rejected(f'wrench_{error.reason}')
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
            self._session.count_rejected(f'joint_states_{error.reason}')
            return []
        if row is not None:
            if self._lacking:
                self._session.problem = self._lacking = ''
            return self._session.add_motion(row[0], *row[1])
        arm = self._session.arm
        names = [arm.model.joint_names[k] for k in self._merger.missing] if arm else []
        if arm and names:
            self._session.problem = self._lacking = (
                f'no joint state has {", ".join(names)}, which the arm from '
                f'{arm.model.base} to {arm.model.tip} needs; check the topic and kinematics.*')
        return []

    def process_pairs(
        self, wrenches: Sequence[bytes], joints: Sequence[bytes]
    ) -> list[AxesEstimates] | None:
        """Return None: the samples of an arm are processed one by one."""
        return None

    def _prepared(self) -> bool:
        arm = self._session.arm
        if arm is None:
            self._session.count_rejected('robot_description_missing')
            return False
        self._joints = SomeJointsDecoder(arm.model.joint_names)
        self._merger = JointMerger(arm.model.continuous)
        return True

    def _accepts(self, frame_id: str) -> bool:
        """Check the frame of a wrench; without a configured frame the first one is adopted."""
        arm = self._session.arm
        if arm is None:
            self._session.count_rejected('robot_description_missing')
            return False
        if arm.sensor and frame_id == self.frame_id:
            return True
        self.frame_id = self.frame_id or frame_id
        if frame_id != self.frame_id:
            self._session.count_rejected('wrench_frame_id')
            return False
        try:
            arm.use_sensor(arm.sensor or frame_id)
        except ContactEstimationError as error:
            self.frame_id, self._session.problem = '', f'frame of the wrench: {error}'
            self._session.count_rejected('wrench_frame_unknown')
            return False
        self._session.problem = ''
        return True


def inputs_of(session: ContactSession) -> MessageInputs | ArmInputs:
    """Return the inputs that fit the parameters of a session."""
    return ArmInputs(session) if session.parameters.kinematics.tip else MessageInputs(session)
