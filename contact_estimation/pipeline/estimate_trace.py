# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The estimates of a recording of any length, thinned for a picture."""

from __future__ import annotations

from typing import Sequence

import numpy as np
from numpy.typing import NDArray

from .result import AxesEstimates
from ..estimators.stiffness_matrix import MatrixEstimate

ESTIMATES = ('stiffness', 'damping', 'stiffness_std', 'damping_std')
_MOST = 20_000  # points kept: more than a picture shows


class EstimateTrace:
    """Collect estimates of the contact axis; long recordings are thinned evenly."""

    def __init__(self) -> None:
        self._rows: list[tuple[float, ...]] = []
        self._count, self._stride = 0, 1

    def write(self, estimates: Sequence[AxesEstimates]) -> None:
        """Take the estimates of consecutive samples."""
        for contact, *_ in estimates[-self._count % self._stride::self._stride]:
            values = (getattr(contact, name) for name in ESTIMATES)
            self._rows.append((contact.stamp_ns, *values))
        self._count += len(estimates)
        while len(self._rows) > _MOST:
            self._rows, self._stride = self._rows[::2], 2 * self._stride

    def write_matrices(self, estimates: Sequence[MatrixEstimate]) -> None:
        """Leave out estimates of coupled axes."""

    def series(self, begin_ns: int) -> dict[str, NDArray[np.float64]]:
        """
        Return the estimates over time.

        begin_ns: stamp of time 0 [ns]
        Returns series (N, 2): time [s] and value of each of `ESTIMATES`; empty without any
        estimate
        """
        if not self._rows:
            return {}
        stamps = np.array([row[0] for row in self._rows], np.int64)
        t = (stamps - begin_ns) * 1e-9
        return {name: np.column_stack((t, [row[place] for row in self._rows]))
                for place, name in enumerate(ESTIMATES, 1)}
