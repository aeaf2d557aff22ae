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

"""Samples of two sources on one topic."""

from __future__ import annotations

import numpy as np

from .check import Finding, Test
from .evidence import Evidence
from ...signals.stream_faults import courses_of

_OF_RANGE = 0.1  # of the signal: blocks in which it changes less do not count


def find(evidence: Evidence) -> Finding:
    """
    Find a force or a position that changes from sample to sample between two courses.

    Parameters
    ----------
    evidence : Evidence
        Of a recording.

    Returns
    -------
    finding : Finding
        Not ok if there are two.

    """
    s = evidence.whole
    for signal, topic, unit, values in (('force', 'wrench', 'N', s.force),
                                        ('position', 'joint_states', 'm', s.position)):
        found = courses_of(values, _OF_RANGE * float(np.ptp(values)))
        if found is not None:
            return Finding(False, found.text(signal, topic, unit))
    return Finding(True, 'force and position have one course each')


TEST = Test(find)
