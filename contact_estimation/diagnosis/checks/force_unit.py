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

"""The unit of the force."""

from __future__ import annotations

from math import log

from .check import Finding, Test
from .evidence import Evidence
from .units import FORCES, mistaken_unit

_IMPOSSIBLE = log(1e4)  # factor


def find(evidence: Evidence) -> Finding:
    """
    Find a force that is not in newtons.

    With a robot the force must be wrong by the same factor against the nominal wall and against
    the nominal robot's equation of motion, which does not know the wall.

    Parameters
    ----------
    evidence : Evidence
        Of a recording.

    Returns
    -------
    finding : Finding
        Not ok if the force has another unit.

    """
    text = f'the force is {evidence.of_wall.slope:.3g} times that of the nominal wall'
    if evidence.with_reference:
        text += f', {evidence.of_robot.slope:.3g} times what the robot felt'
    unit = mistaken_unit(evidence, FORCES)
    if unit is None:
        return _of_magnitude(evidence, text)
    other = {'kN': ' (or positions in mm)', 'kgf': ' (or on another axis)',
             'lbf': ' (or on another axis)'}.get(unit, '')
    return Finding(False, f'{text}, expected about 1: it seems to be in {unit}{other}; record '
                          'newtons')


def _of_magnitude(evidence: Evidence, text: str) -> Finding:
    """Find a force that no unit explains."""
    force, expected = evidence.deviations
    if not expected or not force or abs(log(force / expected)) < _IMPOSSIBLE:
        return Finding(True, text)
    return Finding(False, f'the force varies by {force:.3g} N, that of the nominal wall by '
                          f'{expected:.3g} N, expected about the same: no model is wrong by so '
                          'much; check that topics, joint, axis and model file belong together')


TEST = Test(find, after=('clock_offset', 'force_sign', 'position_sign', 'length_unit'))
