# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Jacobian of residuals that is kept up to date by what a search evaluates anyway."""

from __future__ import annotations

from typing import Callable

import numpy as np
from numpy.typing import NDArray

from ..observe.model import Model, names_of
from ...physics import EFFECTS

Array = NDArray[np.float64]

_STEP = 1e-4  # of forward differences, as a share of the typical change of a value
# Where the force vanishes at an instant that depends on the value: a smaller step moves the
# instant past a few samples, or none.
_ACROSS = 0.1
_PREDICTED = 0.2  # of a change of the residuals: what the Jacobian may miss and be kept


class SecantJacobian:
    """
    Jacobian by forward differences, and from there by rank-one updates while it predicts well.

    A least-squares search evaluates the residuals at each of its points. Where they change as the
    Jacobian J foretells, Broyden's update J + (dr - J dx) dx' / (dx' dx), with dx in units of the
    typical changes, needs no further evaluation; where not, J is differenced anew. Source:
    C. G. Broyden, A class of methods for solving nonlinear simultaneous equations, Math. Comp. 19
    (1965); K. Madsen, H. B. Nielsen and O. Tingleff, Methods for Non-Linear Least Squares
    Problems (2004), section 3.5.

    Parameters
    ----------
    function : callable
        Values to residuals.
    size : ndarray, shape (P,)
        Typical change of each value.
    most : ndarray, shape (P,)
        Upper bounds of the values.
    share : float
        Step of the differences, as a share of `size`.

    Attributes
    ----------
    updated : bool
        Whether the last Jacobian is one of an update.

    """

    def __init__(
        self, function: Callable[[Array], Array], size: Array, most: Array, share: float = _STEP
    ) -> None:
        self._function, self._size, self._most, self._share = function, size, most, share
        self._last: tuple[Array, Array] | None = None  # point and residuals evaluated last
        self._at: tuple[Array, Array, Array] | None = None  # point, residuals, J by the size
        self._left, self._gain = np.inf, -np.inf  # evaluations and gain at which the search ends
        self.updated = False

    def know(self, values: Array, residuals: Array) -> None:
        """Take the residuals, shape (R,), at values, shape (P,), as evaluated."""
        self._last = values.copy(), residuals

    def residuals(self, values: Array) -> Array:
        """Evaluate the residuals, shape (R,), at values, shape (P,)."""
        if self._last is None or not np.array_equal(self._last[0], values):
            self._last = values.copy(), self._function(values)
            self._left -= 1
        return self._last[1]

    def jacobian(self, values: Array) -> Array:
        """Return the derivatives, shape (R, P), at values, shape (P,)."""
        here = self.residuals(values)
        columns = self._from_last_point(values, here)
        self.updated = columns is not None
        if columns is None:
            columns = differentiate_by(
                values, self._size, self._function, here, self._share, self._most)
        self._at = values.copy(), here, columns
        return columns / self._size

    def renew(self, evaluations: float = np.inf, gain: float = -np.inf) -> None:
        """Difference the next Jacobian."""
        self._at = None
        self._left, self._gain = evaluations, gain

    def _from_last_point(self, values: Array, here: Array) -> Array | None:
        """Update the Jacobian of the last point; None if it does not predict the residuals."""
        if self._at is None:
            return None
        before, residuals, columns = self._at
        change = (values - before) / self._size
        length = float(change @ change)
        if not length:
            return columns
        changed = here - residuals
        missed = changed - columns @ change
        predicted = missed @ missed <= _PREDICTED ** 2 * (changed @ changed)
        gained_little = here @ here > (1.0 - self._gain) * (residuals @ residuals)
        if not (predicted or gained_little or self._left < 1):
            return None
        updated: Array = columns + np.outer(missed / length, change)
        return updated


def differentiate_by(
    values: Array, size: Array, function: Callable[[Array], Array], here: Array,
    share: float | Array = _STEP, most: Array | None = None,
) -> Array:
    """Differentiate a function of several values by forward differences."""
    columns = np.empty((len(here), len(values)))
    for k, change in enumerate(np.broadcast_to(share, values.shape).tolist()):
        moved = values.copy()
        if most is not None and values[k] + change * size[k] > most[k]:
            change = -change
        moved[k] += change * size[k]
        columns[:, k] = (function(moved) - here) / change
    return columns


def jacobian_at(model: Model, function: Callable[[Array], Array], here: Array) -> Array:
    """Differentiate residuals by the free values of a model, with steps that show its switches."""
    lets_go = [EFFECTS[effect].lets_go for effect in model.effects for _ in names_of(effect)]
    shares = np.where([False] * model.base_count + lets_go, _ACROSS, _STEP)[model.free]
    return differentiate_by(
        model.coordinates, model.steps, function, here, shares, model.ranges[1])
