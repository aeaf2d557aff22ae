# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Full 3 x 3 stiffness and damping of a contact from three forces and three positions."""

from dataclasses import dataclass
from math import pi
from typing import NamedTuple, Sequence

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from .estimate import EstimateStatus
from .matrix_posterior import direction_of, MatrixEstimate, posterior, Sums, tangents
from ..parameters import parameter, ParameterGroup
from ..physics.numeric import Array
from ..signals.contact_sample import AxesSample

_BLOCK = 50  # samples between estimates
_HELD = 10  # samples held back: a release is detected late
_KEPT = 30  # blocks from which rows are made anew for another normal
_NEW_WALL_NS = 500_000_000  # free for so long, the next contact may be with another wall
_LONGEST = 4.0  # steps of the stamps: a gap that is interpolated
_TURN = 0.005  # of the normal, up to which the rows are linear in it [rad]
_MOVING = 3.0  # standard deviations: smoothed noise alone spans 0.8
_EDGE = 2  # samples on either side, of the difference that gives the direction of sliding
_HALF = 13  # samples on either side, of the smoothing kernel cos^4 and its derivatives
_STEP = 5  # samples between rows
_WAVES = pi / (_HALF + 1) * np.arange(3)[:, None]
_SMOOTHING = np.array([[3.0], [4.0], [1.0]]) / (6.0 * (_HALF + 1))
_ANGLES = _WAVES * np.arange(-_HALF, _HALF + 1)
_KERNELS = np.column_stack([
    (_SMOOTHING * shape).sum(axis=0) for shape in (
        np.cos(_ANGLES), _WAVES * np.sin(_ANGLES), -_WAVES**2 * np.cos(_ANGLES))
])  # (27, 3) per step of the stamps
_GRAM = _KERNELS.T @ _KERNELS
_WEIGHT = _STEP * float(_GRAM[0, 0])  # of a row, whose noise overlaps with that of the next
_LENGTH = _BLOCK + 2 * (_HALF + _EDGE)


@dataclass(frozen=True)
class StiffnessMatrixParameters(ParameterGroup):
    """Memory of the estimator of the full matrices."""

    memory_s: float = parameter(
        5.0, 'Time constant in contact after which samples are forgotten', 's', minimum=0.1,
        maximum=1e4)


class _Block(NamedTuple):
    """Positions and pressing forces at equal steps, shape (80, 6), the step, and their noise."""

    data: Array
    step: float
    variances: Array


class StiffnessMatrix:
    """
    Posterior of -F = K x + B v + mu N v_t / |v_t| + c behind sensors with a lag, with forgetting.

    The constant c = -K x_e makes the locations of the surface along the axes unnecessary: K is
    what the forces change by. Columns that the motion does not excite have large deviations. All
    rows are smoothed by one kernel, whose derivatives give velocity and acceleration.

    timing_std: prior standard deviation of the lag of each force [s]
    estimate: the last one; None before the first
    """

    def __init__(self, parameters: StiffnessMatrixParameters, timing_std: float) -> None:
        self.configure(parameters, timing_std)
        self.reset()

    def configure(self, parameters: StiffnessMatrixParameters, timing_std: float) -> None:
        """Change memory and prior of the lag; what has been learned stays."""
        self._memory_s, self._timing_std = parameters.memory_s, timing_std

    def reset(self) -> None:
        """Forget everything."""
        self.estimate: MatrixEstimate | None = None
        self._contact_ns = 0
        self._restart()

    def _restart(self) -> None:
        """Forget the wall; the last estimate stays until there is another."""
        self._run: list[tuple[float, ...]] = []
        self._blocks: list[_Block] = []
        self._sums, self._moved = Sums.empty(), False

    def process(self, run: Sequence[AxesSample], contact: Sequence[bool]) -> list[MatrixEstimate]:
        """Process consecutive samples of the three axes."""
        estimates = []
        for axes, touching in zip(run, contact):
            if not touching:
                self._run = []
                continue
            stamp_ns = axes[0].stamp_ns
            if stamp_ns - self._contact_ns > _NEW_WALL_NS:
                self._restart()
            self._contact_ns = stamp_ns
            self._run.append((stamp_ns, *[sample.position for sample in axes],
                              *[-sample.force for sample in axes]))
            if len(self._run) == _LENGTH + _HELD:
                estimates += self._learn(np.array(self._run[:_LENGTH], float))
        return estimates

    def _learn(self, table: Array) -> list[MatrixEstimate]:
        """Learn from the next block, unless there is a gap in it."""
        steps = np.diff(table[:, 0])
        valid = np.asarray(np.isfinite(table).all(axis=1))
        even = (steps > 0.0) & (steps <= _LONGEST * float(np.median(steps)))
        gaps = np.flatnonzero(~(even & valid[1:] & valid[:-1]))
        if len(gaps):
            del self._run[:int(gaps[-1]) + 1]
            return []
        stamp_ns = int(self._run[_LENGTH - 1][0])
        del self._run[:_BLOCK]
        if not self._blocks:
            self._origin, self._normal = table[0, 1:4], direction_of(table[:, 4:].mean(axis=0))
        block = _block(table, self._origin)
        smooth = sliding_window_view(block.data[:, :3], 2 * _HALF + 1, axis=0) @ _KERNELS[:, 0]
        moves = bool((np.ptp(smooth, axis=0) > _MOVING * np.sqrt(block.variances[:3])).any())
        if moves or not self._moved:
            self._moved = self._moved or moves
            self._blocks = [*self._blocks, block][-_KEPT:]
            self._add(self._blocks[-1:])
            self.estimate, normal = posterior(stamp_ns, self._sums, self._normal, self._timing_std)
            if float(np.linalg.norm(normal - self._normal)) > _TURN:
                self._normal, self._sums = normal, Sums.empty()
                self._add(self._blocks)
        assert self.estimate is not None
        if not moves:
            self.estimate = self.estimate._replace(
                stamp_ns=stamp_ns, status=EstimateStatus.FROZEN, reason='no motion')
        return [self.estimate]

    def _add(self, blocks: Sequence[_Block]) -> None:
        """Add the rows of consecutive blocks to the sums; those before are forgotten by that."""
        steps = np.array([block.step for block in blocks])
        kept = np.exp(-_BLOCK / self._memory_s * np.cumsum(steps[::-1])[::-1])
        weights = np.append(kept[1:], 1.0)
        noise = np.array([block.variances for block in blocks])
        rows = _rows(np.array([block.data for block in blocks]), steps[:, None, None],
                     noise[:, :3].sum(axis=1), self._normal)
        counts = _WEIGHT * rows.shape[1] * weights
        variances = counts @ noise
        scale = steps[-1] ** -np.arange(3.0)
        old, fading = self._sums, float(kept[0])
        self._sums = Sums(
            fading * old.products + np.tensordot(
                _WEIGHT * weights[:, None, None] * rows, rows, ((0, 1), (0, 1))),
            fading * old.spread + np.kron(
                _GRAM * np.outer(scale, scale), np.diag(variances[:3])),
            fading * old.noise + float(_GRAM[0, 0]) * variances,
            fading * old.weight + float(counts.sum()))


def _block(table: Array, origin: Array) -> _Block:
    """Interpolate at equal steps; the noise shows in third differences, the motion does not."""
    t = (table[:, 0] - table[0, 0]) * 1e-9
    grid = np.linspace(0.0, t[-1], len(t))
    data = np.column_stack([np.interp(grid, t, column) for column in table[:, 1:].T])
    data[:, :3] -= origin
    return _Block(data, float(grid[1]), (np.diff(data, 3, axis=0)**2).mean(axis=0) / 20.0)


def _rows(data: Array, step: Array, noise: Array, normal: Array) -> Array:
    """
    Return the rows of blocks, shape (blocks, rows, 25); columns as in `matrix_posterior`.

    Friction N u, with u the direction of sliding, is smoothed like force and position. A lag of
    the sensor delays u, but not the N that it measures itself: hence the column N du/dt.
    """
    inner = slice(_EDGE, -_EDGE)
    v = (data[:, 2 * _EDGE:, :3] - data[:, :-2 * _EDGE, :3]) / (2 * _EDGE * step)
    calm = 2.0 * noise[:, None] / (2 * _EDGE * step[:, 0])**2 + 1e-18  # (blocks, 1)

    def friction(n: Array) -> tuple[Array, Array]:
        along = v - (v @ n)[..., None] * n
        u = along / np.sqrt((along**2).sum(axis=2) + calm)[..., None]
        return np.maximum(data[:, inner, 3:] @ n, 0.0)[..., None], u

    N, u = friction(normal)
    turned = [(np.multiply(*friction(direction_of(normal + _TURN * t))) - N * u) / _TURN
              for t in tangents(normal)]
    columns = np.concatenate([
        data[:, inner, :3], N * u, N * np.gradient(u, axis=1) / step, *turned,
        data[:, inner, 3:]], axis=2)
    smooth = sliding_window_view(columns, 2 * _HALF + 1, axis=1)[:, :_BLOCK:_STEP] @ _KERNELS
    x, others = smooth[..., :3, :], smooth[..., 3:, 0]
    return np.concatenate([
        x[..., 0], x[..., 1] / step, x[..., 2] / step**2, others[..., :-3],
        np.ones((*smooth.shape[:2], 1)), others[..., -3:]], axis=2)


LABELS = ('stiffness', 'stiffness_std', 'damping', 'damping_std')
"""Matrices of the topic `~/stiffness_matrix`, in this order."""

PRINCIPAL_LABELS = ('stiffness', 'stiffness_std', 'x', 'y', 'z', 'angle_std')
"""Columns of the topic `~/principal_stiffness`, in this order."""


def matrices(estimate: MatrixEstimate) -> Array:
    """Return the array of the topic `~/stiffness_matrix`, shape (4, 3, 3), as in LABELS."""
    return np.stack([getattr(estimate, name) for name in LABELS])


def principal_table(estimate: MatrixEstimate) -> Array:
    """Return the array of `~/principal_stiffness`, shape (3, 6), as in PRINCIPAL_LABELS."""
    return np.column_stack([
        estimate.principal, estimate.principal_std, estimate.directions, estimate.direction_std])
