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

"""Whether an effect improves the fit enough to justify its parameters; calibrated thresholds."""

from __future__ import annotations

import numpy as np

from .fitting import Fit
from .share import Share
from ..observe.model import Model

THRESHOLD = 0.1
"""Least gain of an effect, as a share of the number of residuals: calibrated false alarms."""

PRICE = 25.0
"""Cost of a further parameter; BIC would ask 8, but the laws are nested."""

SHARE = 0.3
"""Least share of the misfit above the noise that a further effect must explain."""

SHARE_OF_WHOLE = 0.1
"""Least share of the misfit of the recalibrated model with the zeros that are named."""

SURE = 0.2
"""Least lower end of the interval of the share of the present misfit."""

HARMLESS = 0.05
"""Most harm on parts that an effect predicts worse, to be sure above zero instead of `SURE`."""

OF_LITTLE, SURE_OF_LITTLE = 0.75, 0.6
"""Least share, and its lower end, of a law that explains a misfit which is a trifle."""

ADEQUATE = 0.05
"""Share of the gain of the best law that a simpler one may lack."""

TRIFLE, NEARLY_ALL = 0.02, 0.7
"""Least share of that misfit that a zero must have if it is so much of the present one."""

EXPLAINED = 0.5
"""Least share of the misfit that names must predict on data left out to explain it."""

SURELY_MOST = 0.6
"""Share of the misfit that a curve explains down to the noise: a bias would, in part."""

LEFT = 0.5
"""Mean square of the residuals beyond that of the noise, from which on something is missing."""


def leaves_noise(found: Fit) -> bool:
    """
    Return whether a fitted model leaves no more than noise.

    Parameters
    ----------
    found : Fit
        Any.

    Returns
    -------
    noise : bool
        By the mean square of its residuals.

    """
    return found.cost <= (1.0 + LEFT) * found.residual_count


def noise_scale(found: Fit) -> float:
    """
    Return the ratio of the residual variance to that of the noise, at least 1.

    Parameters
    ----------
    found : Fit
        The best known.

    Returns
    -------
    scale : float
        Variance.

    """
    return max(1.0, found.cost / found.residual_count)


def penalty(model: Model) -> float:
    """
    Compute the penalty on the free parameters of the effects.

    Parameters
    ----------
    model : Model
        With effects.

    Returns
    -------
    penalty : float
        In units of cost for residuals of variance 1.

    """
    return PRICE * float(np.count_nonzero(model.free) - model.base_count)


def enough(before: Fit, after: Fit) -> bool:
    """
    Return whether a further effect is worth its parameters.

    Parameters
    ----------
    before, after : Fit
        Without and with it.

    Returns
    -------
    enough : bool
        The gain is significant and a fair share of the unexplained misfit.

    """
    gain, count = before.cost - after.cost, after.residual_count
    excess = max(before.cost - count, 0.0)
    least = noise_scale(after) * (
        THRESHOLD * count + penalty(after.model) - penalty(before.model))
    return gain > least and gain > SHARE * excess


def is_sure_of_little(share: Share) -> bool:
    """
    Return whether a law explains nearly all of a misfit that is little beside the force.

    A rig has several small imperfections, of which none stands out.

    Parameters
    ----------
    share : Share
        Of that misfit.

    Returns
    -------
    sure : bool
        Beyond doubt.

    """
    return share.share >= OF_LITTLE and share.interval[0] >= SURE_OF_LITTLE


def predicts_enough(of_present: Share, of_whole: Share, zero: bool = False) -> bool:
    """
    Return whether a further effect predicts enough of parts left out.

    Parameters
    ----------
    of_present, of_whole : Share
        Of the misfit of the model without it in the channel that the effect decides, and of that
        of the recalibrated model in all.
    zero : bool
        Whether it is a zero of sensor or surface, which may be a small share of the whole if it is
        nearly all of the present misfit.

    Returns
    -------
    enough : bool
        A fair share of the present misfit, beyond doubt, and not a trifle of the whole.

    """
    sure = of_present.interval[0] >= (0.0 if of_present.harm <= HARMLESS else SURE)
    if of_present.share < SHARE or not sure:
        return False
    least = TRIFLE if zero and of_present.share >= NEARLY_ALL else SHARE_OF_WHOLE
    return of_whole.interval[0] > 0.0 and of_whole.share >= least


def explained_share(before: float, after: float, noise: float) -> float:
    """
    Return the share of a misfit above the noise that a model explains.

    Parameters
    ----------
    before, after, noise : float
        Costs or mean squares: without the model, with it, of the noise.

    Returns
    -------
    share : float
        1 where there was no misfit.

    """
    return 1.0 - (after - noise) / (before - noise) if before > noise else 1.0
