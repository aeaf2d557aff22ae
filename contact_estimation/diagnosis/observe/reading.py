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

"""The signals of a recording, with times from its first wrench."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .observed import Signals
from ...recordings.recorded_signals import RecordedSignals

Array = NDArray[np.float64]


def timed(recorded: RecordedSignals) -> Signals:
    """
    Count time from the first wrench.

    Parameters
    ----------
    recorded : RecordedSignals
        As read.

    Returns
    -------
    signals : Signals
        For `observe`.

    """
    start = int(recorded.wrench.stamp_ns[0])

    def since(stamps: NDArray[np.int64]) -> Array:
        return np.asarray((stamps - start) * 1e-9, np.float64)

    wrench, joints = recorded.wrench, recorded.joint_states
    reference = recorded.reference_trajectory
    return Signals(
        since(wrench.stamp_ns), wrench.values[0], since(joints.stamp_ns), joints.values[0],
        since(reference.stamp_ns), reference.values,
    )
