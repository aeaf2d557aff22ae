# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""What tf tells about an arm: where its sensor is mounted and, where asked, its poses."""

from __future__ import annotations

from typing import Any, Iterable, Mapping, Sequence

import numpy as np

from ..exceptions import UnknownNameError
from ..kinematics.contact_kinematics import ContactKinematics
from ..kinematics.frame_tree import FrameTree
from ..kinematics.poses import matrix_of
from ..messages import StampedTransform

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
                text += next((f'; {hint}' for end, hint in _DRIVERS if frame.endswith(end)), '')
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
