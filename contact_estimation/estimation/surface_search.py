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

"""Search for the surface of the wall: the offset of the force against position."""

from __future__ import annotations

from math import sqrt

from ..estimators.estimator import OnlineEstimator
from ..estimators.row_sums import Window
from ..estimators.wall_fit import shift_by_lag, WallFit

_SIGNIFICANT = 5.0  # standard deviations of the shift
_EXPLAINS = 0.5  # of the misfit beyond noise must be gone then: a spike moves no surface
_RELEVANT = 0.003  # of K_e
_LAGS = 2.0  # standard deviations of the timing that may feign a shift
_CHECKED = 0.02  # standard deviation of K_e by the location below which it is certain
_UNCHECKED_S = 1.0  # of a contact, after which a location not certain is reported
_SHARPER = 0.6  # standard deviation of a shift, relative to the last one, that refines it
_LEAST_FREEDOM = 2.0  # of a fit with an offset

REACH = 3.0
"""How far from its configured location a wall is looked for [standard deviations]."""


class SurfaceSearch:
    """
    Finds how far the surface is from its configured location.

    Attributes
    ----------
    shift : float
        Estimated location less the configured one [m].
    taken_std : float
        Standard deviation of a location taken from a touch [m]; 0: it is configured.
    prior_std, timing_std : float
        Of environment.location [m], 0: known; of the time between force and motion [s].

    """

    def __init__(self, prior_std: float, timing_std: float) -> None:
        self.prior_std, self.timing_std = prior_std, timing_std
        self.shift = self.taken_std = 0.0
        self.touch_down()

    def touch_down(self) -> None:
        """Start with a new contact; the shift stays."""
        self._found_std = 0.0
        self._checked = False

    def doubt(self, std: float) -> None:
        """Refine the location as soon as a contact shows it better than a standard deviation."""
        self.taken_std = self._found_std = std

    def is_unchecked(self, contact_s: float) -> bool:
        """Return whether a contact of some length has not shown where its surface is."""
        return self.prior_std > 0.0 and not self._checked and contact_s > _UNCHECKED_S

    def note_explained(self) -> None:
        """Note that the law of the estimator explains an offset: there is nothing to check."""
        self._checked = True

    def look(
        self, window: Window, estimator: OnlineEstimator, fit: WallFit, known: float
    ) -> float:
        """
        Find how far the line of force against position meets 0 from the surface.

        Parameters
        ----------
        window : Window
            Rows of the contact, with the surface as found so far.
        estimator : OnlineEstimator
            May estimate a location of its own.
        fit : WallFit
            Of these rows.
        known : float
            Known noise of the equation [N^2].

        Returns
        -------
        shift : float
            By which `shift` has been moved [m]; 0 where the surface is near enough.

        """
        wall, freedom = fit.offset_wall, window.effective_samples - 3.0
        if (self.prior_std == 0.0 or wall.stiffness <= 0.0 or freedom < _LEAST_FREEDOM
                or estimator.linearisation()):
            return 0.0
        shift = -wall.offset / wall.stiffness
        variance = max(known, fit.offset_left / freedom)
        std = sqrt(variance * fit.offset_variance) / wall.stiffness
        own = _SIGNIFICANT * (estimator.location_std or 0.0)
        refines = std < _SHARPER * self._found_std
        moved = window.shifted(shift).products
        per_shift = abs(float(moved[1, 3])) / max(float(moved[1, 1]), 1e-30)  # of K_e [1/m]
        effect = abs(shift) * per_shift
        self._checked |= std * per_shift < _CHECKED
        apparent = _LAGS * shift_by_lag(window.products, wall, self.timing_std)
        wrong = fit.left - known * freedom  # noise is not explained by any surface
        found = (fit.left - fit.offset_left > _EXPLAINS * wrong
                 and abs(shift) > max(_SIGNIFICANT * std, own) + apparent)
        if (not (found or refines) or effect < _RELEVANT
                or abs(self.shift + shift) > REACH * self.prior_std):
            return 0.0
        self._found_std = std
        self.shift += shift
        return shift
