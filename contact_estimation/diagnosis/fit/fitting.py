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

"""Fitting a model to recordings: Gauss-Newton steps, then a bounded search."""

from __future__ import annotations

from typing import Callable, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from ..observe.model import Model, names_of
from ..observe.prepared_recording import Recordings
from ..observe.residuals import bends, huber, residuals
from ...physics import EFFECTS

Array = NDArray[np.float64]

_STEP = 1e-4  # relative, of the finite differences
_MOST_SEARCHES, _SLOWLY = 4, 0.99  # of 25 steps; less than a hundredth is no progress
_AT_BOUND = 1e-6  # of its typical change: a value at the lower bound of its range
_LEAST_CHANGE = -0.99  # relative, of a value that a law is linear in and that is above 0
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


def residual_function(
    recordings: Recordings, model: Model, robust: bool = True,
    briefly: bool = False,
) -> Callable[[Array], Array]:
    """
    Return the function whose squares are minimised.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        Fitted together.
    model : Model
        Its `coordinates` are the unknowns.
    robust, briefly : bool
        As for `residuals`.

    Returns
    -------
    residuals : callable
        Coordinates to stacked residuals.

    """

    def stacked_residuals(values: Array) -> Array:
        there = model.with_free(values)
        with np.errstate(all='ignore'):
            stacked = np.concatenate(
                [residuals(recording, there, robust, briefly) for recording in recordings])
        return np.where(np.abs(stacked) < _LARGEST, stacked, _LARGEST)

    return stacked_residuals


def fit(recordings: Recordings, model: Model, steps: int = 25, briefly: bool = False) -> Fit:
    """
    Search from the model's own values.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        Fitted together.
    model : Model
        Start; its free values are searched.
    steps : int
        Most steps of the search; with few of them it also ends at a thousandth of the cost.
    briefly : bool
        As for `residuals`.

    Returns
    -------
    fit : Fit
        The best found.

    """
    function = residual_function(recordings, model, briefly=briefly)
    (low, high), size = model.ranges, model.steps
    with np.errstate(all='ignore'):  # costs may overflow far from the optimum
        found = least_squares(
            function, np.clip(model.coordinates, low + 1e-9 * size, high), bounds=(low, high),
            x_scale=size, diff_step=_STEP, max_nfev=steps, xtol=1e-6, gtol=1e-12,
            ftol=1e-3 if steps < 10 else 1e-6,
        )
    there = model.with_free(np.where(found.x - low < _AT_BOUND * size, low, found.x))
    count = sum(recording.residual_count for recording in recordings)
    return Fit(there, 2.0 * found.cost, found.fun, count, bool(found.status > 0))


def fit_to_end(recordings: Recordings, found: Fit) -> Fit:
    """
    Continue a search that ran out of steps.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        Fitted together.
    found : Fit
        So far.

    Returns
    -------
    fit : Fit
        At which no further step gains much.

    """
    for _ in range(_MOST_SEARCHES):
        if found.ended:
            break
        before, found = found.cost, fit(recordings, found.model)
        if found.cost > _SLOWLY * before:
            break
    return found


def differentiate_by(
    values: Array, size: Array, function: Callable[[Array], Array], here: Array,
    share: float = _STEP, most: Array | None = None,
) -> Array:
    """
    Differentiate a function of several values by forward differences.

    Parameters
    ----------
    values : ndarray, shape (P,)
        The point.
    size : ndarray, shape (P,)
        Typical change of each value.
    function : callable
        Values to residuals.
    here : ndarray, shape (R,)
        Its result at `values`.
    share : float
        Step, as a share of `size`.
    most : ndarray, shape (P,), optional
        Upper bounds of the values; steps that would exceed them go backwards.

    Returns
    -------
    jacobian : ndarray, shape (R, P)
        A column for each value, for a change by its size.

    """
    columns = np.empty((len(here), len(values)))
    for k in range(len(values)):
        moved, change = values.copy(), share
        if most is not None and values[k] + change * size[k] > most[k]:
            change = -share
        moved[k] += change * size[k]
        columns[:, k] = (function(moved) - here) / change
    return columns


def derivatives(recordings: Recordings, model: Model) -> Array:
    """
    Differentiate the residuals of a model, neither bent nor with a long memory.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        Fitted together.
    model : Model
        With its values.

    Returns
    -------
    columns : ndarray, shape (R, P)
        By each coordinate, for a change by its typical size.

    """
    straight = residual_function(recordings, model, robust=False, briefly=True)
    start = model.coordinates
    return differentiate_by(start, model.steps, straight, straight(start), most=model.ranges[1])


def step(
    recordings: Recordings, model: Model, others: Array | None = None
) -> tuple[float, Model]:
    """
    Take one Gauss-Newton step, exact in linear parameters.

    A step of all values is too long where the newest law is far from linear in those that shape
    it; then one of what it is linear in and the wall alone is better.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        Fitted together.
    model : Model
        Start.
    others : ndarray, shape (R, P'), optional
        Known derivatives by the coordinates before those of the newest law.

    Returns
    -------
    cost : float
        After the step; before it if the step would raise the cost.
    model : Model
        At that cost.

    """
    # Bent residuals would make the first step too short.
    straight = residual_function(recordings, model, robust=False, briefly=True)
    (low, high), size = model.ranges, model.steps
    start = np.clip(model.coordinates, low, high)
    at_start = straight(start)
    known = 0 if others is None else others.shape[1]
    columns = differentiate_by(
        start[known:], size[known:], lambda own: straight(np.concatenate([start[:known], own])),
        at_start, most=high[known:])
    if others is not None:
        columns = np.hstack([others, columns])

    def tried(free: NDArray[np.bool_], share: float = 1.0) -> tuple[float, Array]:
        change = np.zeros(len(start))
        change[free] = np.linalg.lstsq(columns[:, free], -at_start, rcond=1e-10)[0] * size[free]
        if not np.any(free & shapes):  # then the law is linear in the values of the logarithms
            change[factors] = np.log1p(np.maximum(change[factors], _LEAST_CHANGE))
        there = np.clip(start + share * change, low, high)
        return _robust_cost(recordings, model, straight(there)), there

    shapes, every = _shapes(model), np.ones(len(start), bool)
    factors = _of_newest(model) & model.logarithmic[model.free] & ~shapes
    cost_at_start = _robust_cost(recordings, model, at_start)
    kinds = (every, ~shapes) if shapes.any() else (every,)
    best_cost, best = min((tried(free) for free in kinds), key=_cost)
    if best_cost >= cost_at_start:
        best_cost, best = min((cost_at_start, start), tried(every, 0.3), key=_cost)
    return best_cost, model.with_free(best)


def _robust_cost(recordings: Recordings, model: Model, straight: Array) -> float:
    """Return the cost of residuals of which large ones are not bent yet."""
    cost, begin = 0.0, 0
    for one in recordings:
        stop = begin + len(one.channels(model)) * one.block_count
        part = straight[begin:stop]
        cost += _sum_of_squares(huber(part) if bends(one, model) else part)
        begin = stop
    return cost


def _cost(result: tuple[float, Array]) -> float:
    return result[0]


def _shapes(model: Model) -> NDArray[np.bool_]:
    """Return which coordinates shape the newest law, which is linear in its others."""
    shapes = np.zeros(len(model.values), bool)
    if model.effects:
        name = model.effects[-1]
        linear = EFFECTS[name].linear()
        shapes[model.place(name)] = [parameter not in linear for parameter in names_of(name)]
    return shapes[model.free]


def _of_newest(model: Model) -> NDArray[np.bool_]:
    """Return which coordinates are those of the newest law."""
    newest = np.zeros(len(model.values), bool)
    if model.effects:
        newest[model.place(model.effects[-1])] = True
    return newest[model.free]


def fit_at(recordings: Recordings, model: Model) -> Fit:
    """
    Evaluate a model at its values.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        To compare it with.
    model : Model
        With its values.

    Returns
    -------
    fit : Fit
        Nothing is searched.

    """
    left = residual_function(recordings, model)(model.coordinates)
    count = sum(recording.residual_count for recording in recordings)
    return Fit(model, _sum_of_squares(left), left, count, False)


def cost_of(recordings: Recordings, model: Model) -> float:
    """
    Return the cost of a model at its values.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        To compare it with.
    model : Model
        With its values.

    Returns
    -------
    cost : float
        Sum of the squared residuals, in standard deviations.

    """
    return fit_at(recordings, model).cost


def _sum_of_squares(residuals: Array) -> float:
    return float(residuals @ residuals)
