# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Signal processing by a fit of the whole decay instead of FFT bins."""

from math import pi, sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .offline_estimator import OfflineEstimate, OfflineEstimator, TargetImpedance
from .signal_processing import dominant_frequency, environment_of, step_response
from ..exceptions import EstimationError
from ..signals.contact_sample import ContactRecording

_SKIPPED_S = 0.01
"""Skipped after the step, which may extend over some samples."""


class SignalProcessingRefined(OfflineEstimator):
    """
    Fit F(t) = c + exp(-sigma t) (a cos w_d t + b sin w_d t) to the whole step response.

    After a step, force and motion of the joint second-order system of eqs. (12) to (14) have this
    form exactly. The free offset c absorbs a sensor bias; a robust loss reduces the influence of
    outliers. The linear c, a and b are eliminated (variable projection).
    """

    name = 'signal_processing_refined'

    def __init__(self, target: TargetImpedance) -> None:
        self._target = target

    def estimate(self, recording: ContactRecording) -> OfflineEstimate:
        """Fit the decay; see `OfflineEstimator.estimate`."""
        t, force = step_response(recording)
        late = t > _SKIPPED_S
        t, force = t[late], force[late]
        guess = dominant_frequency(t, force)
        scale = float(np.std(force - np.mean(force))) or 1.0
        fits = [self._fit(t, force, w, 0.3 * w, scale) for w in (0.8 * guess, guess, 1.2 * guess)]
        best = min(fits, key=lambda fit: float(fit.cost))
        w_d, decay = (float(abs(p)) for p in best.x)
        if not w_d > 2.0 * pi / float(t[-1]) or not decay > 0.0:
            raise EstimationError(
                'signal processing needs an under-damped step response, got one without '
                'oscillation; choose a softer or less damped target impedance')
        w_n = sqrt(w_d**2 + decay**2)
        K_e, B_e = environment_of(w_n, decay / w_n, self._target)
        return OfflineEstimate(K_e, B_e, *self._spread(t, force, w_d, decay))

    @staticmethod
    def _fit(
        t: NDArray[np.float64], force: NDArray[np.float64], w_d: float, decay: float, scale: float
    ) -> Any:
        from scipy.optimize import least_squares  # slow to import, and no node needs it

        return least_squares(
            lambda p: force - fitted(t, force, float(p[0]), float(p[1])), (w_d, decay),
            loss='soft_l1', f_scale=0.5 * scale, x_scale=(w_d, decay))

    def _spread(
        self, t: NDArray[np.float64], force: NDArray[np.float64], w_d: float, decay: float
    ) -> tuple[float, float]:
        """Propagate the residual through the fit to K_e and B_e."""
        basis, (_, a, b) = decomposition(t, force, w_d, decay)
        residual = force - fitted(t, force, w_d, decay)
        envelope, phase = np.exp(-decay * t), w_d * t
        by_w = envelope * t * (b * np.cos(phase) - a * np.sin(phase))
        by_decay = -t * envelope * (a * np.cos(phase) + b * np.sin(phase))
        jacobian = np.column_stack([by_w, by_decay, basis])
        variance = float(residual @ residual) / (len(t) - 5)
        covariance = variance * np.linalg.inv(jacobian.T @ jacobian)[:2, :2]
        # K_e = M_t (w_d^2 + sigma^2) - K_t, B_e = 2 M_t sigma - B_t
        M_t = self._target.mass
        to_K, to_B = np.array([2.0 * M_t * w_d, 2.0 * M_t * decay]), np.array([0.0, 2.0 * M_t])
        return sqrt(to_K @ covariance @ to_K), sqrt(to_B @ covariance @ to_B)


def decomposition(
    t: NDArray[np.float64], force: NDArray[np.float64], w_d: float, decay: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """
    Return offset and amplitudes at given frequency and decay, by linear least squares.

    t, force (N,): time [s] and force [N]
    w_d, decay: frequency [rad/s] and decay rate [1/s]
    Returns basis (N, 3): 1, decaying cosine, decaying sine
    Returns amplitudes (3,): c, a, b [N]
    """
    envelope = np.exp(-abs(decay) * t)
    basis = np.column_stack(
        [np.ones_like(t), envelope * np.cos(w_d * t), envelope * np.sin(w_d * t)])
    return basis, np.linalg.lstsq(basis, force, rcond=None)[0]


def fitted(
    t: NDArray[np.float64], force: NDArray[np.float64], w_d: float, decay: float
) -> NDArray[np.float64]:
    """
    Return the best-fitting response of given frequency and decay, as `decomposition`.

    Returns response (N,): force [N]
    """
    basis, amplitudes = decomposition(t, force, w_d, decay)
    response: NDArray[np.float64] = basis @ amplitudes
    return response
