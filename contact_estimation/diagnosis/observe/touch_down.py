# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

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
