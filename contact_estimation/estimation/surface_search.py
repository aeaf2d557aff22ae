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

from math import hypot, sqrt

import numpy as np
from numpy.typing import NDArray

from ..estimators.estimator import OnlineEstimator
from ..estimators.row_sums import Window
from ..estimators.wall_fit import Wall, WallFit

_SIGNIFICANT = 5.0  # standard deviations of the shift
_EXPLAINS = 0.5  # of the misfit must be gone with the new fit: a spike moves no surface
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
    shift_std : float
        Its standard deviation [m]; 0 while no shift has been found.
    prior_std, timing_std : float
        Of environment.location [m], 0: known; of the time between force and motion [s].

    """

    def __init__(self, prior_std: float, timing_std: float) -> None:
        self.prior_std, self.timing_std = prior_std, timing_std
        self.shift = self.shift_std = 0.0
        self.touch_down()

    @property
    def std(self) -> float:
        """Return the deviation of where the surface is: as found, else as configured [m]."""
        return self.shift_std or self.prior_std

    def touch_down(self) -> None:
        """Start with a new contact; the shift stays."""
        self._found_std = 0.0
        self._checked = False

    def doubt(self, std: float) -> None:
        """Refine the location as soon as a contact shows it better than a deviation [m]."""
        self.shift_std = self._found_std = std

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
            Rows with the surface as found so far.
        estimator : OnlineEstimator
            May estimate a location of its own.
        fit : WallFit
            Of the window.
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
        apparent = _LAGS * self._apparent_shift(window.products, wall)
        found = (fit.left - fit.offset_left > _EXPLAINS * fit.left
                 and abs(shift) > max(_SIGNIFICANT * std, own) + apparent)
        if (not (found or refines) or effect < _RELEVANT
                or abs(self.shift + shift) > REACH * self.prior_std):
            return 0.0
        self._found_std, self.shift_std = std, hypot(std, apparent / _LAGS)
        self.shift += shift
        return shift

    def _apparent_shift(self, products: NDArray[np.float64], wall: Wall) -> float:
        """
        Return the shift that a lag of the force feigns [m].

        A lag tau adds -B tau a, and by parts sum of d a = -sum of v v: the line of force against
        position appears steeper. No shift appears where the mass is fitted.

        """
        KK, Kc, cc = (float(products[i, j]) for i, j in ((1, 1), (1, 3), (3, 3)))
        spread = KK - Kc * Kc / cc if cc > 0.0 else 0.0
        if products[4, 4] > 0.0 or spread <= 0.0:
            return 0.0
        by_lag = max(wall.damping, 0.0) * float(products[2, 2]) / spread  # of K
        return self.timing_std * by_lag * Kc / cc / wall.stiffness
