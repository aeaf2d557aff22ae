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

"""Evidence for the checks: the last blocks of samples, as arrays."""

from __future__ import annotations

from collections import deque
from itertools import chain
from math import inf, nan
from typing import Any, Mapping, Sequence

import numpy as np

from .check import Array, bias_of, BLOCKS, Evidence, Forces
from ..parameters import EstimationParameters
from ..result import AxesEstimates
from ...estimators.estimate import EstimateStatus
from ...signals.contact_sample import AxesSample

_BLOCK_S = 0.5
_LEAST_BLOCK = 25  # samples
_KEPT = 50_000  # wrenches and joint stamps while no sample comes
_FREE = EstimateStatus.FREE  # an enumeration takes long to look up


class EvidenceWindow:
    """The last two seconds of every axis, block by block; attributes as of `InputChecks`."""

    def __init__(self, pipelines: Mapping[str, Any]) -> None:
        self._axes = tuple(pipelines)
        self.joint_stamps: deque[int] = deque(maxlen=_KEPT)
        self.wrenches: deque[tuple[int, float, float, float]] = deque(maxlen=_KEPT)
        self.samples: list[AxesSample] = []
        self.estimates: list[AxesEstimates] = []
        self.reset()
        self.restart(0.0)

    def reset(self) -> None:
        """Forget how far the axes have moved and what they have pressed with."""
        self._travel = {axis: (inf, -inf) for axis in self._axes}
        self._pressing = {axis: -inf for axis in self._axes}

    def restart(self, sample_rate: float) -> None:
        """Start a new window, as after a clock jump: stamps to come are from before it."""
        self.block = max(_LEAST_BLOCK, round(_BLOCK_S * sample_rate))
        self.joint_stamps.clear()
        self.wrenches.clear()
        self._windows: dict[str, deque[Array]] = {
            axis: deque(maxlen=BLOCKS) for axis in self._axes}
        self._others: deque[Array] = deque(maxlen=BLOCKS)
        self._memory: dict[str, dict[str, Any]] = {axis: {} for axis in self._axes}
        self._joint_rate, self._block_end_ns = nan, 0
        self._start_block()

    def _start_block(self) -> None:
        self.samples.clear()
        self.estimates.clear()

    def most(self, axis: str) -> tuple[float, float]:
        """Return the greatest position [m] and pressing force [N] of an axis so far."""
        place = self._axes.index(axis)
        pending = [axes[place] for axes in self.samples]
        return (max([self._travel[axis][1], *(sample[1] for sample in pending)]),
                max([self._pressing[axis], *(-sample[3] for sample in pending)]))

    def close_block(self, end_ns: int) -> None:
        """Turn the samples of the block, which ends at a stamp, into arrays; start the next."""
        count = len(self.samples)
        for place, axis in enumerate(self._axes):
            table = np.empty((5, count))  # stamp, position, rate, force, whether in contact
            numbers = chain.from_iterable([axes[place] for axes in self.samples])
            table[:4] = np.fromiter(numbers, float, 4 * count).reshape(count, 4).T
            table[4] = [axes[place][7] is not _FREE for axes in self.estimates]
            low, high = self._travel[axis]
            x = table[1]
            self._travel[axis] = min(low, float(x.min())), max(high, float(x.max()))
            self._pressing[axis] = max(self._pressing[axis], -float(table[3].min()))
            self._windows[axis].append(table)
        wrenches: list[tuple[int, float, float, float]] = []
        while self.wrenches and self.wrenches[0][0] <= end_ns:
            wrenches.append(self.wrenches.popleft())
        self._others.append(np.fromiter(
            chain.from_iterable(wrenches), float, 4 * len(wrenches)).reshape(-1, 4))
        joints = 0
        while self.joint_stamps and self.joint_stamps[0] <= end_ns:
            self.joint_stamps.popleft()
            joints += 1
        begin_ns, self._block_end_ns = self._block_end_ns, end_ns
        self._joint_rate = joints / ((end_ns - begin_ns) * 1e-9) if begin_ns else nan
        self._start_block()

    def evidence(
        self, axis: str, parameters: EstimationParameters, pipeline: Any,
        joints: Sequence[float], limits: Mapping[int, tuple[str, float, float]],
    ) -> Evidence:
        """Return the evidence of an axis; parameters as of `Evidence`."""
        stamps, x, v, force, touching = np.concatenate(self._windows[axis], axis=1)
        low, high = self._travel[axis]
        table = np.concatenate(self._others)
        begin = stamps[0]
        return Evidence(
            axis, parameters, pipeline, (stamps - begin) * 1e-9, x, v,
            force - bias_of(axis, parameters, pipeline),
            touching > 0.5, self._other_forces(table, stamps, x), self._joint_rate, high - low,
            (table[:, 0] - begin) * 1e-9, begin * 1e-9, joints, limits, self._memory[axis])

    def _other_forces(self, table: Array, stamps: Array, x: Array) -> tuple[Forces, ...]:
        """Return the components of the wrench that no axis estimates."""
        if not len(table):
            return ()
        position = np.interp(table[:, 0], stamps, x)
        return tuple(Forces(other, table[:, 1 + place], position)
                     for place, other in enumerate('xyz') if other not in self._axes)
