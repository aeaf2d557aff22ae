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

"""Whether anything was touched."""

from __future__ import annotations

import numpy as np

from .check import Finding, Test
from .evidence import Evidence
from .measures import line_through

_ONLY_NOISE = 1.5  # times the white noise: spread of a signal
_FELT, _CORRELATED = 10.0, 0.7  # times the noise, and with that of the wall: the robot felt it


def find(evidence: Evidence) -> Finding:
    """
    Find a force or a position that is nothing but noise.

    Parameters
    ----------
    evidence : Evidence
        Of a recording.

    Returns
    -------
    finding : Finding
        Not ok if there is nothing to be diagnosed.

    """
    force, position = (np.concatenate([getattr(part, row) for part in evidence.parts])
                       for row in ('force', 'position'))
    ratios = (float(np.std(force)) / max(evidence.force_noise, 1e-300),
              float(np.std(position)) / max(evidence.position_noise, 1e-300))
    if ratios[1] < _ONLY_NOISE:
        return Finding(False, 'the position is nothing but noise, expected a motion; check the '
                              'joint, or excite the contact')
    if ratios[0] > _ONLY_NOISE:
        return Finding(True, f'the force varies by {ratios[0]:.3g} times its noise')
    text = f'the force is nothing but noise of {evidence.force_noise:.3g} N'
    if evidence.with_reference:
        felt = float(np.std(evidence.implied_force))
        pushed = line_through(evidence.wall_force, -evidence.implied_force).correlation
        if felt > _FELT * evidence.force_noise and pushed > _CORRELATED:
            return Finding(False, f'{text}, but the robot was pushed by {felt:.3g} N: expected '
                                  'the force of the contact; check topic, --axis and sensor')
    return Finding(False, f'{text}, expected a contact force: nothing was touched, or the sensor '
                          'is not connected; record a contact')


TEST = Test(find, after=('clock_offset',))
