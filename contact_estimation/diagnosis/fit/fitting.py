# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Fitting a model to recordings by a bounded search."""

from __future__ import annotations

from typing import Callable, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from .jacobian import SecantJacobian
from ..observe.model import Model
from ..observe.prepared_recording import Recordings
from ..observe.residuals import residuals

Array = NDArray[np.float64]

_MOST_SEARCHES, _SLOWLY = 4, 0.99  # of 25 steps; less than a hundredth is no progress
_BRIEFLY, _TO_END = 1e-3, 1e-6  # relative gain at which a search ends
_AT_BOUND = 1e-6  # of its typical change: a value at the lower bound of its range
_LARGEST = 1e6  # standard deviations, also for what is not finite: a diverged model


class Fit(NamedTuple):
    """
    A fitted model.

    Attributes
    ----------
    model : Model
        With the best values.
    cost : float
        Sum of the squared residuals, in standard deviations.
    residuals : ndarray, shape (R,)
        At the best values.
    residual_count : int
        Number of residuals that are not empty.
    ended : bool
        False if the search ran out of steps while the cost was still falling.

    """

    model: Model
    cost: float
    residuals: Array
    residual_count: int
    ended: bool = True

    @property
    def name(self) -> str:
        """Return the last effect of the model; '' if it has none."""
        return self.model.effects[-1] if self.model.effects else ''


def residual_function(
    recordings: Recordings, model: Model, robust: bool = True,
    briefly: bool = False,
) -> Callable[[Array], Array]:
    """Return the function whose squares are minimised."""

    def stacked_residuals(values: Array) -> Array:
        there = model.with_free(values)
        with np.errstate(all='ignore'):
            each = [residuals(recording, there, robust, briefly) for recording in recordings]
        stacked = each[0] if len(each) == 1 else np.concatenate(each)
        small = np.abs(stacked) < _LARGEST
        return stacked if small.all() else np.where(small, stacked, _LARGEST)

    return stacked_residuals


def fit(
    recordings: Recordings, model: Model, steps: int = 25, briefly: bool = False,
    known: Array | None = None,
) -> Fit:
    """Search from the model's own values."""
    # Several stages of a diagnosis start from the same model.
    return recordings[0].fits.of(
        (tuple(recordings[1:]), model, steps, briefly),
        lambda: _searched(recordings, model, steps, briefly, known))


def _searched(
    recordings: Recordings, model: Model, steps: int, briefly: bool, known: Array | None
) -> Fit:
    (low, high), size = model.ranges, model.steps
    secant = SecantJacobian(
        residual_function(recordings, model, briefly=briefly), size, high)
    start, cost, brief = np.clip(model.coordinates, low + 1e-9 * size, high), np.inf, steps < 10
    least = _BRIEFLY if brief else _TO_END
    if known is not None and np.array_equal(start, model.coordinates):
        secant.know(start, known)
    with np.errstate(all='ignore'):  # costs may overflow far from the optimum
        while True:
            secant.residuals(start)  # the first of the steps, and known from the second search on
            secant.renew(steps - 1, least)
            found = least_squares(
                secant.residuals, start, secant.jacobian, bounds=(low, high), x_scale=size,
                max_nfev=steps, xtol=1e-6, gtol=1e-12, ftol=least)
            steps -= found.nfev - 1
            # A fresh start, with differenced derivatives and long steps, may see a way further.
            if brief or steps < 2 or found.cost > (1.0 - least) * cost:
                break
            start, cost = found.x, found.cost
    there = model.with_free(np.where(found.x - low < _AT_BOUND * size, low, found.x))
    count = sum(recording.residual_count for recording in recordings)
    return Fit(there, 2.0 * found.cost, found.fun, count, bool(found.status > 0))


def fit_to_end(recordings: Recordings, found: Fit) -> Fit:
    """Continue a search that ran out of steps."""
    for _ in range(_MOST_SEARCHES):
        if found.ended:
            break
        before, found = found.cost, fit(recordings, found.model, known=found.residuals)
        if found.cost > _SLOWLY * before:
            break
    return found


def fit_at(recordings: Recordings, model: Model, briefly: bool = False) -> Fit:
    """Evaluate a model at its values."""
    left = residual_function(recordings, model, briefly=briefly)(model.coordinates)
    count = sum(recording.residual_count for recording in recordings)
    return Fit(model, sum_of_squares(left), left, count, False)


def cost_of(recordings: Recordings, model: Model) -> float:
    """Return the cost of a model at its values."""
    return fit_at(recordings, model).cost


def sum_of_squares(residuals: Array) -> float:
    """Return the sum of the squares of residuals, shape (R,)."""
    return float(residuals @ residuals)
