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

"""The sign of the position."""

from __future__ import annotations

from .check import Finding, Test
from .evidence import Evidence

_STRONGER = 3.0  # times the force on the other side
_FOLLOWS = 0.7  # correlation of the velocities in free flight


def find(evidence: Evidence) -> Finding:
    """
    Find a position that decreases into the wall, or against its reference.

    Parameters
    ----------
    evidence : Evidence
        Of a recording.

    Returns
    -------
    finding : Finding
        Not ok if x has the opposite sign.

    """
    change = ('; change the sign of the recorded position, or let the contact axis point into '
              'the wall')
    if evidence.with_reference and evidence.followed.correlation < -_FOLLOWS:
        return Finding(False, f'x moves {evidence.followed.slope:.3g} times as x_r in free '
                              f'flight, expected 1{change}')
    if not evidence.model.environment.unilateral:
        return Finding(True, 'a permanently attached specimen has no side')
    low, high = evidence.sides_beyond_zero
    if abs(low) < evidence.clear_force or abs(low) < _STRONGER * abs(high):
        return Finding(True, f'the force is {high:.3g} N at the largest x, {low:.3g} N at the '
                             'smallest')
    return Finding(False, f'the force is {low:.3g} N at the smallest x and {high:.3g} N at the '
                          f'largest, expected the contact at large x{change}')


TEST = Test(find, after=('clock_offset',))
