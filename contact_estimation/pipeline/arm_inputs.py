# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""From the raw messages of an arm to the inputs of a session: joint states, tf, description."""

from abc import ABC, abstractmethod
from itertools import repeat
from math import nan
from typing import ClassVar, Sequence

from .arm_kinematics import ArmFrames, kinematics_of_frames, static_as_parameters
from .axes import Result
from .events import EstimationEvent, event_now, READY, STATIC
from .session import ContactSession
from ..exceptions import ContactEstimationError, MessageError
from ..kinematics.frame_tree import StampedTransform, TransformsDecoder
from ..kinematics.robot_model import RobotModel
from ..kinematics.transform_model import MovingFrames, TransformModel
from ..recordings.cdr import header_stamp_ns
from ..recordings.decoding import JointsDecoder
from ..signals.joint_merging import JointMerger
from ..signals.stamp_screen import BEFORE_ANY


class StartUp:
    """
    Stamps of the last messages that were refused because the arm was not known yet.

    In replay the arm is known from the first message on. What the node refused must be refused
    again, or the estimates differ in their last digits.

    wrench_ns, motion_ns: newest stamps of a wrench and of a motion that were refused [ns]
    """

    def __init__(self, wrench_ns: int = BEFORE_ANY, motion_ns: int = BEFORE_ANY) -> None:
        self.wrench_ns, self.motion_ns = wrench_ns, motion_ns
        self._reported = False

    def refused_wrench(self, stamp_ns: int) -> None:
        """Note a wrench that was refused."""
        self.wrench_ns = max(self.wrench_ns, stamp_ns)

    def refused_motion(self, stamp_ns: int | None) -> None:
        """Note joint states or transforms that were refused; None: without a stamp."""
        if stamp_ns is not None:
            self.motion_ns = max(self.motion_ns, stamp_ns)

    def has_wrench(self, stamp_ns: int) -> bool:
        """Return whether a wrench is one of the refused ones; none is after the first later."""
        if stamp_ns <= self.wrench_ns:
            return True
        self.wrench_ns = BEFORE_ANY  # a clock that jumps back later refuses nothing
        return False

    def has_motion(self, stamp_ns: int) -> bool:
        """Return whether a motion is one of the refused ones; none is after the first later."""
        if stamp_ns <= self.motion_ns:
            return True
        self.motion_ns = BEFORE_ANY
        return False

    def take_report(self) -> dict[str, int]:
        """Return the stamps by name, once and where messages were refused; else nothing."""
        if self._reported or max(self.wrench_ns, self.motion_ns) == BEFORE_ANY:
            return {}
        self._reported = True
        return {'wrench_ns': self.wrench_ns, 'motion_ns': self.motion_ns}


class ArmStage(ABC):
    """
    The stage of an arm behind `MessageInputs`: its motion, its sensor and its static transforms.

    Every message before the session knows the arm is counted as rejected.

    events: what a recording must hold besides the messages; the user takes them out
    ignored: in replay, what the node had refused before it knew the arm
    """

    lacking: ClassVar[str]
    """Reason for which messages are rejected while the arm is not known."""

    def __init__(self, session: ContactSession) -> None:
        self._session = session
        self.frames, self.events = ArmFrames(), list[EstimationEvent]()
        self.ignored, self._start_up = StartUp(), StartUp()
        self._transforms = TransformsDecoder()

    @abstractmethod
    def process_motion(self, raw: bytes) -> list[Result]:
        """Process a raw message that has the motion of the arm, or a part of it."""

    @property
    def has_sensor(self) -> bool:
        """Whether the axes of the force sensor are known."""
        return self._session.arm is not None and bool(self._session.arm.sensor)

    def admits(self, stamp_ns: int) -> bool:
        """Return whether a wrench can be used, or else count it as rejected."""
        if self.ignored.has_wrench(stamp_ns):
            return False
        if self._session.arm is None:
            self._count_missing()
            self._start_up.refused_wrench(stamp_ns)
            return False
        return True

    def place_sensor(self, stamp_ns: int, frame_id: str) -> bool:
        """
        Set the frame in which wrenches are measured.

        stamp_ns: of the wrench [ns]
        """
        arm = self._session.arm
        assert arm is not None
        try:
            self.frames.place_sensor(arm, self._session.parameters.force_sensor.frame or frame_id)
        except ContactEstimationError as error:
            self._session.count_rejected(
                'wrench_frame_unknown', f'{error}; or name the link in force_sensor.frame')
            self._start_up.refused_wrench(stamp_ns)
            return False
        self._announce_static()
        refused = self._start_up.take_report()
        if refused:
            self.events.append(event_now(self._session, READY, refused))
        return True

    def process_static_transforms(self, raw: bytes) -> None:
        """Process raw static transforms of tf."""
        try:
            self.use_static(self._transforms.decode(raw))
        except MessageError as error:
            self._session.count_rejected(f'tf_{error.reason}', str(error))

    def use_static(self, transforms: Sequence[StampedTransform]) -> None:
        """Use static transforms of tf."""
        if self.frames.add_static(transforms):
            self._announce_static()

    def _announce_static(self) -> None:
        new = self.frames.take_unreported()
        if new:
            self.events.append(event_now(self._session, STATIC, static_as_parameters(new)))

    def _count_missing(self) -> None:
        self._session.count_rejected(self.lacking, self._session.problem)


_PARTS = 10  # messages over which the joints of an arm may be split


class ArmJoints(ArmStage):
    """The stage of an arm that has a description: joint states, which may come in parts."""

    lacking: ClassVar[str] = 'robot_description_missing'

    def __init__(self, session: ContactSession) -> None:
        super().__init__(session)
        self._joints: JointsDecoder | None = None
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
        self._joints = JointsDecoder(arm.model.joint_names, every=False)
        self._merger = JointMerger(arm.model.continuous)
        self._session.checks.limits = arm.model.limits
        return True


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
