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

"""Residual directions that model uncertainty could explain, weighed down."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

LEAST_VARIANCE = 0.02
"""Least variance along a direction, in that of the noise: of less a hundredth were taken away."""


@dataclass(frozen=True, eq=False)
class Discount:
    """
    The whitening of residuals r with covariance I + C C^T, C the columns given to `of`.

    Attributes
    ----------
    directions : ndarray, shape (R, C)
        Orthonormal.
    shares : ndarray, shape (C,)
        The part of the residuals along each direction that is taken away, 0 to 1.

    """

    directions: Array
    shares: Array

    @classmethod
    def of(cls, columns: Array) -> 'Discount':
        """Discount what uncertain parameters could explain."""
        squares, turns = np.linalg.eigh(columns.T @ columns)
        large = squares > LEAST_VARIANCE
        directions = columns @ (turns[:, large] / np.sqrt(squares[large]))
        return cls(directions, 1.0 - 1.0 / np.sqrt(1.0 + squares[large]))

    def apply(self, residuals: Array) -> Array:
        """Whiten residuals."""
        return residuals - self.directions @ (self.shares * (self.directions.T @ residuals))
