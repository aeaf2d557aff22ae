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

"""The resolution of the position."""

from __future__ import annotations

from math import sqrt

import numpy as np

from .check import Finding, Test
from .evidence import Evidence
from ..observe.motion_error import quantisation_step

_COARSE = 0.003  # of the depth


def find(evidence: Evidence) -> Finding:
    """
    Find positions rounded more coarsely than the contact deserves.

    Parameters
    ----------
    evidence : Evidence
        Of a recording.

    Returns
    -------
    finding : Finding
        Not ok if steps are coarser than the noise and a share of the depth.

    """
    step = quantisation_step(evidence.whole.position)
    depth = float(np.ptp(evidence.smooth.x))
    if evidence.model.environment.unilateral and evidence.onset is not None:
        depth = evidence.onset.depth
    if step == 0.0:
        return Finding(True, 'positions are not rounded')
    text = f'positions are rounded to {step:.3g} m, {100.0 * step / max(depth, step):.2g} % of ' \
           'the depth'
    if step < _COARSE * depth or step / sqrt(12.0) < evidence.position_noise:
        return Finding(True, text)
    return Finding(False, f'{text}, expected less than {100.0 * _COARSE:g} %: the rounding is '
                          'treated as noise, and no effect of such a size is named; record more '
                          'digits', fatal=False)


TEST = Test(find, after=('clock_offset', 'length_unit'), could_cause=frozenset(
    {'backlash', 'dead_zone', 'free_play', 'moving_environment', 'plastic_set',
     'presliding_friction'}))
