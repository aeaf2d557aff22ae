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

"""A topic that begins late or ends early."""

from __future__ import annotations

from .check import Finding, Test
from .evidence import Evidence

_MOST_LOST = 0.2  # of the longest topic


def find(evidence: Evidence) -> Finding:
    """
    Find a topic that covers a part of the recording only.

    Parameters
    ----------
    evidence : Evidence
        Of a recording.

    Returns
    -------
    finding : Finding
        Not ok if much of the wrench or of the joint states has no counterpart.

    """
    overlap = evidence.overlap
    spans = (overlap.spans[name] for name in ('wrench', 'joint_states'))
    longest = max(end - begin for begin, end in spans)
    if overlap.seconds >= (1.0 - _MOST_LOST) * longest:
        return Finding(True, overlap.text)
    return Finding(False, f'{overlap.text}: the {overlap.seconds:.3g} s in which all topics were '
                          'recorded are diagnosed, the rest is not; record all topics from '
                          'begin to end', fatal=False)


TEST = Test(find, after=('clock_offset',))
