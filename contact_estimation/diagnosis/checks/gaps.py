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

"""Pauses of the recording."""

from __future__ import annotations

from .check import Finding, of_families, Test
from .evidence import Evidence
from ..observe.parts import spans_of


def find(evidence: Evidence) -> Finding:
    """
    Find pauses of a topic.

    Parameters
    ----------
    evidence : Evidence
        Of a recording.

    Returns
    -------
    finding : Finding
        Not ok if a topic has one.

    """
    spans = spans_of(evidence.whole)
    pauses = [(end, begin) for (_, end), (begin, _) in zip(spans[:-1], spans[1:])]
    if not pauses:
        return Finding(True, 'no pause')
    end, begin = max(pauses, key=lambda pause: pause[1] - pause[0])
    return Finding(False, f'{len(pauses)} pause(s) of wrench or joint_states, the longest from '
                          f'{end:.6g} to {begin:.6g} s, expected none: the stretches between them '
                          'are fitted as parts; record without a pause to name effects with a '
                          'memory', fatal=False)


TEST = Test(find, after=('clock_offset',), could_cause=of_families(
    'relaxation', 'hysteresis'))
