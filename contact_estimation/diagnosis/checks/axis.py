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

"""The axis of the force."""

from __future__ import annotations

import numpy as np

from .check import Finding, Test
from .evidence import Evidence

_SMALL = 0.3  # of the expected force
_SMALL_ALONE = 0.1  # the same without a robot: the nominal wall may be too stiff
_UNRELATED = 0.5  # correlation
_REPEATS = 0.8  # the same of the force on the ways in and out
_SURE = 20.0  # times the noise: expected forces


def find(evidence: Evidence) -> Finding:
    """
    Find a force that is not that of the contact axis.

    Parameters
    ----------
    evidence : Evidence
        Of a recording.

    Returns
    -------
    finding : Finding
        Not ok if the motion shows a contact that the force hardly shows. A force that follows no
        line, but is the same at a place on the ways in and out, is that of a strongly nonlinear
        contact, such as a dome that buckles.

    """
    if not evidence.model.environment.unilateral:
        return Finding(True, f'correlation of force and nominal force '
                             f'{evidence.of_wall.correlation:.2f}')
    wall, robot = evidence.of_wall, None
    text = f'the force is {wall.slope:.2g} times that of the nominal wall'
    _, expected = evidence.deviations
    if evidence.with_reference:
        robot = evidence.of_robot
        text += f' and {robot.slope:.2g} times what the robot felt'
        expected = min(expected, float(np.std(evidence.implied_force)))
    text += f' (correlation {wall.correlation:.2f})'
    lines = [wall] if robot is None else [wall, robot]
    least = _SMALL_ALONE if robot is None else _SMALL
    small = all(abs(line.slope) < least for line in lines)
    no_line = all(abs(line.correlation) < _UNRELATED for line in lines)
    unrelated = robot is not None and no_line
    if robot is None and no_line and evidence.repeats > _REPEATS:
        return Finding(True, f'{text}, the same on the ways in and out')
    if expected < _SURE * evidence.force_noise or not (small or unrelated):
        return Finding(True, text)
    return Finding(False, f'{text}, expected about 1: this seems to be another axis of the '
                          'sensor, or one that is not connected; choose --axis, or check '
                          "the wrench's frame and unit and the nominal stiffness")


TEST = Test(find, after=('clock_offset', 'sampling_rate', 'position_sign', 'length_unit',
                         'force_unit', 'command_topic', 'excitation'))
