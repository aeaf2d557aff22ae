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

"""Check: the file of the recording could be read as a whole."""

from __future__ import annotations

from .check import Finding, Test
from .evidence import Evidence


def find(evidence: Evidence) -> Finding:
    """
    Find what of the file is damaged.

    Parameters
    ----------
    evidence : Evidence
        Of a recording.

    Returns
    -------
    finding : Finding
        Not ok if a part could not be read.

    """
    damage = evidence.recording.damage
    if not damage:
        return Finding(True, 'the file could be read as a whole')
    last = float(evidence.whole.wrench_t[-1])
    return Finding(False, f'the file is damaged: {damage}; what was read lasts {last:.6g} s, and '
                          'the rest is not diagnosed; end the recorder before copying its file',
                   fatal=False)


TEST = Test(find)
