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

from .arm_frames import ArmFrames, static_as_parameters
from .events import EstimationEvent, event_now, READY, STATIC
from .result import AxesEstimates, Result
from .session import ContactSession
from .start_up import StartUp
from ..exceptions import ContactEstimationError, MessageError
from ..kinematics.robot_model import RobotModel
from ..messages import ForceTorqueDecoder, SomeJointsDecoder, StampedTransform, TransformsDecoder
from ..messages.cdr import header_stamp_ns
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
    frames : ArmFrames
        Of tf.
    events : list of EstimationEvent
        What a recording must hold besides the messages; the user takes them out.
    ignored : StartUp
        In replay, what the node had refused before it knew the arm.

    """

    _lacking = 'robot_description_missing'

    def __init__(self, session: ContactSession) -> None:
        self._session = session
        self.frame_id = session.parameters.frame_id
        self.frames, self.events = ArmFrames(), list[EstimationEvent]()
        self.ignored, self._start_up = StartUp(), StartUp()
        self._wrench, self._transforms = ForceTorqueDecoder(), TransformsDecoder()
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
        if self.ignored.has_wrench(stamp_ns):
            return []
        if not self._accepts(self._wrench.frame_id):
            self._start_up.refused_wrench(stamp_ns)
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
            self._start_up.refused_motion(header_stamp_ns(raw))
            return []
        assert self._joints is not None
        try:
            part = self._joints.decode(raw)
            row = None if self.ignored.has_motion(part[0]) else self._merger.add(*part)
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

    def process_static_transforms(self, raw: bytes) -> list[Result]:
        """
        Process raw static transforms of tf.

        Parameters
        ----------
        raw : bytes
            CDR of tf2_msgs/msg/TFMessage.

        Returns
        -------
        results : list of Result
            None.

        """
        try:
            self.use_static(self._transforms.decode(raw))
        except MessageError as error:
            self._session.count_rejected(f'tf_{error.reason}', str(error))
        return []

    def use_static(self, transforms: Sequence[StampedTransform]) -> None:
        """
        Use static transforms of tf.

        Parameters
        ----------
        transforms : sequence of StampedTransform
            As received.

        """
        if self.frames.add_static(transforms):
            self._announce_static()

    def _announce_static(self) -> None:
        new = self.frames.take_unreported()
        if new:
            self.events.append(event_now(self._session, STATIC, static_as_parameters(new)))

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
            self._session.count_rejected(self._lacking, self._session.problem)
            return False
        assert isinstance(arm.model, RobotModel)
        self._joints = SomeJointsDecoder(arm.model.joint_names)
        self._merger = JointMerger(arm.model.continuous)
        return True

    def _accepts(self, frame_id: str) -> bool:
        """Check the frame of a wrench; without a configured frame the first one is adopted."""
        arm = self._session.arm
        if arm is None:
            self._session.count_rejected(self._lacking, self._session.problem)
            return False
        if arm.sensor and frame_id == self.frame_id:
            return True
        self.frame_id = self.frame_id or frame_id
        if frame_id != self.frame_id:
            self._session.count_rejected(
                'wrench_frame_id', f'expected {self.frame_id!r}, got {frame_id!r}; set frame_id')
            return False
        try:
            self.frames.place_sensor(arm, self._session.parameters.force_sensor.frame or frame_id)
        except ContactEstimationError as error:
            self.frame_id = self._session.parameters.frame_id
            self._session.count_rejected(
                'wrench_frame_unknown', f'{error}; or name the link in force_sensor.frame')
            return False
        self._announce_static()
        refused = self._start_up.take_report()
        if refused:
            self.events.append(event_now(self._session, READY, refused))
        return True
