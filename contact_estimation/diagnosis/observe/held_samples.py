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

"""
Samples that a publisher repeats because its sensor or bus is slower than it.

A staircase of repeated positions has velocities and accelerations that the motion has not.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from .motion_error import quantisation_step
from .signals import LEAST_SAMPLES, Recording

Array = NDArray[np.float64]

_REGULAR = 0.7  # of the values must be repeated as often as usual, give or take one
_COARSE = 4.0  # quanta: smaller steps come from the resolution


def without_held_samples(recording: Recording) -> Recording:
    """Keep each value once where wrench or joint states repeat them regularly."""
    s = recording.signals
    wrench, joint = updates(s.force), updates(s.position)
    if len(wrench) == len(s.force) and len(joint) == len(s.position):
        return recording
    return replace(recording, signals=s._replace(
        wrench_t=s.wrench_t[wrench], force=s.force[wrench],
        joint_t=s.joint_t[joint], position=s.position[joint]))


def updates(values: Array) -> NDArray[np.int_]:
    """Find the samples at which a sensor gave a new value."""
    every = np.arange(len(values))
    starts = np.concatenate(([0], np.flatnonzero(np.diff(values)) + 1))
    counts = np.diff(np.append(starts, len(values)))
    usual = int(np.median(counts))
    if usual < 2 or len(starts) < LEAST_SAMPLES:
        return every
    size = float(np.median(np.abs(np.diff(values[starts]))))
    regular = np.mean(np.abs(counts - usual) <= 1) >= _REGULAR
    if not regular or size < _COARSE * quantisation_step(values):
        return every
    since = every - np.repeat(starts, counts)
    return every[since % usual == 0]
