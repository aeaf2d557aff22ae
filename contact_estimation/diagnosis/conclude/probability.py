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
The probability that a name is right, from what the effect predicts on parts left out.

A logistic curve of the lower end of the share, fitted to names given on worlds whose laws are not
the library's; `blind_trials --foreign N` shows how often names of a given probability are right.
"""

from __future__ import annotations

from math import exp
from typing import Sequence

import numpy as np
from numpy.typing import NDArray

from ..fit.share import Share

Array = NDArray[np.float64]

EVEN, SLOPE = 0.0, 3.4
"""Evidence at which a name is as often right as wrong, and the steepness of the curve there."""

DOUBTFUL = 0.5
"""Probability of an effect that leaves only noise, but may predict nothing of parts left out."""

_CERTAIN = 0.5  # lower end of a share, in it: less is wrong too often, though only noise is left
_TRIFLE = 0.05  # share of the misfit that another law, if inexact, may leave to any name

LEAST, MOST = 0.05, 0.97
"""Limits of the probability: no finite number of worlds supports more."""


def probabilities(
    shares: Sequence[Share], beside: Sequence[Share], left: float, exact: bool
) -> list[float]:
    """
    Compute the probabilities that names are right, by family.

    Parameters
    ----------
    shares : sequence of Share
        Of the recalibrated model's misfit, in the order in which the effects were taken.
    beside : sequence of Share
        Of the same misfit: what the model with all other effects leaves beyond that with all.
    left : float
        Share that all effects together leave, >= 0.
    exact : bool
        Whether the effects leave only noise: no wrong law does that by chance, if its share is
        above zero beyond doubt and no trifle, and its lower end at least half of it.

    Returns
    -------
    probabilities : list of float
        Of each, from the lower end of its share: half of the whole misfit, half of what the
        earlier effects leave, or all the others, whichever tells more.

    """
    if exact:
        return [_of_exact(share, other) for share, other in zip(shares, beside)]
    found, present = [], 1.0
    for share, other in zip(shares, beside):
        found.append(probability_of(max(
            _evidence(share, present), _evidence(other, other.share + left))))
        present = max(present - share.share, 0.0)
    return found


def _of_exact(share: Share, beside: Share) -> float:
    sure = max(share.interval[0], beside.interval[0])
    if sure <= 0.0 or max(share.share, beside.share) < _TRIFLE:
        return DOUBTFUL
    certain = max(one.interval[0] / one.share for one in (share, beside) if one.share > 0.0)
    return MOST if certain >= _CERTAIN else probability_of(sure)


def probability_in_form(share: Share) -> float:
    """
    Compute the probability of the family of a law that holds in form alone.

    Parameters
    ----------
    share : Share
        Of the misfit, with a size of its own in each part.

    Returns
    -------
    probability : float
        From half of the lower end: a size for each part explains more by chance.

    """
    return probability_of(0.5 * min(share.interval[0], 1.0))


def _evidence(share: Share, present: float) -> float:
    """Return the mean lower end of a share of the whole misfit and of a present one."""
    sure = min(share.interval[0], 1.0)
    return 0.5 * (sure + (min(sure / present, 1.0) if present > 0.0 else 0.0))


def probability_of(evidence: float) -> float:
    """
    Compute the probability that a name is right.

    Parameters
    ----------
    evidence : float
        Lower end of the share of the misfit.

    Returns
    -------
    probability : float
        On the calibrated curve.

    """
    return min(max(1.0 / (1.0 + exp(-SLOPE * (evidence - EVEN))), LEAST), MOST)


def evidence_of(probability: Array) -> Array:
    """
    Invert `probability_of`.

    Parameters
    ----------
    probability : ndarray
        Within its limits.

    Returns
    -------
    evidence : ndarray
        At a limit the least that leads to it.

    """
    inside = np.clip(probability, LEAST, MOST)
    return np.asarray(EVEN + np.log(inside / (1.0 - inside)) / SLOPE)
