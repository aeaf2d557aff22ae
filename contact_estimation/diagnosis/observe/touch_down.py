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

"""The course of a force that begins between two samples."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def at_touch_down(force: Array, d: Array) -> Array:
    """
    Keep the impulse of a force that begins between two samples.

    The force straight between samples would begin at the sample before touch-down. Its value
    there is set so that the area under the two lines that meet there is that of the true force.
    """
    inside = d > 0.0
    begins = np.flatnonzero(inside[1:] > inside[:-1])
    begins = begins[force[begins] == 0.0]
    d_0, d_1 = d[begins], d[begins + 1]
    share = d_1 / (d_1 - d_0)  # of the step that is spent in contact
    changed = force.copy()
    # The damper's part is there at once, the spring's grows from 0; the measured force at the
    # first sample is nearly all damper.
    changed[begins] = force[begins + 1] * (share - 0.5)
    return changed
