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

"""Flat tops of the force."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .check import Finding, of_families, Test
from .evidence import Evidence
from ...physics.numeric import stretches

Array = NDArray[np.float64]

_LEAST_RUN, _LEAST_RUNS = 5, 2  # samples at exactly the extreme value
_MOVES = 0.02  # of the travel: motion during which the force must change
_OF_RANGE = 0.2  # of the force: an extreme nearer to 0 is free flight


def find(evidence: Evidence) -> Finding:
    """
    Find a force that stays at exactly its extreme value while the contact moves.

    Parameters
    ----------
    evidence : Evidence
        Of a recording.

    Returns
    -------
    finding : Finding
        Not ok if the sensor is at the limit of its range.

    """
    for part in evidence.parts:
        x = np.interp(part.wrench_t, part.joint_t, part.position)
        for limit in (float(np.min(part.force)), float(np.max(part.force))):
            if abs(limit) < _OF_RANGE * float(np.ptp(part.force)):
                continue
            runs = _moving_runs(part.force == limit, x)
            if runs >= _LEAST_RUNS:
                return Finding(False, f'the force stays at exactly {limit:.6g} N in {runs} '
                                      'stretches of motion, expected to change: the sensor is at '
                                      'the limit of its range; press less or choose a larger '
                                      'range. Of what clipping looks like only force_saturation '
                                      'is named', fatal=False)
    return Finding(True, 'no flat tops')


def _moving_runs(flat: NDArray[np.bool_], x: Array) -> int:
    least = _MOVES * float(np.ptp(x))
    return sum(bool(flat[first]) and stop - first >= _LEAST_RUN
               and float(np.ptp(x[first:stop])) > least for first, stop in stretches(flat))


TEST = Test(find, after=('clock_offset',), could_cause=of_families(
    'elastic_law', 'hysteresis', 'limits', 'relaxation') - {'force_saturation'})
