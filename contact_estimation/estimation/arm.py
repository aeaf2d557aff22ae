# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The kinematics of the configured arm, once its description is known."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from ..exceptions import ModelFileError, ParameterRangeError
from ..kinematics.contact_kinematics import ContactKinematics, unit_normal
from ..kinematics.frame_tree import FrameTree
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


def check_arm(parameters: EstimationParameters) -> None:
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


def _check_efforts(parameters: EstimationParameters) -> None:
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


def kinematics_of(parameters: EstimationParameters, description: str) -> ContactKinematics:
    """Make the kinematics of an arm."""
    p = parameters
    model = RobotModel(description, p.kinematics.base, p.kinematics.tip)
    kinematics = ContactKinematics(
        model, p.contact, p.tool, p.force_sign, p.force_sensor.rpy, p.force_sensor.axes == 'base')
    frame = p.force_sensor.frame or p.frame_id
    if frame in model.links:  # tf may know others
        kinematics.use_sensor(frame)
    return kinematics


def kinematics_of_frames(parameters: EstimationParameters, tree: FrameTree) -> ContactKinematics:
    """Make the kinematics of an arm whose poses are those of tf."""
    p = parameters
    model = TransformModel(tree, p.kinematics.base, p.kinematics.tip)
    return ContactKinematics(
        model, p.contact, p.tool, p.force_sign, p.force_sensor.rpy, p.force_sensor.axes == 'base')


def described_in_file(parameters: EstimationParameters) -> str:
    """Return the robot description of the configured file."""
    path = parameters.robot_description_file
    if not path:
        return ''
    try:
        return Path(path).read_text()
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, 'strerror', None) or 'it is no text'
        raise ModelFileError(
            f'robot_description_file {path} cannot be read: {reason}; give the path of a URDF, '
            'with xacro expanded'
        ) from error
