# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The poses of an arm that come from tf, as inputs of a session."""

from __future__ import annotations

from itertools import repeat
from math import nan
from typing import ClassVar, Sequence

from .arm import kinematics_of_frames
from .arm_stage import ArmStage
from .result import Result
from .session import ContactSession
from ..exceptions import ContactEstimationError, MessageError
from ..kinematics.moving_frames import MovingFrames
from ..kinematics.transform_model import TransformModel
from ..messages import StampedTransform


class ArmTransforms(ArmStage):
    """
    The stage of an arm whose poses come from tf.

    The poses of the moving frames between `kinematics.base` and `kinematics.tip` take the place of
    joints: each is interpolated to the stamp of the wrench, and their product is the pose of the
    tip. The velocity along the normal follows from that position, as for joints without measured
    velocities.
    """

    lacking: ClassVar[str] = 'transforms_missing'

    def __init__(self, session: ContactSession) -> None:
        super().__init__(session)
        self.frames.used = True
        self._model: TransformModel | None = None
        self._moving: MovingFrames | None = None

    def process_motion(self, raw: bytes) -> list[Result]:
        """Process raw transforms of tf."""
        try:
            transforms = self._transforms.decode(raw)
        except MessageError as error:
            self._session.count_rejected(f'tf_{error.reason}', str(error))
            return []
        if self._moving is None:
            if self.frames.tree.add_moving(transforms):
                self._connect()
            if self._moving is None:
                self._refuse(transforms)
                return []
        transforms = [one for one in transforms if not self.ignored.has_motion(one.stamp_ns)]
        results: list[Result] = []
        for stamp_ns, poses in self._moving.add(transforms):
            results += self._session.add_motion(stamp_ns, *poses, *repeat(nan, len(poses)))
        return results

    def use_static(self, transforms: Sequence[StampedTransform]) -> None:
        """Use static transforms of tf, which may connect the arm or turn gravity."""
        if self.frames.add_static(transforms):
            self._announce_static()
            self._connect()

    def _connect(self) -> None:
        """Make the arm as soon as transforms connect base and tip; later ones may change it."""
        session = self._session
        try:
            arm = kinematics_of_frames(session.parameters, self.frames.tree)
        except ContactEstimationError as error:
            if self._model is None:
                session.problem = str(error)
            return
        assert isinstance(arm.model, TransformModel)
        if self._model is not None and arm.model.same_as(self._model):
            return
        if session.pipeline.contact:
            session.count_rejected(
                'tf_static_changed', 'a static transform between base and tip has changed in '
                'contact and is not used; start the node again')
            return
        if self._model is None or arm.model.joint_names != self._model.joint_names:
            self._moving = MovingFrames(
                arm.model.joint_names, session.parameters.synchronisation.time_jump_s)
        self._model = arm.model
        session.use_arm(arm)

    def _refuse(self, transforms: Sequence[StampedTransform]) -> None:
        for one in transforms:
            self._start_up.refused_motion(one.stamp_ns)
