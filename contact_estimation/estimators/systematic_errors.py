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

"""Errors of the estimates that are not noise: timing, a wrong model, a wall not yet followed."""

from __future__ import annotations

from math import isfinite, nan, sqrt
from typing import NamedTuple, Sequence

from .estimate import Frozen
from .estimator import OnlineEstimator, UNKNOWN_DAMPING_S
from .row_sums import sum_of, Window
from .wall_fit import fit_first_contact, shift_by_lag, wall_of
from .window_fit import fit_window, WindowFits

_LOCATION = 3  # column of a row
_SMOOTHING = 0.2  # per judgement, of the correlation: ten blocks determine it poorly
_FADING = 0.97  # per judgement, of the spread of depths from which B was learned
_AGREES = 3.0  # standard deviations by which estimate and window may differ
_EXPLAINED = 2.0  # times the known noise: a larger residual is an error of the model
_ABSORBED = 2.0  # of such an error in a regressor, relative to what is left: friction in a sine
_WIDEST = 10.0  # relative standard deviation of a K_e or B_e of which nothing is known
_FITTED = 3.0  # K, B and an offset
_SHALLOWEST = 0.05  # depth that a shift of the surface leaves, relative to the supposed one
_LEAST_SIGNAL = 0.1  # of the noise: keeps the bias finite where there is noise alone


def _by_shift(blocks: Sequence[Window]) -> float:
    """Return the relative change of K_hat per shift of the surface [1/m]."""
    first, power = (sum(float(block.products[1, k]) for block in blocks) for k in (_LOCATION, 1))
    return first / power if power > 0.0 else 0.0


def _depth_spread(blocks: Sequence[Window]) -> float:
    """Return the standard deviation of phi_K over the window, relative to its mean."""
    power, first, count = (sum(float(block.products[i, j]) for block in blocks)
                           for i, j in ((1, 1), (1, _LOCATION), (_LOCATION, _LOCATION)))
    return sqrt(max(power * count / (first * first) - 1.0, 0.0)) if first > 0.0 else 0.0


class Error(NamedTuple):
    """Of one parameter: factor of its variance, variance beside it, and share of its value."""

    factor: float
    variance: float
    share: float


_NEVER_UPDATED = Error(1.0, 0.0, nan)


class SystematicErrors:
    """
    Find what the covariance of any estimator does not contain.

    - A constant error of the position, as by quantisation at rest, is a share of K_hat. Noise of
      the differentiated position biases the B_hat of least squares by a share of it.
    - A lag of the force that is not compensated acts as damping -K tau, and as mass -B tau, which
      moves K where no mass is fitted, and a surface that the offset of the force has shown. Its
      standard deviation is `timing_std`.
    - Correlated residuals: the variance from the scatter of the blocks of the window, relative to
      that of white noise, multiplies that of the estimator.
    - An estimate that differs from a fit of the window by more than both allow has not followed
      the wall, or x_e is wrong; the difference is its error.
    - B_hat is fitted beside K_hat: as long as that is uncertain, B_hat is too.
    - Where the law damps with depth, B_hat is a secant, different at the depths where it was
      learned.
    - A residual beyond the known noise is an error of the model. It may have any shape, that of
      a regressor included, so that it does not average out.

    Parameters
    ----------
    timing_std : float
        Of the time between force and motion [s].

    Attributes
    ----------
    learned : tuple of Error
        Of K_hat and of B_hat, as of their last updates; see `widened`.
    noted : Frozen or None
        For which `learned` holds the present errors; None where it has to be renewed.
    coupled : bool
        Whether K_hat and B_hat belong to one linear law.

    """

    def __init__(self, timing_std: float) -> None:
        self.timing_std = timing_std
        self._correlations = [[1.0, 1.0] for _ in range(3)]  # by fit
        self._spread = 0.0
        self.coupled = True
        self._now = Error(1.0, 0.0, 0.0), Error(1.0, 0.0, 0.0)
        self.forget_updates()

    def forget_updates(self) -> None:
        """Note that neither parameter has been updated, as after a switch of the estimator."""
        self.learned = _NEVER_UPDATED, _NEVER_UPDATED
        self.noted: Frozen | None = None

    def judge_position(
        self, window: Window, position_noise: float, estimator: OnlineEstimator
    ) -> None:
        """
        Find the shares of K_hat and B_hat by which an error of the position moves them.

        Parameters
        ----------
        window : Window
            Of the excitation monitor.
        position_noise : float
            Standard deviation of the position [m], quantisation included.
        estimator : OnlineEstimator
            The estimator.

        """
        (_, KK, KB, Kc, _), (_, _, BB, _, _), (*_, cc, _) = window.products[1:4].tolist()
        offset = bias = 0.0
        if KK > 0.0:
            if not estimator.location_std:  # else it is part of the prior of the location
                # Motion over many steps of the quantisation averages its error.
                moved = max(KK - Kc * Kc / cc, 0.0) / cc if cc > 0.0 else 0.0
                noise = position_noise * position_noise
                offset = noise / sqrt(noise + moved) * Kc / KK if noise > 0.0 else 0.0
                offset = min(offset, _WIDEST)  # of a wall that was never pressed
            if estimator.biased_by_position_noise:
                # Errors in variables: least squares divides by the power of signal and noise.
                noise = position_noise**2 * window.rate_noise
                bias = noise / max(BB - KB * KB / KK - noise, _LEAST_SIGNAL * noise, 1e-30)
        K, B = self._now
        self._now, self.noted = (K._replace(share=offset), B._replace(share=bias)), None

    def judge(
        self, blocks: Sequence[Window], noise_variance: float, known_variance: float,
        position_noise: float, location_std: float, estimator: OnlineEstimator,
        contact: Window | None = None,
    ) -> None:
        """
        Compare an estimator with the last window.

        Parameters
        ----------
        blocks : sequence of Window
            The blocks of the window.
        noise_variance : float
            Of the equation, from its residual [N^2].
        known_variance : float
            Of force and position noise [N^2].
        position_noise : float
            Standard deviation of the position [m].
        location_std : float
            Standard deviation of x_e as configured [m].
        estimator : OnlineEstimator
            The estimator.
        contact : Window or None
            Rows of the contact, which show its surface; None: those of the window.

        """
        fits = fit_window(blocks, noise_variance, estimator)
        by_shift = 0.0
        if location_std and not estimator.location_std:
            by_shift = _square(estimator.stiffness) * self._share_of_shift(
                contact or sum_of(blocks), noise_variance, known_variance,
                location_std * _by_shift(blocks), estimator)
        if fits is None:
            self._set(by_shift, 0.0)
            return
        excess = max(noise_variance - _EXPLAINED**2 * known_variance, 0.0)
        excess *= _ABSORBED**2 * sum(block.effective_samples for block in blocks)
        rate_noise = position_noise**2 * sum(block.rate_noise for block in blocks)
        lag = estimator.damping * self.timing_std
        K_lag = lag * fits.mean.by_acceleration
        self._note_correlations(fits, noise_variance)
        K_error, B_error = self._differences(fits, noise_variance, rate_noise, lag, estimator)
        of_K, of_B = (excess * variance if isfinite(variance) else 0.0
                      for variance in fits.mean.variances)
        B_error += UNKNOWN_DAMPING_S**2 * K_error  # B was fitted beside a wrong K
        self.coupled = estimator.fits_linear_damping
        if not self.coupled:
            self._spread = max(_depth_spread(blocks), _FADING * self._spread)
            B_error += _square(estimator.damping * self._spread)
        widest = _WIDEST * max(estimator.damping, UNKNOWN_DAMPING_S * estimator.stiffness)
        of_B = min(of_B, widest * widest)  # a tool at rest shows no damping
        self._set(max(K_error, by_shift) + of_K + K_lag * K_lag, B_error + of_B)

    def _set(self, K_error: float, B_error: float) -> None:
        """Take new errors of K_hat and B_hat."""
        (K_factor, B_factor), (K, B) = self._correlations[0], self._now
        self._now = (Error(max(K_factor, 1.0), K_error, K.share),
                     Error(max(B_factor, 1.0), B_error, B.share))
        self.noted = None

    def _note_correlations(self, fits: WindowFits, noise_variance: float) -> None:
        for fit, correlation in zip(fits, self._correlations):
            for k in (0, 1):
                if fit is not None and isfinite(fit.scatter[k]):
                    white = max(noise_variance * fit.variances[k], 1e-300)
                    correlation[k] += _SMOOTHING * (fit.scatter[k] / white - correlation[k])

    def _share_of_shift(
        self, contact: Window, noise_variance: float, known_variance: float, prior_std: float,
        estimator: OnlineEstimator,
    ) -> float:
        """
        Return the mean square of the share of K_hat by which the surface may be elsewhere.

        That of the posterior: the shift that the contact has shown so far is either too small to
        be moved to, or not certain. `prior_std` and shifts are relative to the depth.

        """
        prior_std = min(prior_std, _WIDEST)
        shown = self._shown(contact, noise_variance, known_variance, estimator)
        if shown is None:
            return _square(_share_of_stiffness(prior_std))
        shift, seen = shown
        kept = prior_std * prior_std / (prior_std * prior_std + seen)
        return _square(_share_of_stiffness(kept * shift)) + kept * seen

    def _shown(
        self, contact: Window, noise_variance: float, known_variance: float,
        estimator: OnlineEstimator,
    ) -> tuple[float, float] | None:
        """Return the shift of the surface that the rows show, and its variance."""
        if estimator.linearisation():  # an exponent explains an offset as well
            return None
        estimated = wall_of(estimator)
        fit = fit_first_contact(contact.products, estimated, noise_variance)
        if fit is None:
            return None
        wall, freedom = fit.offset_wall, contact.effective_samples - _FITTED
        if freedom > _FITTED:  # a surface elsewhere is no noise
            noise_variance = max(known_variance, fit.offset_left / freedom)
        correlation, per_shift = max(self._correlations[2][0], 1.0), _by_shift([contact])
        scale = per_shift / max(wall.stiffness, 1e-9)
        lagging = per_shift * shift_by_lag(contact.products, estimated, self.timing_std)
        return (-wall.offset * scale,
                noise_variance * fit.offset_variance * correlation * scale * scale
                + lagging * lagging)

    def _differences(
        self, fits: WindowFits, noise_variance: float, rate_noise: float, lag: float,
        estimator: OnlineEstimator,
    ) -> tuple[float, float]:
        """Return the squares of what K_hat and B_hat differ from the window beyond chance."""
        K, B = estimator.stiffness, estimator.damping
        of_K, of_B = 0.0, 0.0
        compared = [fits.mean, None, None] if fits.end is None else [None, fits.end, fits.located]
        for fit, correlation in zip(compared, self._correlations):
            if fit is None:
                continue
            white_K, white_B = (noise_variance * max(c, 1.0) * variance
                                for c, variance in zip(correlation, fit.variances))
            share = min(rate_noise * fit.variances[1], 0.5)  # of the power of phi_B
            bias = fit.values[1] * share / (1.0 - share)
            moved = lag * fit.by_acceleration
            of_K = max(of_K, _square(fit.values[0] - K)
                       - _AGREES**2 * (white_K + _square(moved)))
            of_B = max(of_B, _square(fit.values[1] - B)
                       - _AGREES**2 * (white_B + _square(bias)))
        return of_K, of_B

    def note_update(self, frozen: Frozen) -> None:
        """
        Note which parameters are being updated; the errors of the others stay.

        Parameters
        ----------
        frozen : Frozen
            Parameters that are not updated.

        """
        if frozen is self.noted:
            return
        K, B = self.learned
        self.learned = (K if frozen.stiffness else self._now[0],
                        B if frozen.damping else self._now[1])
        self.noted = frozen


def _share_of_stiffness(shift: float) -> float:
    """Return the share of K_hat that a shift of the surface, relative to the depth, adds."""
    return min(shift / max(1.0 - shift, _SHALLOWEST), _WIDEST)


def _square(value: float) -> float:
    """Return the square; infinite, instead of an error as by **, where an estimate diverged."""
    return value * value
