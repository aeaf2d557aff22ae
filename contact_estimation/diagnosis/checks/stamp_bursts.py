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

"""Stamps that come in bursts, as of a driver that empties a buffer."""

from __future__ import annotations

from .check import Finding, Test
from .evidence import Evidence
from ...signals.stream_faults import bursts_of


def find(evidence: Evidence) -> Finding:
    """
    Find wrenches whose stamps tell when a buffer was read, not when the force was measured.

    Parameters
    ----------
    evidence : Evidence
        Of a recording.

    Returns
    -------
    finding : Finding
        Not ok if most of the time passes between bursts.

    """
    bursts = bursts_of(evidence.whole.wrench_t)
    if bursts is None:
        return Finding(True, 'stamps of the wrench come one by one')
    return Finding(False, bursts.text)


TEST = Test(find)
