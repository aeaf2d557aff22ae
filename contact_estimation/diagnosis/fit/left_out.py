# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The errors of a model on parts of the recordings that it was not fitted on."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Sequence

import numpy as np
from numpy.typing import NDArray

from .discrepancy import CHANNELS
from .fitting import Fit, residual_function
from .jacobian import jacobian_at
from .parts import Part
from ..observe.model import Model
from ..observe.prepared_recording import Recordings
from ..observe.residuals import bends, huber, ROBUST

Array = NDArray[np.float64]

_LOOSE = 3.0  # typical sizes of a value: standard deviation of its prior
_OUTLIER = 5.0  # standard deviations beyond which an error counts as one at that distance
_SUSPICIOUS = 3.0  # times the error as fitted: a prediction that may be no longer linear
_DAMPING = (0.0, 0.01, 0.1, 1.0, 10.0)  # of a step, of the normal matrix (Marquardt 1963)
_USUAL = 0.455  # median of a squared normal error, in its mean


@dataclass(frozen=True, eq=False)
class Linearised:
    """
    A fit and its derivatives, from which the fits on some of the parts follow by linear algebra.

    Attributes
    ----------
    recordings : sequence of PreparedRecording
        With the discrepancy of the model.
    found : Fit
        On all parts.
    parts : sequence of Part
        Of the recordings.

    """

    recordings: Recordings
    found: Fit
    parts: Sequence[Part]
    here: Array = field(init=False, repr=False)
    jacobian: Array = field(init=False, repr=False)

    def __post_init__(self) -> None:
        """Differentiate the residuals at the fit."""
        model = self.found.model
        function = residual_function(self.recordings, model, robust=False)
        here = function(model.coordinates)
        object.__setattr__(self, 'here', here)
        object.__setattr__(self, 'jacobian', jacobian_at(model, function, here))

    @cached_property
    def channel(self) -> NDArray[np.int_]:
        """Return the channel of each residual, shape (R,): 0 force, or the only one, 1 motion."""
        model = self.found.model
        return np.concatenate([np.full(one.block_count, k) for one in self.recordings
                               for k in range(len(one.channels(model)))])

    @cached_property
    def in_noise(self) -> Array:
        """Return squares in those of noise, over squares as weighed, shape (R,)."""
        shares = np.concatenate([channel.noise_share for one in self.recordings
                                 for channel in one.channels(self.found.model)])
        return np.where(shares > 0.0, 1.0 / np.maximum(shares, 1e-12), 0.0)

    @cached_property
    def _weighed(self) -> Array:
        """Return derivatives, weighed so that large residuals count linearly, shape (R, F)."""
        model = self.found.model
        if not any(bends(one, model) for one in self.recordings):
            return self.jacobian
        weights = np.minimum(1.0, ROBUST / np.maximum(np.abs(self.here), 1e-300))
        return np.asarray(self.jacobian * weights[:, None])

    @cached_property
    def _sums(self) -> list[tuple[Array, Array]]:
        """Return the normal matrix and the gradient of each part."""
        return [(self._weighed[part.there].T @ self.jacobian[part.there],
                 self._weighed[part.there].T @ self.here[part.there]) for part in self.parts]

    def _step(self, normal: Array, gradient: Array, damping: float = 0.0) -> Array:
        """Return the step of the coordinates, in typical sizes, within their ranges."""
        model = self.found.model
        prior = np.eye(len(gradient)) / _LOOSE**2 + damping * np.diag(np.diag(normal))
        change = -np.linalg.solve(normal + prior, gradient)
        low, high = ((bound - model.coordinates) / model.steps for bound in model.ranges)
        return np.clip(change, np.minimum(low, 0.0), np.maximum(high, 0.0))

    @cached_property
    def left_out(self) -> Array:
        """Return mean squares as predicted by the fit on the others, shape (P, CHANNELS)."""
        normal, gradient = (sum(each[k] for each in self._sums) for k in (0, 1))
        squares = np.zeros((len(self.parts), CHANNELS))
        for k, (part, (of_part, pull)) in enumerate(zip(self.parts, self._sums)):
            change = self._step(normal - of_part, gradient - pull)
            errors = self.here[part.there] + self.jacobian[part.there] @ change
            squares[k] = self._mean_squares(part, errors)
            if np.any(squares[k] > _SUSPICIOUS * np.maximum(self.fitted[k], 1.0)):
                squares[k] = self._mean_squares(part, self._stepped(
                    part, normal - of_part, gradient - pull))
        return squares

    def _stepped(self, part: Part, normal: Array, gradient: Array) -> Array:
        """Return the errors on a part after the least damped step that does not harm the rest."""
        model, rest = self.found.model, ~part.there
        function = residual_function(self.recordings, model, robust=False)
        bent = huber(self.here[rest])
        for damping in _DAMPING:
            change = self._step(normal, gradient, damping)
            there = function(model.coordinates + change * model.steps)
            left = huber(there[rest])
            if left @ left <= bent @ bent:
                return np.asarray(there[part.there])
        return np.asarray(self.here[part.there])

    @cached_property
    def fitted(self) -> Array:
        """Return mean squares of the errors of the fit, shape (P, CHANNELS)."""
        return np.array([self._mean_squares(part, self.here[part.there]) for part in self.parts])

    @cached_property
    def counts(self) -> Array:
        """Return the number of residuals, shape (P, CHANNELS)."""
        return np.array([np.bincount(self.channel[part.there], minlength=CHANNELS)
                         for part in self.parts], float)

    def _mean_squares(self, part: Part, errors: Array) -> Array:
        """Average squares by channel, in those of noise; an outlier counts as a large error."""
        found, channel = np.zeros(CHANNELS), self.channel[part.there]
        squares = errors**2 * self.in_noise[part.there]
        for k in range(CHANNELS):
            of_channel = squares[channel == k]
            if len(of_channel):
                usual = max(1.0, float(np.median(of_channel)) / _USUAL)
                found[k] = float(np.mean(np.minimum(of_channel, _OUTLIER**2 * usual)))
        return found

    def values_on(self, part: Part) -> Model:
        """Return the model as fitted to one part alone, with a loose prior at all parts."""
        k = next(k for k, one in enumerate(self.parts) if one is part)
        change = self._step(*self._sums[k])
        return self.found.model.with_free(
            self.found.model.coordinates + change * self.found.model.steps)
