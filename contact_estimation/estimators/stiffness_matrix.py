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

"""Full 3 x 3 stiffness and damping of a contact from three forces and three positions."""

from __future__ import annotations

from dataclasses import dataclass
from math import exp, pi
from typing import NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray

from ..parameters.specification import parameter, ParameterGroup
from ..signals.contact_sample import AxesSample

Array = NDArray[np.float64]

_BLOCK = 50  # rows between estimates
_COLUMNS = 7  # position, velocity, constant
_LEAST_ROWS = 100.0
_NEW_WALL_S = 0.5  # free for so long, the next contact may be with another wall
_UNKNOWN = 1e6  # prior standard deviation of every coefficient, in SI units
_SURE = 0.1  # [rad]
_FRICTION_ANGLE = 0.17  # standard deviation, for a coefficient of friction up to 0.3 [rad]


@dataclass(frozen=True)
class StiffnessMatrixParameters(ParameterGroup):
    """Memory of the estimator of the full matrices."""

    memory_s: float = parameter(
        5.0, 'Time constant in contact after which samples are forgotten', 's',
        minimum=0.1, maximum=1e4,
    )


class MatrixEstimate(NamedTuple):
    """
    Coupled stiffness and damping of a contact; axes in the order x, y, z.

    Attributes
    ----------
    stamp_ns : int
        Stamp of the last sample used [ns].
    stiffness, stiffness_std : ndarray, shape (3, 3)
        -dF_i / dx_j as fitted, not symmetrised [N/m].
    damping, damping_std : ndarray, shape (3, 3)
        -dF_i / dv_j [N s/m].
    principal, principal_std : ndarray, shape (3,)
        Eigenvalues of the symmetric positive part of the stiffness, largest first [N/m].
    directions : ndarray, shape (3, 3)
        Their directions, one a row.
    direction_std : ndarray, shape (3,)
        Standard deviation of the angle of each direction [rad].
    normal : ndarray, shape (3,)
        Unit vector into the wall.
    normal_std : float
        Standard deviation of its angle [rad].

    """

    stamp_ns: int
    stiffness: Array
    stiffness_std: Array
    damping: Array
    damping_std: Array
    principal: Array
    principal_std: Array
    directions: Array
    direction_std: Array
    normal: Array
    normal_std: float


class StiffnessMatrix:
    """
    Least squares with forgetting on -F = K x + B v + c, three forces over the same regressor.

    The constant c = -K x_e makes the locations of the surface along the axes unnecessary: K is
    what the forces change by. Columns that the motion does not excite have large deviations.

    Parameters
    ----------
    parameters : StiffnessMatrixParameters
        Memory.
    sample_period_s : float
        Nominal T [s].

    Attributes
    ----------
    estimate : MatrixEstimate or None
        The last one; None before the first.

    """

    def __init__(self, parameters: StiffnessMatrixParameters, sample_period_s: float) -> None:
        self._p, self._T = parameters, sample_period_s
        self.reset()

    def configure(self, parameters: StiffnessMatrixParameters, sample_period_s: float) -> None:
        """Change memory and nominal T; what has been learned stays."""
        self._p, self._T = parameters, sample_period_s

    def reset(self) -> None:
        """Forget everything."""
        self.estimate: MatrixEstimate | None = None
        self._restart()

    def _restart(self) -> None:
        """Forget the wall; the last estimate stays until there is another."""
        self._products = np.zeros((_COLUMNS + 3, _COLUMNS + 3))  # of rows (x, v, 1, -F)
        self._count = 0.0
        self._rows: list[list[float]] = []
        self._origin: list[float] = []
        self._last: AxesSample | None = None
        self._free_s = 0.0

    def process(self, run: Sequence[AxesSample], contact: Sequence[bool]) -> list[MatrixEstimate]:
        """
        Process consecutive samples of the three axes.

        Parameters
        ----------
        run : sequence of tuple of ContactSample
            Samples of x, y and z with the same stamp.
        contact : sequence of bool
            Whether each is in contact.

        Returns
        -------
        estimates : list of MatrixEstimate
            One for every 50 rows that have come together.

        """
        estimates = []
        for axes, touching in zip(run, contact):
            if not touching:
                self._last = None
                self._free_s += self._T
                if self._free_s > _NEW_WALL_S and self._origin:
                    self._restart()
                continue
            self._free_s = 0.0
            self._add(axes)
            if len(self._rows) == _BLOCK:
                found = self._learn(axes[0].stamp_ns)
                estimates += [found] if found else []
        return estimates

    def _add(self, axes: AxesSample) -> None:
        """Add the row of a sample; from a trapezoid where no velocity is measured."""
        self._origin = self._origin or [sample.position for sample in axes]
        x = [sample.position - x_0 for sample, x_0 in zip(axes, self._origin)]
        v, y = [sample.velocity for sample in axes], [-sample.force for sample in axes]
        last, self._last = self._last, axes
        if any(rate != rate for rate in v):
            dt = (axes[0].stamp_ns - last[0].stamp_ns) * 1e-9 if last else 0.0
            if last is None or not 0.0 < dt <= 1.5 * self._T:
                return
            steps = [now.position - old.position for now, old in zip(axes, last)]
            x = [now - 0.5 * step for now, step in zip(x, steps)]
            v = [step / dt for step in steps]
            y = [-0.5 * (now.force + old.force) for now, old in zip(axes, last)]
        self._rows.append([*x, *v, 1.0, *y])

    def _learn(self, stamp_ns: int) -> MatrixEstimate | None:
        rows = np.array(self._rows)
        self._rows = []
        kept = exp(-_BLOCK * self._T / self._p.memory_s)
        self._products = kept * self._products + rows.T @ rows
        self._count = kept * self._count + _BLOCK
        if self._count < _LEAST_ROWS:
            return None
        self.estimate = matrix_estimate(stamp_ns, self._products, self._count)
        return self.estimate


def matrix_estimate(stamp_ns: int, products: Array, count: float) -> MatrixEstimate:
    """
    Solve for the matrices.

    The covariance of K_ij and K_kl is S_ik P_jl, with S the covariance of the residuals and P the
    inverse of the regressors' products.

    Parameters
    ----------
    stamp_ns : int
        Of the last sample [ns].
    products : ndarray, shape (10, 10)
        Sum of row^T row, rows (x, v, 1, -F).
    count : float
        Effective number of rows.

    Returns
    -------
    estimate : MatrixEstimate
        With deviations.

    """
    A, C = products[:_COLUMNS, :_COLUMNS], products[:_COLUMNS, _COLUMNS:]
    scale = np.sqrt(np.maximum(A.diagonal(), 1e-18))
    scales = np.outer(scale, scale)
    # A weak prior keeps what is not excited finite: with the noise of the residuals, at last.
    S = np.eye(3)
    for _ in range(2):
        prior = np.eye(_COLUMNS) * float(np.trace(S)) / 3.0 / _UNKNOWN**2
        P = np.linalg.inv((A + prior) / scales) / scales
        theta = P @ C
        S = products[_COLUMNS:, _COLUMNS:] - theta.T @ C
        S = 0.5 * (S + S.T) / max(count - _COLUMNS, 1.0)  # (3, 3) [N^2]
        S += np.eye(3) * max(1e-12 * float(np.trace(products[_COLUMNS:, _COLUMNS:])) / count,
                             1e-18)
    K, B = theta[:3].T, theta[3:6].T
    std = np.sqrt(np.maximum(np.outer(S.diagonal(), P.diagonal()[:6]), 0.0))  # (3, 6)
    values, stds, directions, angles = principal_directions(K, S, P[:3, :3])
    normal, normal_std = _normal(values, directions, angles, C[6])
    return MatrixEstimate(
        stamp_ns, K, std[:, :3], B, std[:, 3:], values, stds, directions, angles, normal,
        normal_std,
    )


def principal_directions(K: Array, S: Array, P: Array) -> tuple[Array, Array, Array, Array]:
    """
    Decompose the symmetric positive part of a stiffness.

    Parameters
    ----------
    K : ndarray, shape (3, 3)
        Stiffness [N/m].
    S, P : ndarray, shape (3, 3)
        Covariances: that of K_ij and K_kl is S_ik P_jl.

    Returns
    -------
    values, stds : ndarray, shape (3,)
        Principal stiffnesses, largest first, and their standard deviations [N/m].
    directions : ndarray, shape (3, 3)
        One a row.
    angles : ndarray, shape (3,)
        Standard deviation of the angle of each; at most pi / 2 [rad].

    """
    values, vectors = np.linalg.eigh(0.5 * (K + K.T))
    values, vectors = values[::-1], vectors[:, ::-1]
    s, p = vectors.T @ S @ vectors, vectors.T @ P @ vectors
    # Of v_i^T (K + K^T) v_j / 2.
    ends = np.outer(s.diagonal(), p.diagonal())
    variances = 0.25 * (ends + ends.T + 2.0 * s * p)  # (3, 3)
    gaps = values[:, None] - values[None, :]
    with np.errstate(divide='ignore', invalid='ignore'):
        turns = np.where(gaps == 0.0, pi**2, variances / gaps**2)
    np.fill_diagonal(turns, 0.0)
    angles = np.minimum(np.sqrt(np.minimum(turns, pi**2).sum(axis=1)), 0.5 * pi)
    stds = np.sqrt(np.maximum(variances.diagonal(), 0.0))
    return np.maximum(values, 0.0), stds, vectors.T, angles


def _normal(
    values: Array, directions: Array, angles: Array, force: Array
) -> tuple[Array, float]:
    """
    Return the direction into the wall and the standard deviation of its angle.

    The stiffest direction, where force and motion determine it; else that of the mean force,
    which friction may tilt.

    """
    pressing = force / max(float(np.linalg.norm(force)), 1e-12)
    angle = float(angles[0])
    if angle > _SURE or values[0] < 2.0 * values[1]:
        return pressing, _FRICTION_ANGLE
    sign = 1.0 if float(directions[0] @ pressing) >= 0.0 else -1.0
    return sign * directions[0], angle


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
        estimate.principal, estimate.principal_std, estimate.directions, estimate.direction_std,
    ])
