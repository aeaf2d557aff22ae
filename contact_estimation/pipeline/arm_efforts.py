# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The joint states of an arm without a force sensor as inputs of a session."""

from typing import ClassVar

import numpy as np

from .arm_inputs import ArmStage
from .axes import Result
from .events import event_now, READY
from .joint_torques import ContactWrench, Joints, JointTorques
from .parameters import EstimationParameters
from .session import ContactSession
from ..exceptions import MessageError
from ..kinematics.contact_kinematics import ContactKinematics
from ..kinematics.robot_model import RobotModel
from ..recordings.cdr import header_stamp_ns
from ..recordings.decoding import decode_arm
from ..signals.joint_merging import JointMerger


class EffortDecoder:
    """
    Turn raw joint states with efforts into motions and wrenches at the contact.

    torques: of the arm
    """

    def __init__(
        self, arm: ContactKinematics, urdf: str, parameters: EstimationParameters
    ) -> None:
        assert isinstance(arm.model, RobotModel)
        p = parameters
        self.torques = JointTorques(
            urdf, arm.model, p.contact.point, p.joint_torques_std, p.force_sign,
            p.synchronisation.maximum_gap_s)
        self._names, self._merger = arm.model.joint_names, JointMerger(arm.model.continuous)
        self._sign = p.force_sign
        arm.use_sensor(p.kinematics.tip)

    def decode(self, raw: bytes) -> ContactWrench | None:
        """Read a message that has all joints of the arm, with efforts; None before a window."""
        reading = decode_arm(raw)
        missing = [name for name in self._names if name not in reading.names]
        if missing:
            raise MessageError(
                'joint_unknown' if len(missing) == len(self._names) else 'joint_lacking',
                f'wrench_source joint_efforts needs all joints of the arm in one message, but '
                f'{", ".join(missing)} are not among {", ".join(reading.names) or "no names"}')
        places = [reading.names.index(name) for name in self._names]
        count = len(reading.names)
        if len(reading.position) < count or len(reading.effort) < count or not np.isfinite(
                reading.effort[places]).all():
            raise MessageError(
                'effort_missing',
                f'joint state has {len(reading.position)} positions and {len(reading.effort)} '
                f'efforts for {count} joints, expected the measured torque of each [N m]; let the '
                'driver publish effort, or set wrench_source to topic')
        v = reading.velocity[places] if len(reading.velocity) == count else np.full(
            len(places), np.nan)
        row = self._merger.add(reading.stamp_ns, reading.position[places].tolist(), v.tolist())
        if row is None or not np.isfinite(row[1][:len(places)]).all():
            return None
        q, v = np.array(row[1]).reshape(2, -1)
        found = self.torques.add(Joints(reading.stamp_ns, q, v, reading.effort[places]))
        # The wrench of a topic has the sign of its driver until the session corrects it.
        return found and found._replace(wrench=self._sign * found.wrench)


class ArmEfforts(ArmStage):
    """The stage of an arm whose wrench comes from its joint torques."""

    lacking: ClassVar[str] = 'robot_description_missing'

    def __init__(self, session: ContactSession) -> None:
        super().__init__(session)
        self._decoder: EffortDecoder | None = None
        self._complete = False

    def process_motion(self, raw: bytes) -> list[Result]:
        """Process a raw joint state."""
        session, arm = self._session, self._session.arm
        if arm is None:
            self._count_missing()
            self._start_up.refused_motion(header_stamp_ns(raw))
            return []
        if self._decoder is None:
            self._decoder = EffortDecoder(arm, session.description, session.parameters)
            assert isinstance(arm.model, RobotModel)
            session.checks.limits = arm.model.limits
            refused = self._start_up.take_report()
            if refused:
                self.events.append(event_now(session, READY, refused))
        if self.ignored.has_motion(header_stamp_ns(raw) or 0):
            return []
        try:
            found = self._decoder.decode(raw)
        except MessageError as error:
            if error.reason != 'joint_unknown' or not self._complete:
                session.count_rejected(f'joint_states_{error.reason}', str(error))
            return []
        self._complete = True
        if found is None:
            return []
        pipeline = session.pipeline
        pipeline.force_errors = tuple((arm.normal @ found.errors).tolist())
        if pipeline.posterior.contact.is_quiet:
            self._decoder.torques.note_free()
        session.checks.joints = motion = found.motion.tolist()
        results = session.add_motion(found.stamp_ns, *motion)
        return results + session.add_wrench(found.stamp_ns, *found.wrench.tolist())
