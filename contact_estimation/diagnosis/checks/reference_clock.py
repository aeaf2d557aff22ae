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
"""The clock of the reference."""

from __future__ import annotations

from .check import Finding, Test
from .evidence import Evidence

_AHEAD_S, _LEAST_SAMPLES = 0.005, 3.0
_LEFT = 0.25  # most of the squared misfit of eq. (1) that the shift leaves


def find(evidence: Evidence) -> Finding:
    """
    Find a reference that is stamped later than the robot follows it.

    Parameters
    ----------
    evidence : Evidence
        Of a recording.

    Returns
    -------
    finding : Finding
        Not ok if the robot moves before its command.

    """
    if not evidence.with_reference:
        return Finding(True, 'no reference_trajectory')
    early = evidence.ahead_of_reference
    text = f'the motion fits the reference best {1e3 * early.seconds:.0f} ms ahead of it'
    least = max(_AHEAD_S, _LEAST_SAMPLES * evidence.period)
    if early.seconds <= least or early.left >= _LEFT:
        return Finding(True, text)
    return Finding(False, f'{text}, expected 0 or later: no robot moves before its command; '
                          'stamp reference_trajectory by the clock of joint_states, with the '
                          'instant from which the robot follows it')


TEST = Test(find, after=('clock_offset', 'sampling_rate', 'position_sign', 'length_unit',
                         'force_unit', 'excitation', 'command_topic'))
