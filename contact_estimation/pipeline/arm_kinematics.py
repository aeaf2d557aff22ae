# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The kinematics of the configured arm, from its description or from the frames of tf."""

from typing import Any, Iterable, Mapping, Sequence, TYPE_CHECKING

import numpy as np

from ..exceptions import ParameterRangeError, UnknownNameError
from ..kinematics.contact_kinematics import ContactKinematics, unit_normal
from ..kinematics.description import read_description
from ..kinematics.frame_tree import FrameTree, matrix_of, StampedTransform
from ..kinematics.parameters import JOINT_EFFORTS
from ..kinematics.robot_model import RobotModel
from ..kinematics.transform_model import TransformModel

if TYPE_CHECKING:
    from .parameters import EstimationParameters

NO_DESCRIPTION = (
    'no robot description yet: publish it on robot_description (robot_state_publisher does), or '
    'set robot_description_file'
)
NO_TRANSFORMS = (
    'no transforms yet: nothing has come on tf that connects kinematics.base with kinematics.tip'
)


def check_arm(parameters: 'EstimationParameters') -> None:
    """Check parameters of an arm that must be consistent with each other."""
    if abs(parameters.force_sign) != 1.0:
        raise ParameterRangeError(f'force_sign must be 1 or -1, got {parameters.force_sign:g}')
    kinematics = parameters.kinematics
    if parameters.wrench_source == JOINT_EFFORTS:
        _check_efforts(parameters)
    if not kinematics.tip:
        if parameters.pose_source == 'tf':
            raise ParameterRangeError(
                'pose_source tf needs the frames of an arm, but kinematics.tip is empty; set '
                'kinematics.base, kinematics.tip and contact.normal'
            )
        if parameters.tool.is_on:
            raise ParameterRangeError(
                'tool.* needs the orientation of the force sensor, but kinematics.tip is empty; '
                'set kinematics.base, kinematics.tip and contact.normal'
            )
        return
    if not kinematics.base:
        raise ParameterRangeError(
            f'kinematics.base must name a link, since kinematics.tip is {kinematics.tip!r}, got '
            "an empty text; such as 'base_link'"
        )
    unit_normal(parameters.contact)
    further = parameters.further_axes.named()
    if parameters.joint or further:
        given = [f'joint {parameters.joint!r}'] if parameters.joint else []
        given += [f'further_axes.{axis}.joint {own.joint!r}' for axis, own in further.items()]
        raise ParameterRangeError(
            'joint and further_axes.*.joint must be empty for an arm (kinematics.tip is set): '
            'its joints follow from the robot description or tf, and one axis, contact.normal, '
            f'is estimated; got {", ".join(given)}'
        )


def _check_efforts(parameters: 'EstimationParameters') -> None:
    sensor, pose = parameters.force_sensor, parameters.pose_source
    if not parameters.kinematics.tip or pose != 'joints':
        raise ParameterRangeError(
            'wrench_source joint_efforts needs an arm with a robot description, but '
            f'kinematics.tip is {parameters.kinematics.tip!r} and pose_source {pose}; set '
            'kinematics.base, kinematics.tip, contact.normal, and pose_source joints')
    if sensor.frame or any(sensor.rpy) or sensor.axes != 'sensor':
        raise ParameterRangeError(
            'wrench_source joint_efforts gives the wrench in the axes of kinematics.tip; leave '
            'out force_sensor.frame, force_sensor.rpy and force_sensor.axes')


def kinematics_of(parameters: 'EstimationParameters', description: str) -> ContactKinematics:
    """Make the kinematics of an arm."""
    p = parameters
    model = RobotModel(description, p.kinematics.base, p.kinematics.tip)
    kinematics = ContactKinematics(
        model, p.contact, p.tool, p.force_sign, p.force_sensor.rpy, p.force_sensor.axes == 'base')
    frame = p.force_sensor.frame or p.frame_id
    if frame in model.links:  # tf may know others
        kinematics.use_sensor(frame)
    return kinematics


def kinematics_of_frames(parameters: 'EstimationParameters', tree: FrameTree) -> ContactKinematics:
    """Make the kinematics of an arm whose poses are those of tf."""
    p = parameters
    model = TransformModel(tree, p.kinematics.base, p.kinematics.tip)
    return ContactKinematics(
        model, p.contact, p.tool, p.force_sign, p.force_sensor.rpy, p.force_sensor.axes == 'base')


def described_in_file(parameters: 'EstimationParameters') -> str:
    """Return the robot description of the configured file."""
    path = parameters.robot_description_file
    return read_description(path, 'robot_description_file') if path else ''


NOT_INSTALLED = (
    'tf2_msgs is not installed, so that /tf and /tf_static cannot be read; install it with: '
    'sudo apt install ros-jazzy-tf2-msgs'
)

# Frames of the wrench that no robot description has, by the end of their names (with prefixes).
_DRIVERS = (
    ('tool0_controller', 'it is the active TCP of UR drivers: set force_sensor.frame to tool0, '
     'and force_sensor.rpy where the TCP is turned against it'),
    ('_K', 'it is the stiffness frame of Franka drivers: set force_sensor.frame to the link of '
     'the end-effector, and force_sensor.rpy where it is turned against it'),
)
_NO_FRAME = ('the driver leaves frame_id empty: set force_sensor.frame to the link of the sensor; '
             'for UR drivers tool0, with force_sensor.axes: base')


def hint_of_driver(frame: str) -> str:
    """Return what else to say of a frame that no description has; '' of none of a known driver."""
    return next((f'; {hint}' for end, hint in _DRIVERS if frame.endswith(end)), '')


class ArmFrames:
    """
    The frames of tf, as far as they have been received.

    used: whether estimates depend on static transforms, so that a recording must hold them
    unreadable: why no transforms can come; '' where they can
    """

    def __init__(self) -> None:
        self.tree, self.used, self.unreadable = FrameTree(), False, ''
        self._unreported: list[StampedTransform] = []
        self._refused: tuple[str, str] = '', ''

    def add_static(self, transforms: Sequence[StampedTransform]) -> bool:
        """Add transforms of /tf_static."""
        new = [one for one in transforms if self.tree.add_fixed([one])]
        self._unreported += new
        if new:
            self._refused = '', ''
        return bool(new)

    def take_unreported(self) -> list[StampedTransform]:
        """Return the static transforms in use that the last call did not return."""
        if not self.used:
            return []
        new, self._unreported = self._unreported, []
        return new

    def place_sensor(self, arm: ContactKinematics, frame: str) -> None:
        """Set the frame in whose axes the wrench is measured."""
        if not frame:
            raise UnknownNameError(_NO_FRAME)
        if self._refused[0] == frame:
            raise UnknownNameError(self._refused[1])  # nothing new since
        try:
            arm.use_sensor(frame)
        except UnknownNameError as error:
            found = self.tree.anchor(frame, arm.model.links)
            if found is None:
                text = f'{error}; or publish its mounting on /tf_static'
                text += hint_of_driver(frame)
                text += f' ({self.unreadable})' if self.unreadable else ''
                self._refused = frame, text
                raise UnknownNameError(text) from error
            arm.use_sensor(found[0], matrix_of(found[1]), np.array(found[1][:3]))
            self.used = True


def static_as_parameters(transforms: Iterable[StampedTransform]) -> dict[str, Any]:
    """Return static transforms as parameters of an event."""
    return {'transforms': [[one.parent, one.child, *one.pose] for one in transforms]}


def static_of_parameters(parameters: Mapping[str, Any]) -> list[StampedTransform]:
    """Return the transforms that `static_as_parameters` has written."""
    return [StampedTransform(0, parent, child, tuple(map(float, pose)))
            for parent, child, *pose in parameters['transforms']]
