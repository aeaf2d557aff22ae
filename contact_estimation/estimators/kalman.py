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

"""Kalman filter for K_e, B_e and the location of the wall."""

from __future__ import annotations

from dataclasses import dataclass
from math import nan, sqrt
from typing import Sequence

import numpy as np

from .estimator import Frozen, OnlineEstimator, ParameterEstimate, TimedRow
from ..parameters.specification import parameter, ParameterGroup
from ..signals.relations import Row


@dataclass(frozen=True)
class KalmanParameters(ParameterGroup):
    """Prior and random walk of the state (K_e, B_e, K_e times location shift)."""

    stiffness_std: float = parameter(
        1e5, 'Prior standard deviation of K_e', 'N/m', minimum=1e-3, maximum=1e12
    )
    damping_std: float = parameter(
        1e4, 'Prior standard deviation of B_e', 'N s/m', minimum=1e-3, maximum=1e12
    )
    location_std: float = parameter(
        1e-4,
        'Prior standard deviation of the wall location about environment.location; 0: known',
        'm', minimum=0.0,
    )
    relative_walk: float = parameter(
        0.002,
        'Random walk of K_e and B_e relative to their values; larger: follows changes faster, '
        'noisier', '1/sqrt(s)', minimum=0.0,
    )
    location_walk: float = parameter(
        1e-6, 'Random walk of the location', 'm/sqrt(s)', minimum=0.0
    )
    resting_speed: float = parameter(
        0.0,
        'No update while the velocity is below this: static friction, which is not compensated, '
        'may carry part of the force; 0: always updated', 'm/s', minimum=0.0,
    )


class Kalman(OnlineEstimator):
    """
    Random-walk Kalman filter on y = K_e delta + B_e v - (K_e s), s the shift of the wall.

    Estimating the product K_e s keeps the measurement linear in the state, so that the filter is
    exact; s itself follows as a quotient. The algebra is that of filterpy; the covariance is
    consistent as long as the force noise is white before conditioning.

    A frozen parameter is a consider parameter (Schmidt): its value and covariance stay, without
    random walk, and its uncertainty enters the others. If B_e were treated as known, a wrong
    initial value would bias K_hat.

    """

    Parameters = KalmanParameters
    estimates_location = True

    def configure(self, tuning: ParameterGroup) -> None:
        """Set new tuning; see `OnlineEstimator.configure`."""
        assert isinstance(tuning, KalmanParameters)
        self._p = tuning

    def start_from(self, stiffness: float, damping: float) -> None:
        """Restart with the prior; see `OnlineEstimator.start_from`."""
        # Imported here since it loads scipy.stats, which dominates the import time.
        from filterpy.kalman import KalmanFilter

        p = self._p
        self._filter = KalmanFilter(dim_x=3, dim_z=1)
        self._filter.x = np.array([[stiffness], [damping], [0.0]])
        shift_std = p.location_std * max(stiffness, self.environment.initial_stiffness)
        self._filter.P = np.diag([p.stiffness_std**2, p.damping_std**2, shift_std**2])
        self._filter.F = np.eye(3)
        self._read_state()

    def update(
        self, rows: Sequence[TimedRow], noise_variance: float, frozen: Frozen
    ) -> list[ParameterEstimate]:
        """Predict and correct for each row; see `OnlineEstimator.update`."""
        estimates = []
        resting_speed = self._p.resting_speed
        for dt, row in rows:
            if abs(row[2]) >= resting_speed:
                self._update(dt, row, noise_variance, frozen)
            estimates.append(self.current())
        return estimates

    def _update(self, dt: float, row: Row, noise_variance: float, frozen: Frozen) -> None:
        state = self._filter
        free = np.array(
            [not frozen.stiffness, not frozen.damping,
             not frozen.stiffness and self._p.location_std > 0]
        )
        state.predict(Q=np.diag(self._walk(dt) * free))
        before = state.x[~free].copy(), state.P[np.ix_(~free, ~free)].copy()
        H = np.array([[row[1], row[2], -row[3]]])
        state.update(row[0], R=max(noise_variance, 1e-18), H=H)
        # Schmidt-Kalman filter: a frozen parameter is a consider parameter. Value and covariance
        # stay; its uncertainty has reduced the gain of the others.
        state.x[~free], state.P[np.ix_(~free, ~free)] = before
        self._read_state()

    def _walk(self, dt: float) -> np.ndarray:
        p = self._p
        scale_B = max(self.damping, self.environment.initial_damping)
        rates = np.array(
            [
                p.relative_walk * self.stiffness,
                p.relative_walk * scale_B,
                p.location_walk * self.stiffness,
            ]
        )
        return rates**2 * dt

    def _read_state(self) -> None:
        limits = self.environment
        self._keep_within(0, limits.minimum_stiffness, limits.maximum_stiffness)
        self._keep_within(1, 0.0, limits.maximum_damping)
        K, B, shift_force = self._filter.x[:, 0].tolist()
        self.stiffness, self.damping = self.within_limits(K, B)
        self._shift = shift_force / self.stiffness

    def _keep_within(self, index: int, low: float, high: float) -> None:
        """Project onto a limit along the covariance, which moves the other states too."""
        x, P = self._filter.x, self._filter.P
        value = float(x[index, 0])
        excess = value - min(max(value, low), high)
        if excess != 0.0:
            self._filter.x = x - P[:, [index]] * (excess / P[index, index])

    def current(self) -> ParameterEstimate:
        """Return the present estimate; see `OnlineEstimator.current`."""
        P = self._filter.P
        return ParameterEstimate(
            self.stiffness, self.damping, sqrt(max(float(P[0, 0]), 0.0)),
            sqrt(max(float(P[1, 1]), 0.0)), self._shift, nan,
        )

    @property
    def location_std(self) -> float | None:
        """Prior standard deviation of the wall's location [m]."""
        return self._p.location_std
