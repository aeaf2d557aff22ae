# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The full matrices of a contact beside the estimates of the single axes."""

from __future__ import annotations

from collections import deque
from typing import Any

from .matrix_messages import status_text
from .parameters import EstimationParameters
from .result import AxesEstimates
from ..estimators import MATRIX_ESTIMATORS
from ..estimators.estimate import EstimateStatus
from ..estimators.stiffness_matrix import MatrixEstimate
from ..signals.contact_sample import AxesSample

_MOST_WAITING = 1000  # that nobody has taken


class MatrixEstimation:
    """
    Estimate the matrices from the samples of a session, where its parameters say so.

    runs: whether the parameters name a matrix estimator
    """

    def __init__(self, parameters: EstimationParameters) -> None:
        self.last: MatrixEstimate | None = None
        self._contact = False
        self.runs = parameters.matrix_estimator in MATRIX_ESTIMATORS
        self._new: deque[MatrixEstimate] = deque(maxlen=_MOST_WAITING)
        self._estimator: Any = None
        if self.runs:
            self._estimator = MATRIX_ESTIMATORS[parameters.matrix_estimator](
                parameters.stiffness_matrix, parameters.synchronisation.timing_std)
            self._order = [list(parameters.joints).index(axis) for axis in 'xyz']

    def configure(self, parameters: EstimationParameters) -> None:
        """Set new parameters while running."""
        if self._estimator:
            self._estimator.configure(
                parameters.stiffness_matrix, parameters.synchronisation.timing_std)

    def reset(self) -> None:
        """Forget everything."""
        self.last, self._contact = None, False
        self._new.clear()
        if self._estimator:
            self._estimator.reset()

    def process(self, axes: AxesSample, estimates: AxesEstimates) -> None:
        """Process the next sample; the contact axis decides on contact."""
        ordered = tuple(axes[k] for k in self._order)
        self._contact = estimates[0].status is not EstimateStatus.FREE
        found = self._estimator.process([ordered], [self._contact])
        self._new += found
        self.last = found[-1] if found else self.last

    @property
    def status(self) -> str:
        """Return `free`, or the status and reason of the last estimate."""
        if not self._contact:
            return EstimateStatus.FREE.value
        return status_text(self.last) if self.last else 'frozen: the contact is still too short'

    def take(self) -> list[MatrixEstimate]:
        """Return the estimates made since the last call."""
        found = list(self._new)
        self._new.clear()
        return found
