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

import numpy as np

from .check import Finding, Test
from .evidence import Evidence
from ..observe.signals import LEAST_SAMPLES

_SHORT, _LONG = 0.25, 10.0  # quantile of the steps, and times it: a pause between bursts
_MOST_OF_TIME = 0.5  # between bursts
_LEAST_BURSTS = 5
_BRIEF = 0.02  # most of the time in bursts of many samples: else they are stretches between gaps
_ADJACENT = 0.2  # most pauses that another follows: else the sampling is slow there


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
    steps = np.diff(evidence.whole.wrench_t)
    pauses = steps > _LONG * float(np.quantile(steps, _SHORT))
    count = int(np.count_nonzero(pauses))
    size = len(steps) / max(count, 1)
    adjacent = np.count_nonzero(pauses[1:] & pauses[:-1])
    between = 1.0 - _BRIEF if size > LEAST_SAMPLES else _MOST_OF_TIME
    if (count < _LEAST_BURSTS or adjacent > _ADJACENT * count
            or steps[pauses].sum() < between * steps.sum()):
        return Finding(True, 'stamps of the wrench come one by one')
    pause = float(np.median(steps[pauses]))
    return Finding(False, f'stamps of the wrench come in bursts of about {size:.2g}, one every '
                          f'{pause:.2g} s, expected even steps: they tell when a buffer was read; '
                          'stamp each wrench when it is measured')


TEST = Test(find)
