# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Kalman filter for K_e, B_e and the location of the wall."""

from dataclasses import dataclass
from math import copysign, inf, nan, sqrt
from typing import Sequence

from .estimate import Frozen, new_tuple, ParameterEstimate
from .estimator import OnlineEstimator, TimedRow
from .three_states import constrain, correct, Covariance, diagonal, State
from ..parameters import parameter, ParameterGroup

_FURTHEST = 5.0  # standard deviations of the location from its prior


@dataclass(frozen=True)
class KalmanParameters(ParameterGroup):
    """Prior and random walk of the state (K_e, B_e, K_e times location shift)."""

    stiffness_std: float = parameter(
        1e5, 'Prior standard deviation of K_e', 'N/m', minimum=1e-3, maximum=1e12)
    damping_std: float = parameter(
        1e4, 'Prior standard deviation of B_e', 'N s/m', minimum=1e-3, maximum=1e12)
    location_std: float = parameter(
        0.0,
        'Prior standard deviation of the wall location about the one known or found so far, which '
        'the filter then estimates together with K_e; a lag of the force biases both. 0: found '
        'as for every estimator, see environment.location_std', 'm', minimum=0.0)
    relative_walk: float = parameter(
        0.002,
        'Random walk of K_e and B_e relative to their values; larger: follows changes faster, '
        'noisier', '1/sqrt(s)', minimum=0.0)
    location_walk: float = parameter(1e-6, 'Random walk of the location', 'm/sqrt(s)', minimum=0.0)
    resting_speed: float = parameter(
        0.0,
        'No update while the velocity is below this: static friction, which is not compensated, '
        'may carry part of the force; 0: always updated', 'm/s', minimum=0.0)


class Kalman(OnlineEstimator):
    """
    Random-walk Kalman filter on y = K_e delta + B_e v - (K_e s), s the shift of the wall.

    Estimating the product K_e s keeps the measurement linear in the state, so that the filter is
    exact; s itself follows as a quotient. The covariance is
    consistent as long as the force noise is white before conditioning.

    A frozen parameter is a consider parameter (Schmidt): its value and covariance stay, without
    random walk, and its uncertainty enters the others. If B_e were treated as known, a wrong
    initial value would bias K_hat.
    """

    Parameters = KalmanParameters

    def configure(self, tuning: ParameterGroup) -> None:
        """Set new tuning; see `OnlineEstimator.configure`."""
        assert isinstance(tuning, KalmanParameters)
        self._p = tuning

    def start_from(self, stiffness: float, damping: float) -> None:
        """Restart with the prior; see `OnlineEstimator.start_from`."""
        p = self._p
        scale = max(stiffness, self.environment.initial_stiffness)
        self._x: State = stiffness, damping, 0.0
        self._P = diagonal(p.stiffness_std, p.damping_std, p.location_std * scale)
        self._keep_within_limits()

    def restart(
        self, stiffness: float, damping: float, stiffness_std: float, damping_std: float
    ) -> None:
        """Restart with another prior; x_e stays. See `OnlineEstimator.restart`."""
        self._x = stiffness, damping, self._shift * stiffness
        self._P = diagonal(stiffness_std, damping_std, self._p.location_std * stiffness)
        self._keep_within_limits()

    def update(
        self, rows: Sequence[TimedRow], noise_variance: float, frozen: Frozen
    ) -> list[ParameterEstimate]:
        """Predict and correct for each row; see `OnlineEstimator.update`."""
        estimates = []
        resting_speed, locates = self._p.resting_speed, self._p.location_std > 0.0
        free = (not frozen.stiffness, not frozen.damping, not frozen.stiffness and locates)
        variance = max(noise_variance, 1e-18)
        K_low, K_high, B_high = self.environment.limits
        for dt, row in rows:
            y, f_K, f_B, f_c = row[:4]
            if abs(f_B) >= resting_speed:
                K, B, f = x = self._x
                error = y - K * f_K - B * f_B + f * f_c
                x, self._P, _ = correct(
                    x, self._walked(dt, free), (f_K, f_B, -f_c), error, variance, free)
                self._x = x
                if locates or not (K_low <= x[0] <= K_high and 0.0 <= x[1] <= B_high):
                    self._keep_within_limits()
                else:
                    self.stiffness, self.damping, _ = x
            estimates.append(self.current())
        return estimates

    def _walked(self, dt: float, free: tuple[bool, bool, bool]) -> Covariance:
        """Return the covariance after the random walk over a time."""
        p, (aa, ab, ac, bb, bc, cc), K = self._p, self._P, self.stiffness
        if free[0]:
            step = p.relative_walk * K
            aa += step * step * dt
        if free[1]:
            B, least = self.damping, self.environment.initial_damping
            step = p.relative_walk * (B if B > least else least)
            bb += step * step * dt
        if free[2]:
            cc += (p.location_walk * K) ** 2 * dt
        return aa, ab, ac, bb, bc, cc

    def _keep_within_limits(self) -> None:
        """Project onto the limits along the covariance, which moves the other states too."""
        K_low, K_high, B_high = self.environment.limits
        K, B, f = self._x
        if not (K_low <= K <= K_high and 0.0 <= B <= B_high):
            x = constrain(self._x, self._P, (1.0, 0.0, 0.0), K_low, K_high)
            self._x = K, B, f = constrain(x, self._P, (0.0, 1.0, 0.0), 0.0, B_high)
        furthest = copysign(_FURTHEST * self._p.location_std, f)
        if (f - furthest * K) * furthest > 0.0:  # x_e is anchored to its prior
            low, high = (-inf, 0.0) if furthest > 0.0 else (0.0, inf)
            self._x = K, B, f = constrain(self._x, self._P, (-furthest, 0.0, 1.0), low, high)
        self.stiffness, self.damping = self.within_limits(K, B)
        self._shift = f / self.stiffness

    def current(self) -> ParameterEstimate:
        """Return the present estimate; see `OnlineEstimator.current`."""
        KK, _, _, BB, _, _ = self._P
        return new_tuple(ParameterEstimate, (
            self.stiffness, self.damping, sqrt(KK) if KK > 0.0 else 0.0,
            sqrt(BB) if BB > 0.0 else 0.0, self._shift, nan))
