# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Instrumental variables: estimates that position noise does not bias."""

from collections import deque
from dataclasses import dataclass
from math import exp, nan, sqrt
from typing import Sequence

from .estimate import Frozen, new_tuple, ParameterEstimate
from .estimator import OnlineEstimator, TimedRow
from ..parameters import parameter, ParameterGroup
from ..signals.relations import Row

_SMALLEST = 1e-18
_LEAST_DETERMINANT = 0.25  # of a d: with instruments nearly out of phase, errors are not normal
_LARGEST_RELATIVE_STD = 0.5  # above which a solution is rejected


@dataclass(frozen=True)
class InstrumentalVariableParameters(ParameterGroup):
    """Instruments and memory."""

    delay_s: float = parameter(
        0.02,
        'Delay of the instruments: longer than 1 / conditioning.cutoff_frequency, over which '
        'filtered noise is correlated, and shorter than the time scale of the motion',
        's', minimum=0.0, maximum=1.0)
    memory_s: float = parameter(
        2.0, 'Time constant of forgetting; larger: smoother, slower', 's', minimum=1e-3,
        maximum=1e6)
    stiffness_std: float = parameter(
        1e5, 'Prior standard deviation of K_e', 'N/m', minimum=1e-3, maximum=1e12)
    damping_std: float = parameter(
        1e4, 'Prior standard deviation of B_e', 'N s/m', minimum=1e-3, maximum=1e12)


class InstrumentalVariable(OnlineEstimator):
    """
    Least squares whose normal equations are formed with delayed regressors.

    Noise of the differentiated position is part of the regressor: sum phi phi^T grows by its
    power and least squares biases B_hat towards 0 (errors in variables). With instruments z that
    are correlated with the motion but not with the noise, sum z (y - phi^T theta) = 0 has no such
    bias (Soderstrom and Stoica, Instrumental Variable Methods for System Identification, 1983).
    Filtered white noise is uncorrelated beyond the memory of the filter, motion is not, so z is
    phi delayed by `delay_s`.

    The sums are kept and the equations solved for each row, so that no gain can grow where z and
    phi are out of phase. The covariance is sigma^2 A^-1 (sum z z^T) A^-T, A = sum z phi^T. The
    equation of a frozen parameter neither adds rows nor forgets.
    """

    Parameters = InstrumentalVariableParameters

    def configure(self, tuning: ParameterGroup) -> None:
        """Set new tuning; see `OnlineEstimator.configure`."""
        assert isinstance(tuning, InstrumentalVariableParameters)
        self._p = tuning
        self._keep = exp(-self.sample_period_s / tuning.memory_s)
        lag = round(tuning.delay_s / self.sample_period_s) + 1
        self._past: deque[Row] = deque(getattr(self, '_past', ()), maxlen=lag)

    def start_from(self, stiffness: float, damping: float) -> None:
        """Restart with the prior; see `OnlineEstimator.start_from`."""
        self._past.clear()
        self.restart(stiffness, damping, self._p.stiffness_std, self._p.damping_std)

    def restart(
        self, stiffness: float, damping: float, stiffness_std: float, damping_std: float
    ) -> None:
        """Forget all equations, with another prior; see `OnlineEstimator.restart`."""
        self.stiffness, self.damping = stiffness, damping
        self._start = stiffness, damping
        # Equations of K and B: (z phi_K, z phi_B, z y); then z z^T: (KK, KB, BB).
        self._of_K, self._of_B = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        self._Z = 0.0, 0.0, 0.0
        self._prior_std = self._std = stiffness_std, damping_std

    def update(
        self, rows: Sequence[TimedRow], noise_variance: float, frozen: Frozen
    ) -> list[ParameterEstimate]:
        """Add each row to the equations and solve them; see `OnlineEstimator.update`."""
        variance, past, lag = max(noise_variance, _SMALLEST), self._past, self._past.maxlen
        estimates = []
        for _, row in rows:
            past.append(row)
            if len(past) == lag:
                self._add(row, past[0], frozen)
                self._solve(variance, frozen)
            estimates.append(self.current())
        return estimates

    def _add(self, row: Row, instrument: Row, frozen: Frozen) -> None:
        y, f_K, f_B = row[0], row[1], row[2]
        z_K, z_B, keep = instrument[1], instrument[2], self._keep
        K_frozen, B_frozen = frozen
        g_K, g_B = 1.0 if K_frozen else keep, 1.0 if B_frozen else keep
        KK, KB, BB = self._Z
        KK, KB, BB = g_K * g_K * KK, g_K * g_B * KB, g_B * g_B * BB
        if not K_frozen:
            a, b, c = self._of_K
            self._of_K = keep * a + z_K * f_K, keep * b + z_K * f_B, keep * c + z_K * y
            KK += z_K * z_K
        if not B_frozen:
            a, b, c = self._of_B
            self._of_B = keep * a + z_B * f_K, keep * b + z_B * f_B, keep * c + z_B * y
            BB += z_B * z_B
            if not K_frozen:
                KB += z_K * z_B
        self._Z = KK, KB, BB

    def _solve(self, variance: float, frozen: Frozen) -> None:
        """Solve for both, or for the excited one with the present value of the other."""
        if not (frozen.stiffness or frozen.damping) and self._solve_both(variance):
            return
        if not frozen.stiffness:
            (K_0, _), (a, b, c), r = self._start, self._of_K, variance / self._prior_std[0] ** 2
            K = (c - b * self.damping + r * K_0) / (a + r) if a > -r else -1.0
            # The damping in the equation has an error of its own.
            spread = self._Z[0] * variance + r * variance + (b * self._std[1]) ** 2
            std = sqrt(spread) / abs(a + r) if a > -r else 0.0
            if K > 0.0 and std < _LARGEST_RELATIVE_STD * K:
                self.stiffness, _ = self.within_limits(K, self.damping)
                self._std = std, self._std[1]
        elif not frozen.damping:
            (_, B_0), (a, b, c), r = self._start, self._of_B, variance / self._prior_std[1] ** 2
            B = (c - a * self.stiffness + r * B_0) / (b + r) if b > -r else -1.0
            spread = self._Z[2] * variance + r * variance + (a * self._std[0]) ** 2
            std = sqrt(spread) / abs(b + r) if b > -r else 0.0
            if B >= 0.0 and std < self._largest_std(B):
                _, self.damping = self.within_limits(self.stiffness, B)
                self._std = self._std[0], std

    def _solve_both(self, variance: float) -> bool:
        (K_0, B_0), (K_std, B_std) = self._start, self._prior_std
        r_K, r_B = variance / (K_std * K_std), variance / (B_std * B_std)
        (a, b, y_K), (c, d, y_B) = self._of_K, self._of_B
        a, d, y_K, y_B = a + r_K, d + r_B, y_K + r_K * K_0, y_B + r_B * B_0
        determinant = a * d - b * c
        if not (a > 0.0 and d > 0.0 and determinant > _LEAST_DETERMINANT * a * d):
            return False
        K, B = (d * y_K - b * y_B) / determinant, (a * y_B - c * y_K) / determinant
        KK, KB, BB = self._Z
        KK, BB = KK + r_K, BB + r_B
        scale, KB = sqrt(variance) / determinant, 2.0 * KB
        std_K = scale * sqrt(max(d * (d * KK - b * KB) + b * b * BB, 0.0))
        std_B = scale * sqrt(max(c * (c * KK - a * KB) + a * a * BB, 0.0))
        if B < 0.0 or std_K > _LARGEST_RELATIVE_STD * K or std_B > self._largest_std(B):
            return False
        self.stiffness, self.damping = self.within_limits(K, B)
        self._std = std_K, std_B
        return True

    def _largest_std(self, damping: float) -> float:
        return _LARGEST_RELATIVE_STD * max(damping, self.damping, self.environment.initial_damping)

    def current(self) -> ParameterEstimate:
        """Return the present estimate; see `OnlineEstimator.current`."""
        K_std, B_std = self._std
        return new_tuple(ParameterEstimate, (self.stiffness, self.damping, K_std, B_std, 0.0, nan))
