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

"""The unit of the positions."""

from __future__ import annotations

import numpy as np

from .check import Finding, Test
from .evidence import Evidence
from .units import inverse, LENGTHS, LONG_TRAVEL, mistaken_unit, nearest_unit

_FOLLOWS = 0.7  # correlation of the velocities in free flight


def find(evidence: Evidence) -> Finding:
    """
    Find positions that are not in metres.

    Parameters
    ----------
    evidence : Evidence
        Of a recording.

    Returns
    -------
    finding : Finding
        Not ok if position, reference or both have another unit of length.

    """
    travel = float(np.ptp(evidence.smooth.x))
    if evidence.with_reference and evidence.followed.correlation > _FOLLOWS:
        ratio = evidence.followed.slope
        for name, factor in (('position', ratio), ('reference_trajectory', 1.0 / ratio)):
            unit = nearest_unit(factor, LENGTHS)
            if unit is not None:
                return Finding(False, f'in free flight x moves {ratio:.3g} times as x_r, expected '
                                      f'1: {name} seems to be in {unit}; record metres')
    unit = mistaken_unit(evidence, inverse(LENGTHS))
    if unit is None or (unit == 'mm' and travel < LONG_TRAVEL):
        return Finding(True, f'x travels {travel:.3g} m')
    share = evidence.of_wall.slope
    return Finding(False, f'x travels {travel:.3g} m, and the force is {share:.2g} times what the '
                          'nominal model predicts, expected about 1: the lengths seem to be in '
                          f'{unit}; record metres')


TEST = Test(find, after=('clock_offset', 'force_sign', 'position_sign'))
