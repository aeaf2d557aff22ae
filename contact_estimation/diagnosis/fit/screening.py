# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
Which effects promise most beside a model, told by linear algebra.

What each start of an effect changes in the residuals, and its derivatives there, are computed
once, beside the nominal model. Beside another model, the residuals that this one leaves are
regressed on them: one evaluation tells the order of all candidates.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray

from .fitting import Fit, residual_function, sum_of_squares
from .jacobian import differentiate_by
from ..compare.order import prior, ranked_by
from ..observe.model import Model, names_of
from ..observe.prepared_recording import Recordings
from ..observe.residuals import bends, huber
from ...physics import EFFECTS
from ...physics.drawn_effect import Scales

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

_FARTHEST = 1.0  # typical sizes by which one step may change a value that shapes a law
_LEAST_CHANGE = -0.99  # relative, of a value that a law is linear in and that is above 0


class _Start(NamedTuple):
    """
    A start of an effect beside the nominal model.

    Attributes
    ----------
    model : Model
        The nominal model with the effect.
    change : ndarray, shape (R,)
        Of the residuals.
    columns : ndarray, shape (R, p)
        Their derivatives by its free values, for changes by their typical sizes.
    rescaled : bool
        Whether the wall is that beside which the effect leaves the measured force.

    """

    model: Model
    change: Array
    columns: Array
    rescaled: bool

    @property
    def name(self) -> str:
        """Return the name of the effect."""
        return self.model.effects[-1]


class Step(NamedTuple):
    """
    A step from a start.

    Attributes
    ----------
    foretold : float
        Cost there, foretold by the derivatives.
    model : Model
        There.
    start : Model
        From where.

    """

    foretold: float
    model: Model
    start: Model

    @property
    def name(self) -> str:
        """Return the name of the last effect."""
        return self.model.effects[-1]


@dataclass(frozen=True, eq=False)
class Screening:
    """
    All starts of all effects, beside the nominal model.

    Attributes
    ----------
    recordings : sequence of PreparedRecording
        With a common discrepancy.
    base : Fit
        The recalibrated model.
    names : sequence of str
        The effects.
    scales : Scales
        Magnitudes of motion and forces.

    """

    recordings: Recordings
    base: Fit
    names: Sequence[str]
    scales: Scales

    def _straight(self, model: Model, values: Array) -> Array:
        """Return residuals that are neither bent nor have a long memory."""
        return residual_function(self.recordings, model, robust=False, briefly=True)(values)

    @cached_property
    def _starts(self) -> list[_Start]:
        here, starts = self._straight(self.base.model, self.base.model.coordinates), []
        for name in self.names:
            models = [self.base.model.with_effect(name, values)
                      for values in EFFECTS[name].starts(self.scales)]
            starts += [self._start(model, here, False) for model in models]
            if EFFECTS[name].rescales_wall:
                starts += [self._start(model.with_rescaled_wall(), here, True)
                           for model in models]
        return starts

    def _start(self, model: Model, here: Array, rescaled: bool) -> _Start:
        own = _of_newest(model)
        first = model.coordinates
        there = self._straight(model, first)

        def by_own(values: Array) -> Array:
            every = first.copy()
            every[own] = values
            return self._straight(model, every)

        columns = differentiate_by(
            first[own], model.steps[own], by_own, there, most=model.ranges[1][own])
        return _Start(model, there - here, columns, rescaled)

    def steps(self, present: Model, names: Sequence[str]) -> dict[str, list[Step]]:
        """Take one Gauss-Newton step from each start, beside a model."""
        straight = lambda values: self._straight(present, values)  # noqa: E731
        here = straight(present.coordinates)
        columns = differentiate_by(
            present.coordinates, present.steps, straight, here, most=present.ranges[1])
        basis = np.linalg.qr(columns)[0] if columns.shape[1] else np.zeros((len(here), 0))
        found = dict[str, list[Step]]()
        for start in self._starts:
            if start.name in names:
                found.setdefault(start.name, []).append(
                    self._step(present, start, here, columns, basis))
        best = {name: ranked_by(steps, lambda one: one.foretold) for name, steps in found.items()}
        order = ranked_by(best, lambda name: best[name][0].foretold, prior)
        return {name: best[name] for name in order}

    def _step(
        self, present: Model, start: _Start, here: Array, columns: Array, basis: Array
    ) -> Step:
        """Take the best of the steps of all its values, and of those it is linear in."""
        name, values = start.name, start.model.values[start.model.place(start.name)]
        made = present.with_effect(name, values)
        made = made.with_rescaled_wall() if start.rescaled else made
        shapes = _shapes(made)
        left = here + start.change
        left_over = left - basis @ (basis.T @ left)
        own = start.columns - basis @ (basis.T @ start.columns)
        best: tuple[float, Array] | None = None
        for free in (np.ones(len(shapes), bool), ~shapes):
            change = np.zeros(len(shapes))
            change[free] = np.linalg.lstsq(own[:, free], -left_over, rcond=1e-10)[0]
            if np.any(np.abs(change[shapes]) > _FARTHEST):
                change[shapes] = np.clip(change[shapes], -_FARTHEST, _FARTHEST)
                rest = left_over + own[:, shapes] @ change[shapes]
                change[~shapes] = np.linalg.lstsq(own[:, ~shapes], -rest, rcond=1e-10)[0]
            cost = self._cost(left_over + own @ change)
            if best is None or cost < best[0]:
                best = cost, change
            if not shapes.any():
                break
        assert best is not None
        cost, change = best
        target = left + start.columns @ change
        of_present = np.linalg.lstsq(columns, -target, rcond=1e-10)[0]
        return Step(cost, _moved(made, np.asarray(of_present, np.float64), change), made)

    def _cost(self, straight: Array) -> float:
        """Sum the squares of residuals, large ones bent."""
        bent, begin = 0.0, 0
        for one in self.recordings:
            stop = begin + len(one.channels(self.base.model)) * one.block_count
            part = straight[begin:stop]
            bent += sum_of_squares(huber(part) if bends(one, self.base.model) else part)
            begin = stop
        return bent


def _moved(model: Model, of_present: Array, change: Array) -> Model:
    """Return a model with all its values moved, within their ranges."""
    own, size = _of_newest(model), model.steps
    there = model.coordinates
    steps = np.zeros(len(there))
    steps[own] = change
    if len(of_present) == np.count_nonzero(~own):  # else the effect replaces a value of the wall
        steps[~own] = of_present
    factors = own & model.logarithmic[model.free] & ~np.isin(
        np.arange(len(there)), np.flatnonzero(own)[_shapes(model)])
    steps[factors] = np.log1p(np.maximum(steps[factors], _LEAST_CHANGE))
    return model.with_free(np.clip(there + steps * size, *model.ranges))


def _of_newest(model: Model) -> Flags:
    """Return which coordinates are those of the newest effect."""
    newest = np.zeros(len(model.values), bool)
    newest[model.place(model.effects[-1])] = True
    return newest[model.free]


def _shapes(model: Model) -> Flags:
    """Return which values of the newest effect shape it; it is linear in the others."""
    linear = EFFECTS[model.effects[-1]].linear()
    return np.array([name not in linear for name in names_of(model.effects[-1])])
