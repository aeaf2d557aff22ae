# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""What an error of the force that lasts, unlike noise, does to K_hat and B_hat."""

from __future__ import annotations

from math import hypot
from typing import Sequence

import numpy as np
from numpy.typing import NDArray

from ..estimators.estimate import ParameterEstimate

_FIRST = 5  # samples of contact


class LastingError:
    """
    Widen the deviations of K_hat and B_hat by those of errors of F_e that are no white noise.

    An error e of the force changes the least-squares coefficients of x and v, with an intercept
    for each contact, by cov((x, v))^-1 cov((x, v), e), and without one, where the surface is
    known, by the same of moments about the surface: the larger counts. Errors of several causes,
    each given with the course that one standard deviation of its size has, add in squares.
    """

    def __init__(self) -> None:
        self._means: NDArray[np.float64] | None = None
        self._sums: NDArray[np.float64] | None = None  # about the means, and about the surface
        self._own = self._count = 0

    def end(self) -> None:
        """End a contact."""
        self._own = 0

    def add(self, d: float, v: float, errors: Sequence[float]) -> None:
        """Add a sample in contact: depth [m], its rate [m/s] and each error [N]."""
        row = np.array([d, v, *errors])
        if self._sums is None or self._sums.shape[1] != len(row):
            self._sums, self._own, self._count = np.zeros((2, len(row), len(row))), 0, 0
        if not self._own or self._means is None:
            self._means = np.zeros(len(row))
        self._own += 1
        self._count += 1
        off = row - self._means
        self._means = self._means + off / self._own
        self._sums += np.outer(off, row - self._means), np.outer(row, row)

    def widened(self, estimate: ParameterEstimate) -> ParameterEstimate:
        """Return an estimate with wider deviations; unchanged where there was no error."""
        if self._sums is None or self._count < _FIRST:
            return estimate
        least = np.diag([1e-15, 1e-12])
        by_K, by_B = np.max([np.linalg.norm(np.linalg.solve(
            sums[:2, :2] + least, sums[:2, 2:]), axis=1) for sums in self._sums], axis=0)
        return estimate._replace(stiffness_std=hypot(estimate.stiffness_std, by_K),
                                 damping_std=hypot(estimate.damping_std, by_B))
