# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The last seconds of all axes, block by block."""

from array import array
from collections import deque
from math import inf, nan
from typing import Any, Iterable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from .axes_checks import Loads
from .check import Array, AxisState, bias_of, BLOCKS, Forces, Window
from ..parameters import EstimationParameters
from ...estimators.estimate import Estimate, EstimateStatus


_BLOCK_S = 0.5
_LEAST_BLOCK = 25  # samples
_KEPT = 50_000  # wrenches and joint stamps while no sample comes
FREE = EstimateStatus.FREE
"""An enumeration takes long to look up."""


class Pending:
    """
    Rows of numbers that wait for their block.

    width: numbers a row; the first is a stamp [ns]
    """

    def __init__(self, width: int) -> None:
        self._width, self.numbers = width, array('d')

    def __len__(self) -> int:
        """Return the number of rows."""
        return len(self.numbers) // self._width

    def append(self, row: Iterable[float]) -> None:
        """Add a row."""
        self.numbers.extend(row)
        if len(self.numbers) > _KEPT * self._width:
            del self.numbers[:_KEPT // 2 * self._width]

    def extend(self, *columns: NDArray[Any]) -> None:
        """Add many rows."""
        self.numbers.frombytes(np.array(columns, float).T.tobytes())

    def drop(self, count: int) -> None:
        """Take back the last rows."""
        del self.numbers[len(self.numbers) - count * self._width:]

    def clear(self) -> None:
        """Forget all rows."""
        del self.numbers[:]

    @property
    def table(self) -> Array:
        """Return all rows, shape (N, width)."""
        return np.array(self.numbers).reshape(-1, self._width)

    def until(self, end_ns: float) -> Array:
        """Return and forget the rows before the first one that is stamped later."""
        table = self.table
        later = np.flatnonzero(table[:, 0] > end_ns)
        count = int(later[0]) if len(later) else len(table)
        del self.numbers[:count * self._width]
        return table[:count]


class Windows:
    """The last two seconds of every axis, block by block; attributes as of `InputChecks`."""

    def __init__(self, pipelines: Mapping[str, Any]) -> None:
        self._axes = tuple(pipelines)
        self.joint_stamps, self.wrenches, self.loads = Pending(1), Pending(4), Pending(10)
        self.samples = [Pending(5) for _ in self._axes]
        self.reset()
        self.restart(0.0)

    def add_many(
        self, stamps_ns: NDArray[np.int64], columns: Sequence[Sequence[Array]],
        estimates: Sequence[Sequence[Estimate]],
    ) -> None:
        """Add many samples: position, rate and force of each axis, and its estimates."""
        for pending, own, found in zip(self.samples, columns, estimates):
            pending.extend(stamps_ns, *own, np.array([one[7] is not FREE for one in found]))

    def reset(self) -> None:
        """Forget how far the axes have moved and what they have pressed with."""
        self._travel = {axis: (inf, -inf) for axis in self._axes}
        self._pressing = {axis: -inf for axis in self._axes}
        self._loads = Loads()

    def restart(self, sample_rate: float) -> None:
        """Start a new window, as after a clock jump: stamps to come are from before it."""
        self.block = max(_LEAST_BLOCK, round(_BLOCK_S * sample_rate))
        self.joint_stamps.clear()
        self.wrenches.clear()
        self.loads.clear()
        self._windows: dict[str, deque[Array]] = {
            axis: deque(maxlen=BLOCKS) for axis in self._axes}
        self._others: deque[Array] = deque(maxlen=BLOCKS)
        self._memory: dict[str, dict[str, Any]] = {axis: {} for axis in self._axes}
        self.joint_rate, self._block_end_ns = nan, 0
        for pending in self.samples:
            pending.clear()

    def most(self, axis: str) -> tuple[float, float]:
        """Return the greatest position [m] and pressing force [N] of an axis so far."""
        x, _, force = self.samples[self._axes.index(axis)].table[:, 1:4].T
        return (max([self._travel[axis][1], *x.tolist()]),
                max([self._pressing[axis], *(-force).tolist()]))

    def close_block(self, end_ns: int) -> bool:
        """Turn the block that ends at a stamp into arrays; return whether an axis touched."""
        touched = False
        for pending, axis in zip(self.samples, self._axes):
            table = pending.until(inf).T  # stamp, position, rate, force, whether in contact
            low, high = self._travel[axis]
            x = table[1]
            self._travel[axis] = min(low, float(x.min())), max(high, float(x.max()))
            self._pressing[axis] = max(self._pressing[axis], -float(table[3].min()))
            before = self._windows[axis][-1][4, -1] if self._windows[axis] else 0.0
            touched |= bool(table[4].any() and not before)
            self._windows[axis].append(table)
        self._others.append(self.wrenches.until(end_ns))
        self._loads.add(self.loads.until(end_ns)[:, 1:])
        joints = len(self.joint_stamps.until(end_ns))
        begin_ns, self._block_end_ns = self._block_end_ns, end_ns
        self.joint_rate = joints / ((end_ns - begin_ns) * 1e-9) if begin_ns else nan
        return touched

    def of_axis(
        self, axis: str, parameters: EstimationParameters, state: AxisState,
        joints: Sequence[float], limits: Mapping[int, tuple[str, float, float]],
    ) -> Window:
        """Return the evidence of an axis; parameters as of `Window`."""
        stamps, x, v, force, touching = np.concatenate(self._windows[axis], axis=1)
        low, high = self._travel[axis]
        table = np.concatenate(self._others)
        begin = stamps[0]
        return Window(
            axis, parameters, state, (stamps - begin) * 1e-9, x, v,
            force - bias_of(axis, parameters, state),
            touching > 0.5, self._other_forces(table, stamps, x), self.joint_rate, high - low,
            (table[:, 0] - begin) * 1e-9, begin * 1e-9, joints, limits, tuple(self._loads.kept),
            self._memory[axis])

    def _other_forces(self, table: Array, stamps: Array, x: Array) -> tuple[Forces, ...]:
        """Return the components of the wrench that no axis estimates."""
        if not len(table):
            return ()
        position = np.interp(table[:, 0], stamps, x)
        return tuple(Forces(other, table[:, 1 + place], position)
                     for place, other in enumerate('xyz') if other not in self._axes)
