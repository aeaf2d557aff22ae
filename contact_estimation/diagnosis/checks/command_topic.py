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

"""The topic of the reference."""

from __future__ import annotations

import numpy as np

from .check import Finding, Test
from .evidence import Evidence
from .measures import line_through

_SAME = 0.05  # of the deflection that the force must cause
_UNRELATED, _FELT = 0.3, 0.8  # correlation of the positions, of the forces
_SURE = 20.0  # times the noise: contact force


def find(evidence: Evidence) -> Finding:
    """
    Find a reference that is the measured position, or that the robot does not follow.

    Parameters
    ----------
    evidence : Evidence
        Of a recording.

    Returns
    -------
    finding : Finding
        Not ok if the topic is not what the robot was told.

    """
    if not evidence.with_reference:
        return Finding(True, 'no reference_trajectory')
    s, robot = evidence.smooth, evidence.model.robot
    assert s.reference is not None
    away = np.abs(s.force - evidence.sides[0])
    contact = away > 0.3 * float(np.max(away))
    felt = robot.stiffness * float(np.sqrt(np.mean((s.x - s.reference[0])[contact] ** 2)))
    pressed = float(np.sqrt(np.mean(away[contact] ** 2)))
    share = felt / max(pressed, 1e-300)
    text = f'in contact the robot is deflected from x_r by {share:.2g} times F_e / K_t'
    change = ('; record the trajectory that the robot was told to follow as '
              'reference_trajectory')
    tested = not robot.force_tracking and pressed > _SURE * evidence.force_noise
    if tested and share < _SAME:
        return Finding(False, f'{text}, expected about 1: the reference seems to be the measured '
                              f'position{change}')
    follows = line_through(s.reference[0], s.x).correlation
    if abs(follows) < _UNRELATED and evidence.of_robot.correlation < _FELT:
        return Finding(False, f'the correlation of x with x_r is {follows:.2f}, and the '
                              'deflection is no force: the robot follows another '
                              f'reference{change}')
    return Finding(True, text)


TEST = Test(find, after=('clock_offset', 'sampling_rate', 'position_sign', 'length_unit',
                         'force_unit', 'excitation'))
