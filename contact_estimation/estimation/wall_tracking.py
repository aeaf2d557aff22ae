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

"""
Tracking of the wall, the same for every estimator: a new wall, a step, a surface elsewhere.

An estimator that averages over a second or more is blind for that long to a wall that has
changed, and one whose covariance has collapsed for good. So the last rows are compared with the
estimate: what they contradict is reopened.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from enum import IntEnum
from math import exp, inf, sqrt
from typing import Sequence

import numpy as np
from numpy.typing import NDArray

from .surface_search import SurfaceSearch
from ..estimators.estimator import OnlineEstimator, UNKNOWN_DAMPING_S
from ..estimators.row_sums import LARGEST, RowSums, Window
from ..estimators.wall_fit import fit_first_contact, misfit, Wall, wall_of, WallFit
from ..parameters.specification import parameter, ParameterGroup
from ..signals.relations import Row

_SIGNIFICANT = 50.0  # gain of a fit over the noise variance; chi-squared of two: below 1e-10
_EXPLAINS = 0.5  # of the misfit must be gone with the new fit: a spike is no new wall
_RELEVANT = 0.003  # relative misfit below which the estimator follows on its own
_NOTABLE = 0.04  # relative misfit from which the rows before belong to another wall
_SURE = 0.1  # relative deviation of a stiffness
_FOREIGN_NOTABLE = 0.15  # for another law than eq. (3)
_DIFFERENT, _DIFFERENT_STD = 0.02, 5.0  # of the stiffness of the window: share, deviations
_ESCALATION, _CALMING_S = 2.0, 1.0  # of the above after each, for laws other than eq. (3)
_JUDGEMENTS = 5  # before which a change cannot have entered the noise
_SETTLED = 10  # judgements without a restart, after which most may wait
_DETERMINED = 0.2  # relative deviation below which a fit determines B_e
_UNKNOWN = 2.0  # share of a value that says nothing
_WIDER = 2.0  # than a change that the estimator has to follow


@dataclass(frozen=True)
class TrackingParameters(ParameterGroup):
    """How estimates follow a wall that changes."""

    restarts: bool = parameter(
        True,
        'Reopen the estimate where the last rows contradict it, and at every new contact, which '
        'starts with K_hat and B_hat as a prior; false: as the estimator alone follows',
    )
    carried_std: float = parameter(
        1.0, 'Standard deviation of K_hat and B_hat, relative to them, at a new contact',
        minimum=1e-3, maximum=100.0,
    )


class Change(IntEnum):
    """What a comparison has shown: nothing, another estimate, another wall, another surface."""

    NONE = 0
    ESTIMATE = 1
    WALL = 2
    LOCATION = 3


class WallTracker:
    """
    Compares the estimate with the rows of the excitation monitor, and reopens it.

    Parameters
    ----------
    location_std : float
        Of environment.location [m]; 0: known.
    position_noise : float
        Standard deviation [m].
    timing_std : float
        Of the time between force and motion [s].

    Attributes
    ----------
    surface : SurfaceSearch
        Where the surface has been found.

    """

    def __init__(
        self, parameters: TrackingParameters, location_std: float, position_noise: float,
        timing_std: float,
    ) -> None:
        self.surface = SurfaceSearch(location_std, timing_std)
        self._contact_s = self._variance = self._found = 0.0
        self._notable = _NOTABLE
        self._since = _JUDGEMENTS  # judgements since the last restart
        self._noises: deque[float] = deque(maxlen=_JUDGEMENTS)
        self.configure(parameters, location_std, position_noise, timing_std)

    def configure(
        self, parameters: TrackingParameters, location_std: float, position_noise: float,
        timing_std: float,
    ) -> None:
        """Set new parameters while running; see the constructor."""
        self._p, self._position_noise = parameters, position_noise
        self.surface.prior_std, self.surface.timing_std = location_std, timing_std

    @property
    def location_unchecked(self) -> bool:
        """Whether a contact of some length has not shown where its surface is."""
        return self._p.restarts and self.surface.is_unchecked(self._contact_s)

    def touch_down(self, estimator: OnlineEstimator) -> None:
        """
        Turn the estimate of the last contact into a prior of the next.

        Parameters
        ----------
        estimator : OnlineEstimator
            Reopened.

        """
        self._contact_s = 0.0
        self.surface.touch_down()
        linear = estimator.linearisation() is None
        if linear and estimator.may_restart:  # the exponent couples depths: it must not be free
            _reopen(estimator, self._p.carried_std)

    def may_wait(self, rows: Sequence[Row], estimator: OnlineEstimator) -> bool:
        """
        Return whether nothing calls for a judgement of the estimate now.

        Parameters
        ----------
        rows : sequence of row
            Those since the last call.
        estimator : OnlineEstimator
            The estimator.

        """
        if not (self._p.restarts and estimator.may_restart):
            return True
        if self._since < _SETTLED:
            return False
        (K, B, c, M), found = wall_of(estimator), 0.0
        for y, f_K, f_B, f_c, f_M in rows:
            error = y - K * f_K - B * f_B - c * f_c - M * f_M
            found += error * error
        before, self._found = self._found, found  # of the rows of the last call
        return before + found < _SIGNIFICANT * self._variance

    def follow(
        self, sums: RowSums, estimator: OnlineEstimator, noise_variance: float,
        force_variance: float, contact_s: float,
    ) -> Change:
        """
        Compare the last rows with the estimate.

        Parameters
        ----------
        sums : RowSums
            Of the rows.
        estimator : OnlineEstimator
            Is reopened where they contradict it.
        noise_variance, force_variance : float
            Of the equation and of the force [N^2].
        contact_s : float
            Duration of the contact [s].

        Returns
        -------
        change : Change
            What has changed.

        """
        if not (self._p.restarts and estimator.may_restart):
            return Change.NONE
        window, wall = sums.window(), wall_of(estimator)
        if not window.products.max() < LARGEST:
            return Change.NONE
        known = force_variance + self.position_variance(window, wall)
        # The noise as it was before a change could enter it.
        variance = max(known, self._noises[0] if self._noises else noise_variance, 1e-18)
        self._variance = variance
        self._noises.append(noise_variance)
        self._since += 1
        elapsed_s, self._contact_s = contact_s - self._contact_s, contact_s
        self._notable += (_NOTABLE - self._notable) * (1.0 - exp(-elapsed_s / _CALMING_S))
        fit = fit_first_contact(window.products, wall, variance)
        linear = estimator.linearisation() is None
        if not linear:
            self.surface.note_explained()  # by the exponent
        if fit is None or not (linear or sums.completed):  # other laws bend at touch-down
            return Change.NONE
        change = Change.NONE
        if self._gain(sums, fit.offset_wall, variance) > self._notable:
            self._notable *= _ESCALATION
            sums.keep_recent()
            window, change = sums.window(), Change.WALL
            fit = fit_first_contact(window.products, wall, variance) or fit
        found = self._look(sums, estimator, fit, wall, variance, known)
        if found is not None:
            self._restart(estimator, found.offset_wall, found, known)
            return Change.LOCATION
        share = self._gain(sums, wall, variance)
        settled = self._since >= _JUDGEMENTS  # before, the estimator may be about to follow
        notable = _NOTABLE
        if not linear:  # an uncertain one follows on its own
            notable = _FOREIGN_NOTABLE if _is_sure(estimator) else inf
        if fit.wall.stiffness > 0.0 and (
            share > notable or settled and linear and _differs(fit, wall, variance)
        ):
            self._restart(estimator, fit.wall, fit, variance)
            return change or Change.ESTIMATE
        if linear and share > _RELEVANT:
            _reopen(estimator, _WIDER * min(share, 1.0))
        return change

    def _look(
        self, sums: RowSums, estimator: OnlineEstimator, fit: WallFit, wall: Wall,
        variance: float, known: float,
    ) -> WallFit | None:
        """Return the fit of the contact with its surface where that has moved, else None."""
        contact = sums.contact()
        if contact is not sums.window():
            fit = fit_first_contact(contact.products, wall, variance) or fit
        shift = self.surface.look(contact, estimator, fit, known)
        if shift == 0.0:
            return None
        sums.shift(shift)
        return fit

    def _restart(
        self, estimator: OnlineEstimator, wall: Wall, fit: WallFit, variance: float
    ) -> None:
        """Restart at a fitted wall, with a damping only where the fit determines it."""
        self._since = 0
        damping_std = sqrt(variance * fit.damping_variance)
        told = damping_std < _DETERMINED * wall.damping
        softer = min(wall.stiffness / max(estimator.stiffness, 1e-9), 1.0)  # damps less, too
        K, B = estimator.within_limits(
            wall.stiffness, wall.damping if told else softer * estimator.damping)
        K_std, B_std = _spread(K, B, _UNKNOWN)
        if not estimator.weighs_data:  # it does not learn the same rows twice
            K_std = max(_WIDER * sqrt(variance * fit.stiffness_variance), _DIFFERENT * K)
            B_std = _WIDER * damping_std if told else B_std
        estimator.restart(K, B, K_std, B_std)

    def position_variance(self, window: Window, wall: Wall) -> float:
        """
        Return the variance of the force that the position noise appears as [N^2].

        Parameters
        ----------
        window : Window
            Of the rows.
        wall : Wall
            Whose K_e and B_e turn errors of position and rate into forces.

        """
        rate = window.rate_noise / max(window.effective_samples, 1e-9)
        K, B = wall.stiffness, wall.damping
        return self._position_noise**2 * (K * K + B * B * rate)

    @staticmethod
    def _gain(sums: RowSums, wall: Wall, variance: float) -> float:
        """Return the relative misfit of the last rows that another wall explains; 0: none."""
        products = sums.recent().products
        found = misfit(products, wall)
        if found < _SIGNIFICANT * variance:
            return 0.0
        fit = fit_first_contact(products, wall, variance)
        if fit is None:
            return 0.0
        gain = found - fit.left
        if gain < _SIGNIFICANT * variance or gain < _EXPLAINS * found:
            return 0.0
        return sqrt(gain / float(products[3, 3])) / _force(products, sums.window().products)


def _force(*windows: NDArray[np.float64]) -> float:
    """Return the largest root mean square of the force in several windows [N]."""
    return max(sqrt(products[0, 0] / max(products[3, 3], 1e-30)) for products in windows) + 1e-30


def _differs(fit: WallFit, wall: Wall, variance: float) -> bool:
    """Return whether the stiffness is not that of the window: gains may be too small for it."""
    std = sqrt(variance * fit.stiffness_variance)
    return abs(fit.wall.stiffness - wall.stiffness) > max(
        _DIFFERENT * wall.stiffness, _DIFFERENT_STD * std)


def _is_sure(estimator: OnlineEstimator) -> bool:
    return estimator.current().stiffness_std < _SURE * estimator.stiffness


def _spread(stiffness: float, damping: float, share: float) -> tuple[float, float]:
    """Return the standard deviations of K_e and B_e known to a share of them."""
    return share * stiffness, share * max(damping, UNKNOWN_DAMPING_S * stiffness)


def _reopen(estimator: OnlineEstimator, share: float) -> None:
    """Restart from the present estimate, known to a share of it at best."""
    K, B, K_std, B_std, _, _ = estimator.current()
    K_least, B_least = _spread(K, B, share)
    estimator.restart(K, B, max(K_std, K_least), max(B_std, B_least))
