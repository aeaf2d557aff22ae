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
"""The rates of the reference."""

from __future__ import annotations

from .check import Finding, Test
from .evidence import Evidence
from ..observe.reference_rates import lacks_rates


def find(evidence: Evidence) -> Finding:
    """
    Find a reference that was recorded without its rates.

    Parameters
    ----------
    evidence : Evidence
        Of a recording.

    Returns
    -------
    finding : Finding
        Not ok if x_r moves smoothly, but its velocities and accelerations are missing.

    """
    if not evidence.with_reference:
        return Finding(True, 'no reference_trajectory')
    if not lacks_rates(evidence.whole):
        return Finding(True, 'x_r is recorded with its rates')
    return Finding(False, 'x_r moves smoothly, but all its velocities and accelerations are 0 or '
                          'missing, expected the feed-forward that the robot was told: both are '
                          'differentiated from x_r; record them', fatal=False)


TEST = Test(find, after=('clock_offset', 'command_topic'))
