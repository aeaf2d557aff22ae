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

"""A zero of the force sensor that steps."""

from __future__ import annotations

import numpy as np

from .check import Finding, Test
from .evidence import Evidence
from ...signals.stream_faults import TARE_DUE, zero_steps

_OF_RANGE = 0.006  # of the force: a smaller step is not worth a name, see `conclude`
_ALONG = 0.25  # of the travel before the surface: nearer, a contact may have begun
_MOST = 5  # steps listed


def find(evidence: Evidence) -> Finding:
    """
    Find steps of the force in free flight, at once or from before a contact to after it.

    Parameters
    ----------
    evidence : Evidence
        Of a recording.

    Returns
    -------
    finding : Finding
        Not ok if there are any. A drift is none: it is as fast in free flight.

    """
    onset, s = evidence.onset, evidence.whole
    if not evidence.model.environment.unilateral or onset is None:
        return Finding(True, 'no free flight')
    x = np.interp(s.wrench_t, s.joint_t, s.position)
    free = x < onset.position - _ALONG * (onset.position - float(np.min(x)))
    least = max(evidence.force_noise, _OF_RANGE / TARE_DUE * float(np.ptp(s.force)))
    steps = zero_steps(s.wrench_t[free], s.force[free], least)
    if not steps:
        return Finding(True, 'the zero of the force sensor does not step')
    times = ', '.join(f'by {one.size:+.2g} N between {one.begin:.4g} and {one.end:.4g} s'
                      for one in steps[:_MOST])
    return Finding(False, f'the zero of the force sensor steps {times}: the driver zeroes the '
                          'sensor, or it slips; zero it before the recording and not during it, '
                          'or cut the recording there')


TEST = Test(find, after=('clock_offset', 'two_sources', 'stamp_bursts'))
