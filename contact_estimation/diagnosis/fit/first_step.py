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

"""First steps from the starts of a law: the best of many, for few evaluations."""

from __future__ import annotations

from functools import cached_property
from typing import Callable, NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray

from .fitting import Fit, fit, residual_function, sum_of_squares
from .jacobian import differentiate_by
from .order import ranked_by
from ..observe.model import Model, names_of
from ..observe.prepared_recording import Recordings
from ..observe.residuals import bends, huber
from ...physics import EFFECTS

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

_SHORT = 0.3  # of a step that is too long
_DIFFERENTIATED = 3  # starts, of many near a known model
_OF_GAPS = 'clearance'  # family: a gap twice as wide is no force twice as large
_LEAST_CHANGE = -0.99  # relative, of a value that a law is linear in and that is above 0


class Step(NamedTuple):
    """
    A Gauss-Newton step.

    Attributes
    ----------
    cost : float
        At `model`.
    model : Model
        After the step.
    start : Model
        Before it.
    residuals : ndarray, shape (R,), or None
        At `model`, large ones bent, without a long memory; None if it was not evaluated.

    """

    cost: float
    model: Model
    start: Model
    residuals: Array | None


class Straight(NamedTuple):
    """
    Residuals of a model and their derivatives, neither bent nor with a long memory.

    Attributes
    ----------
    here : ndarray, shape (R,)
        Residuals.
    columns : ndarray, shape (R, P)
        Derivatives by each coordinate, for a change by its typical size.

    """

    here: Array
    columns: Array


def straight_at(recordings: Recordings, model: Model) -> Straight:
    """
    Differentiate the residuals of a model.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        Fitted together.
    model : Model
        With its values.

    Returns
    -------
    straight : Straight
        At its values.

    """
    straight, start = _straight(recordings, model), model.coordinates
    here = straight(start)
    return Straight(here, differentiate_by(start, model.steps, straight, here,
                                           most=model.ranges[1]))


def _straight(recordings: Recordings, model: Model) -> Callable[[Array], Array]:
    """Return the residuals as a function of the coordinates; bent, steps would be too short."""
    return residual_function(recordings, model, robust=False, briefly=True)


def steps(
    recordings: Recordings, starts: Sequence[Model], before: Straight | None = None
) -> list[Step]:
    """
    Take one Gauss-Newton step, exact in linear parameters, from each start that may be the best.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        Fitted together.
    starts : sequence of Model
        With the same effects.
    before : Straight, optional
        Of the model without the newest law, near which all starts are.

    Returns
    -------
    steps : list of Step
        Best first. A start whose derivatives foretell more than the cost of the best is left
        where it is, at the cost that they foretell. Of many near a known model, of a law that has
        a size and a shape, only those are differentiated that leave least in the best size.

    """
    made = [_Start(recordings, model, before) for model in starts]
    if before is not None and len(made) > _DIFFERENTIATED and made[0].has_size_and_shape:
        made = ranked_by(made, lambda start: start.in_size)[:_DIFFERENTIATED]
    near = ranked_by(made, lambda start: start.foretold)
    taken: list[Step] = []
    for start in near:
        if taken and start.foretold > min(step.cost for step in taken):
            taken.append(Step(start.foretold, start.model, start.model, None))
        else:
            taken.append(start.step())
    return ranked_by(taken, _cost_of)


def fit_without(recordings: Recordings, model: Model, names: Sequence[str]) -> Fit:
    """
    Fit a model without some of its effects.

    What they carried the others take over in one step. A search alone, which takes small steps
    where a value is small, ends in between where a law had taken the place of the spring.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        Fitted together.
    model : Model
        With the effects.
    names : sequence of str
        Those that are left out.

    Returns
    -------
    found : Fit
        Of the model with the other effects.

    """
    return fit(recordings, steps(recordings, [model.without(*names)])[0].model)


class _Start:
    """
    A start, its residuals and their derivatives.

    Attributes
    ----------
    model : Model
        The start.
    in_size : float
        Cost with the best multiple of the newest law beside the best other values, were the
        residuals linear.
    foretold : float
        Cost after a step, were the residuals linear.

    """

    def __init__(self, recordings: Recordings, model: Model, before: Straight | None) -> None:
        self.model, self._recordings, self._before = model, recordings, before
        self._residuals = _straight(recordings, model)
        low, high = model.ranges
        self._values = np.clip(model.coordinates, low, high)
        self._here = self._residuals(self._values)
        self._shapes = _shapes(model)
        self._every = np.ones(len(self._values), bool)
        self._wall = np.arange(len(self._values)) < np.count_nonzero(model.free[:2])
        self._cost_here = self._cost(self._here)

    @property
    def has_size_and_shape(self) -> bool:
        """Whether the newest law is linear in some of its values and shaped by others."""
        of_gap = EFFECTS[self.model.effects[-1]].family == _OF_GAPS
        return bool(self._shapes.any()) and not of_gap

    @cached_property
    def in_size(self) -> float:
        """Return the cost with the best size; see the attributes."""
        assert self._before is not None
        here, columns = self._before
        every = np.column_stack((columns, self._here - here))
        return self._cost(here - every @ np.linalg.lstsq(every, here, rcond=1e-10)[0])

    @cached_property
    def foretold(self) -> float:
        """Return the cost after a step; see the attributes."""
        return min(self._foretold(self._every), self._cost_here)

    @cached_property
    def _columns(self) -> Array:
        """Return the derivatives, shape (R, P), for a change by the typical size."""
        before = self._before
        known = 0 if before is None else before.columns.shape[1]
        first = self._values[:known]
        own = differentiate_by(
            self._values[known:], self.model.steps[known:],
            lambda own: self._residuals(np.concatenate([first, own])), self._here,
            most=self.model.ranges[1][known:])
        return own if before is None else np.hstack([before.columns, own])

    @cached_property
    def _factor(self) -> Array:
        """Return the triangular factor, of which any columns give the same step as of all rows."""
        return np.asarray(np.linalg.qr(np.column_stack((self._columns, -self._here)), mode='r'))

    def step(self) -> Step:
        """
        Take the step.

        One of all values is too long where the newest law is far from linear in those that shape
        it; then one of what it is linear in and the others alone is better. Where there is almost
        no spring, nothing tells where it is: then one of K_e and B_e alone helps.

        Returns
        -------
        step : Step
            To where the cost is least; none if the step would raise it.

        """
        best = self._tried(self._every)
        if self._shapes.any() and self._foretold(~self._shapes) < best.cost:
            best = min(best, self._tried(~self._shapes), key=_cost_of)
        if best.cost >= self._cost_here:
            best = min(self._at(self._values, self._here), self._tried(self._every, _SHORT),
                       self._tried(self._wall), key=_cost_of)
        return best

    def _change(self, free: Flags) -> Array:
        """Return the step, shape (P,), in typical sizes, of the coordinates that are free."""
        change = np.zeros(len(self._values))
        change[free] = np.linalg.lstsq(self._factor[:, :-1][:, free], self._factor[:, -1],
                                       rcond=1e-10)[0]
        return change

    def _foretold(self, free: Flags) -> float:
        return self._cost(self._here + self._columns @ self._change(free))

    def _tried(self, free: Flags, share: float = 1.0) -> Step:
        model = self.model
        change = self._change(free) * model.steps
        if not np.any(free & self._shapes):  # then the law is linear in those of the logarithms
            factors = _of_newest(model) & model.logarithmic[model.free] & ~self._shapes
            change[factors] = np.log1p(np.maximum(change[factors], _LEAST_CHANGE))
        there = np.clip(self._values + share * change, *model.ranges)
        return self._at(there, self._residuals(there))

    def _at(self, values: Array, straight: Array) -> Step:
        """Return the step to values of which the residuals are known, large ones not bent."""
        bent = self._bent(straight)
        return Step(sum_of_squares(bent), self.model.with_free(values), self.model, bent)

    def _cost(self, straight: Array) -> float:
        return sum_of_squares(self._bent(straight))

    def _bent(self, straight: Array) -> Array:
        """Bend large residuals."""
        parts, begin = [], 0
        for one in self._recordings:
            stop = begin + len(one.channels(self.model)) * one.block_count
            part = straight[begin:stop]
            parts.append(huber(part) if bends(one, self.model) else part)
            begin = stop
        return parts[0] if len(parts) == 1 else np.concatenate(parts)


def _cost_of(step: Step) -> float:
    return step.cost


def _shapes(model: Model) -> Flags:
    """Return which coordinates shape the newest law, which is linear in its others."""
    shapes = np.zeros(len(model.values), bool)
    if model.effects:
        name = model.effects[-1]
        linear = EFFECTS[name].linear()
        shapes[model.place(name)] = [parameter not in linear for parameter in names_of(name)]
    return shapes[model.free]


def _of_newest(model: Model) -> Flags:
    """Return which coordinates are those of the newest law."""
    newest = np.zeros(len(model.values), bool)
    if model.effects:
        newest[model.place(model.effects[-1])] = True
    return newest[model.free]
