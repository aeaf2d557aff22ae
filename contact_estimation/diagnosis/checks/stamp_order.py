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

"""Check: stamps grow in the order of recording."""

from __future__ import annotations

from .check import Finding, Test
from .evidence import Evidence

_MOST_S = 0.1  # late messages of a busy network


def find(evidence: Evidence) -> Finding:
    """
    Find a clock that was set back.

    Parameters
    ----------
    evidence : Evidence
        Of a recording.

    Returns
    -------
    finding : Finding
        Not ok if stamps jump back: two stretches then lie over one another.

    """
    back = evidence.recording.stamps_back_s
    if back <= _MOST_S:
        return Finding(True, f'stamps jump back by {back:.3g} s at most')
    return Finding(False, f'stamps of wrench or joint_states jump back by {back:.3g} s, expected '
                          f'{_MOST_S:g} s at most: the clock was set back, or recordings were '
                          'joined; cut the recording there')


TEST = Test(find)
