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

"""Least squares of the wall over a window, with and without an offset of its force."""

from __future__ import annotations

from math import isfinite
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .estimator import OnlineEstimator, UNKNOWN_DAMPING_S

_SMALLEST = 1e-12  # relative square of a column below which it depends on the others


class Wall(NamedTuple):
    """
    Parameters of y = K_e phi_K + B_e phi_B + offset phi_c + M_e phi_M.

    Attributes
    ----------
    stiffness, damping : float
        K [N/m], B [N s/m].
    offset : float
        Force at phi_K = 0 [N]: -K s of a surface that is shifted by s.
    inertia : float
        M [kg].

    """

    stiffness: float
    damping: float
    offset: float
    inertia: float


class WallFit(NamedTuple):
    """
    The wall that fits a window best.

    Attributes
    ----------
    wall : Wall
        Fitted, with the given offset and inertia.
    left : float
        Squared misfit that it leaves [N^2].
    offset_wall : Wall
        Fitted with an offset of its own.
    offset_left : float
        Squared misfit that this leaves [N^2].
    stiffness_variance, damping_variance : float
        Of `wall`, for white noise of variance 1.
    offset_variance : float
        Of the offset of `offset_wall`, likewise.

    """

    wall: Wall
    left: float
    offset_wall: Wall
    offset_left: float
    stiffness_variance: float
    damping_variance: float
    offset_variance: float


def wall_of(estimator: OnlineEstimator) -> Wall:
    """Return the wall that an estimator holds."""
    K, B, _, _, shift, inertia = estimator.current()
    return Wall(K, B, -K * shift, inertia if inertia == inertia else 0.0)


def fit_wall(
    products: NDArray[np.float64], guess: Wall, damping_weight: float, inertia_weight: float
) -> WallFit | None:
    """
    Fit a wall to a window, once with the guessed offset and once with a fitted one.

    A few hundredths of a second do not determine B_e and M_e beside K_e; then their priors do.

    Parameters
    ----------
    products : ndarray, shape (5, 5)
        Sum of row^T row, rows (y, phi_K, phi_B, phi_c, phi_M).
    guess : Wall
        Prior of B_e, and the offset.
    damping_weight, inertia_weight : float
        Of the priors, that of M_e being 0: noise variance over their variance, > 0.

    Returns
    -------
    fit : WallFit or None
        None where the rows do not determine K_e.

    """
    (yy, Ky, By, cy, My), (_, KK, KB, Kc, KM), (_, _, BB, Bc, BM), (*_, cc, cM), (*_, MM) = (
        products.tolist()
    )
    _, B, c, _ = guess
    yy, By, BB, MM = (yy + damping_weight * B * B, By + damping_weight * B, BB + damping_weight,
                      MM + inertia_weight)
    if not (MM > 0.0 and BB > 0.0 and isfinite(yy + KK + BB + MM)):  # a diverged estimate
        return None
    m_y, m_K, m_B, m_c = My / MM, KM / MM, BM / MM, cM / MM
    yy, Ky, By, cy = yy - m_y * My, Ky - m_y * KM, By - m_y * BM, cy - m_y * cM
    KK, KB, Kc = KK - m_K * KM, KB - m_K * BM, Kc - m_K * cM
    BB, Bc, cc = BB - m_B * BM, Bc - m_B * cM, cc - m_c * cM
    # M_e has been eliminated; now B_e, then K_e, then the offset.
    share_K, share_c = KB / BB, Bc / BB
    k, kc, ky = KK - share_K * KB, Kc - share_K * Bc, Ky - share_K * By
    if k <= _SMALLEST * KK or KK <= 0.0:
        return None
    o, oy, left = cc - share_c * Bc, cy - share_c * By, yy - By * By / BB
    share = kc / k
    o, oy, left = o - share * kc, oy - share * ky, left - ky * ky / k
    fitted, gained = (oy / o, oy * oy / o) if o > _SMALLEST * cc else (c, 0.0)

    def wall(offset: float) -> Wall:
        K = (ky - kc * offset) / k
        B = (By - KB * K - Bc * offset) / BB
        return Wall(K, B, offset, m_y - m_K * K - m_B * B - m_c * offset)

    return WallFit(
        wall(c), max(left - gained + o * (fitted - c) ** 2, 0.0), wall(fitted),
        max(left - gained, 0.0), 1.0 / k, 1.0 / BB + share_K * share_K / k, 1.0 / max(o, 1e-30),
    )


def fit_first_contact(
    products: NDArray[np.float64], wall: Wall, noise_variance: float
) -> WallFit | None:
    """
    Fit a wall whose damping and mass are as uncertain as those of a first contact.

    Parameters
    ----------
    products : ndarray, shape (5, 5)
        As for `fit_wall`.
    wall : Wall
        Prior of B_e, and the offset.
    noise_variance : float
        Of the equation [N^2].

    Returns
    -------
    fit : WallFit or None
        As of `fit_wall`.

    """
    KK = float(products[1, 1])
    secant = float(products[0, 1]) / KK if KK > 0.0 else 0.0
    scale = max(wall.stiffness, secant, 1e-9)
    damping_std = max(wall.damping, UNKNOWN_DAMPING_S * scale)
    inertia_std = UNKNOWN_DAMPING_S**2 * scale
    # Products, not powers: of a diverged estimate they are infinite instead of an error.
    return fit_wall(
        products, wall, noise_variance / (damping_std * damping_std),
        noise_variance / (inertia_std * inertia_std))


def shift_by_lag(products: NDArray[np.float64], wall: Wall, lag: float) -> float:
    """
    Return the shift of the surface that a lag of the force feigns.

    A lag tau adds -B tau a, and by parts sum of d a = -sum of v v: the line of force against
    position appears steeper. No shift appears where the mass is fitted.

    Parameters
    ----------
    products : ndarray, shape (5, 5)
        As for `fit_wall`.
    wall : Wall
        Fitted with an offset.
    lag : float
        Its standard deviation [s].

    Returns
    -------
    shift : float
        [m].

    """
    KK, Kc, cc = (float(products[i, j]) for i, j in ((1, 1), (1, 3), (3, 3)))
    spread = KK - Kc * Kc / cc if cc > 0.0 else 0.0
    if products[4, 4] > 0.0 or spread <= 0.0:
        return 0.0
    by_lag = max(wall.damping, 0.0) * float(products[2, 2]) / spread  # of K
    return lag * by_lag * Kc / cc / max(wall.stiffness, 1e-9)


def misfit(products: NDArray[np.float64], wall: Wall) -> float:
    """
    Compute the squared error with which a wall predicts the rows of a window.

    Parameters
    ----------
    products : ndarray, shape (5, 5)
        As for `fit_wall`.
    wall : Wall
        K_e, B_e, offset and M_e.

    Returns
    -------
    misfit : float
        Sum of squares [N^2].

    """
    K, B, c, M = wall
    (yy, Ky, By, cy, My), (_, KK, KB, Kc, KM), (_, _, BB, Bc, BM), (*_, cc, cM), (*_, MM) = (
        products.tolist()
    )
    return float(yy - 2.0 * (K * Ky + B * By + c * cy + M * My)
                 + K * (K * KK + 2.0 * (B * KB + c * Kc + M * KM))
                 + B * (B * BB + 2.0 * (c * Bc + M * BM)) + c * (c * cc + 2.0 * M * cM)
                 + M * M * MM)
