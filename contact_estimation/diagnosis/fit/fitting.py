# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Jacobian of residuals that is kept up to date by what a search evaluates anyway."""

from typing import Callable, NamedTuple

import numpy as np
from scipy.optimize import least_squares

from ..observe.model import Model, names_of
from ..observe.prepared_recording import Recordings
from ..observe.residuals import residuals
from ...physics import EFFECTS
from ...physics.numeric import Array

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

    function: values to residuals
    size (P,): typical change of each value
    most (P,): upper bounds of the values
    """

    def __init__(self, function: Callable[[Array], Array], size: Array, most: Array) -> None:
        self._function, self._size, self._most = function, size, most
        self._last: tuple[Array, Array] | None = None  # point and residuals evaluated last
        self._at: tuple[Array, Array, Array] | None = None  # point, residuals, J by the size
        self._left, self._gain = np.inf, -np.inf  # evaluations and gain at which the search ends

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
        if columns is None:
            columns = differentiate_by(
                values, self._size, self._function, here, most=self._most)
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
    steps = [_ACROSS if getattr(EFFECTS[effect], 'lets_go', False) else _STEP
             for effect in model.effects for _ in names_of(effect)]
    shares = np.array([_STEP] * model.base_count + steps)[model.free]
    return differentiate_by(
        model.coordinates, model.steps, function, here, shares, model.ranges[1])


_MOST_SEARCHES, _SLOWLY = 4, 0.99  # of 25 steps; less than a hundredth is no progress
_BRIEFLY, _TO_END = 1e-3, 1e-6  # relative gain at which a search ends
_AT_BOUND = 1e-6  # of its typical change: a value at the lower bound of its range
# Standard deviations that typical changes cost: rounding moves nothing that data leave open.
_HELD = 1e-6
_LARGEST = 1e6  # standard deviations, also for what is not finite: a diverged model


class Fit(NamedTuple):
    """A fitted model."""

    model: Model  # with the best values
    cost: float  # sum of the squared residuals, in standard deviations
    residuals: Array  # (R,) at the best values
    residual_count: int  # number of residuals that are not empty
    ended: bool = True  # false if the search ran out of steps while the cost was still falling

    @property
    def name(self) -> str:
        """Return the last effect of the model; '' if it has none."""
        return self.model.effects[-1] if self.model.effects else ''


def residual_function(
    recordings: Recordings, model: Model, robust: bool = True, briefly: bool = False
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
    size, function = model.steps, residual_function(recordings, model, briefly=briefly)
    # In typical changes, so that no criterion of the search depends on units.
    (low, high), given = (bound / size for bound in model.ranges), model.coordinates / size
    secant = SecantJacobian(lambda values: function(values * size), np.ones(len(size)), high)
    start, cost, brief = np.clip(given, low + 1e-9, high), np.inf, steps < 10
    least, held = _BRIEFLY if brief else _TO_END, _HELD * np.eye(len(size))
    if known is not None and np.array_equal(start, given):
        secant.know(start, known)
    with np.errstate(all='ignore'):  # costs may overflow far from the optimum
        while True:
            secant.residuals(start)  # the first of the steps, and known from the second search on
            secant.renew(steps - 1, least)
            found = least_squares(
                lambda x: np.append(secant.residuals(x), _HELD * (x - given)), start,
                lambda x: np.vstack([secant.jacobian(x), held]), bounds=(low, high),
                max_nfev=steps, xtol=1e-6, gtol=1e-12, ftol=least)
            steps -= found.nfev - 1
            # A fresh start, with differenced derivatives and long steps, may see a way further.
            if brief or steps < 2 or found.cost > (1.0 - least) * cost:
                break
            start, cost = found.x, found.cost
    there = model.with_free(np.where(found.x - low < _AT_BOUND, low, found.x) * size)
    count = sum(recording.residual_count for recording in recordings)
    left = found.fun[:len(found.fun) - len(size)]
    return Fit(there, sum_of_squares(left), left, count, bool(found.status > 0))


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
