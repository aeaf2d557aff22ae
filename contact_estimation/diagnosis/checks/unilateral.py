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

"""A robot that leaves a wall it is attached to by the model, or a drive that is to touch one."""

from __future__ import annotations

import numpy as np

from .check import Finding, Test
from .evidence import Evidence
from .measures import line_through

_FREE = 0.1  # of the range of the motion
_FLAT = 0.2  # stiffness of what is no wall, in that of the wall
_CLEARLY, _OFTEN = 0.1, 0.25  # of the range of the force, and of the time


def find(evidence: Evidence) -> Finding:
    """
    Find free flight of a robot that the model attaches to the wall, or none where it does not.

    A specimen without a command may well be slack; a robot that is commanded leaves the wall. What
    pushes and pulls, each for much of the time, and is nowhere free, does not touch a surface.

    Parameters
    ----------
    evidence : Evidence
        Of a recording.

    Returns
    -------
    finding : Finding
        Not ok if the force begins within the motion, does not change before, and a reference
        commands the robot; or if it has both signs and is not level at the lowest positions.

    """
    if evidence.model.environment.unilateral:
        return _of_touch(evidence)
    if len(evidence.whole.reference_t) < 2:
        return Finding(True, 'no reference_trajectory: not the robot of eq. (1)')
    x, onset = evidence.smooth.x, evidence.onset
    free = 0.0 if onset is None else onset.position - float(np.min(x))
    text = f'the force is that of free flight over {1e3 * free:.3g} mm of the motion'
    if onset is None or free <= _FREE * float(np.ptp(x)):
        return Finding(True, text)
    before, within = (line_through(x[side], evidence.smooth.force[side]).slope
                      for side in (x < onset.position, x >= onset.position))
    if abs(before) > _FLAT * abs(within):
        return Finding(True, 'the force changes over the whole motion')
    return Finding(False, f'{text}, expected a wall that the tool is attached to '
                          '(environment.unilateral: false); set environment.unilateral to true')


def _of_touch(evidence: Evidence) -> Finding:
    force = evidence.smooth.force
    least = max(evidence.clear_force, _CLEARLY * float(np.ptp(force)))
    pulls, pushes = (float(np.mean(sign * force > least)) for sign in (1.0, -1.0))
    text = f'F_e pulls for {100.0 * pulls:.0f} % of the time, pushes for {100.0 * pushes:.0f} %'
    if min(pulls, pushes) < _OFTEN or evidence.sees_free_flight:
        return Finding(True, text)
    return Finding(False, f'{text}, and nowhere is there free flight: nothing that only touches '
                          'a surface; set environment.unilateral to false')


TEST = Test(find, after=('excitation', 'clock_offset', 'sampling_rate'))
