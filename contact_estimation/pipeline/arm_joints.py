# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The joint states of an arm as inputs of a session."""

from __future__ import annotations

from typing import ClassVar

from .arm_stage import ArmStage
from .result import Result
from .session import ContactSession
from ..exceptions import MessageError
from ..kinematics.robot_model import RobotModel
from ..messages import SomeJointsDecoder
from ..messages.cdr import header_stamp_ns
from ..signals.joint_merging import JointMerger

_PARTS = 10  # messages over which the joints of an arm may be split


class ArmJoints(ArmStage):
    """The stage of an arm that has a description: joint states, which may come in parts."""

    lacking: ClassVar[str] = 'robot_description_missing'

    def __init__(self, session: ContactSession) -> None:
        super().__init__(session)
        self._joints: SomeJointsDecoder | None = None
        self._complete, self._incomplete = False, 0

    def process_motion(self, raw: bytes) -> list[Result]:
        """Process a raw joint state, which may have some of the joints or others."""
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
            self._session.checks.joints = row[1]
            return self._session.add_motion(row[0], *row[1])
        if not self._complete:
            self._count_lacking()
        return []

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
            self._count_missing()
            return False
        assert isinstance(arm.model, RobotModel)
        self._joints = SomeJointsDecoder(arm.model.joint_names)
        self._merger = JointMerger(arm.model.continuous)
        self._session.checks.limits = arm.model.limits
        return True
