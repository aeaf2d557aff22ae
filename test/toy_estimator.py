# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""An estimator that the library does not have: a gradient step on K_e, with B_e known."""

from dataclasses import dataclass
from math import nan
from typing import Sequence

from contact_estimation.estimators.estimate import Frozen, ParameterEstimate
from contact_estimation.estimators.estimator import OnlineEstimator, TimedRow
from contact_estimation.parameters import parameter, ParameterGroup


@dataclass(frozen=True)
class ToyEstimatorParameters(ParameterGroup):
    """Tuning of `ToyEstimator`."""

    gain: float = parameter(1.0, 'Share of the error removed by one sample', '1', minimum=0.0)


class ToyEstimator(OnlineEstimator):
    """Normalised least mean squares on y = K_e delta + B_e v."""

    Parameters = ToyEstimatorParameters

    def configure(self, tuning: ParameterGroup) -> None:
        """Take new tuning."""
        assert isinstance(tuning, ToyEstimatorParameters)
        self._gain = tuning.gain

    def start_from(self, stiffness: float, damping: float) -> None:
        """Start from given values."""
        self.stiffness, self.damping = stiffness, damping

    def update(
        self, rows: Sequence[TimedRow], noise_variance: float, frozen: Frozen
    ) -> list[ParameterEstimate]:
        """Step once per row."""
        estimates = []
        for _, (y, phi_K, phi_B, *_) in rows:
            error = y - self.stiffness * phi_K - self.damping * phi_B
            self.stiffness += self._gain * error / max(phi_K, 1e-3)
            estimates.append(self.current())
        return estimates

    def current(self) -> ParameterEstimate:
        """Return the present estimate."""
        return ParameterEstimate(self.stiffness, self.damping, nan, nan, 0.0, nan)
