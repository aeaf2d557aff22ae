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

"""A specimen that is loaded once, at constant speed."""

from __future__ import annotations

from .check import Finding, of_families, Test
from .evidence import Evidence
from .measures import bend_of, STRAIGHT


def find(evidence: Evidence) -> Finding:
    """
    Find a single stroke at constant speed, in which depth grows in proportion to time.

    Parameters
    ----------
    evidence : Evidence
        Of a recording.

    Returns
    -------
    finding : Finding
        Not ok if laws of time cannot be told from laws of depth.

    """
    bend = bend_of(*evidence.motion_in_contact)
    text = f'the motion departs from one stroke at constant speed by {100.0 * bend:.2g} % of ' \
           'its range'
    if bend > STRAIGHT:
        return Finding(True, text)
    return Finding(False, f'{text}: laws of time and speed look like laws of depth, and only the '
                          'latter are named; record the way back or a hold, or another speed and '
                          'diagnose both recordings together', fatal=False)


TEST = Test(find, after=('clock_offset', 'excitation'), alone=True, could_cause=of_families(
    'relaxation', 'wall_motion', 'timing', 'damping_law', 'inertia',
) | {'force_drift', 'settling_bias'})
