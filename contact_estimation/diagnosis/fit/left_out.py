# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The parts of recordings that are left out in turn: contacts, or blocks of time."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray

from .discrepancy import CHANNELS, discounted
from .evidence import Scored
from .fitting import Fit, jacobian_at, residual_function
from ..checks.check import bend_of, STRAIGHT
from ..observe.channel import ROBUST
from ..observe.model import Model
from ..observe.parts import episodes
from ..observe.prepared_recording import PreparedRecording, Recordings
from ..observe.residuals import bends, huber
from ...physics.numeric import Array, Flags

_LEAST_PARTS, _MOST_PARTS = 4, 8
_EVENT, _PIECES = 0.6, 5  # share of the misfit in one block; pieces of a part
_LEAST_RESIDUALS = 8  # of a part


class Part(NamedTuple):
    """A part of the recordings."""

    name: str  # such as 'episode 2' or '3.0 to 4.5 s'
    there: Flags  # (R,) its residuals among the stacked ones of all recordings


def parts_of(recordings: Recordings, found: Fit) -> list[Part]:
    """Divide the fitted samples of recordings into parts."""
    parts = _parts_of(recordings, found.model, 1)
    misfit = np.array([np.sum(found.residuals[part.there] ** 2) for part in parts])
    is_event = misfit.max(initial=0.0) > _EVENT * misfit.sum()
    if is_event or all(_is_one_stroke(one, found.model) for one in recordings):
        return _parts_of(recordings, found.model, _PIECES)
    return parts


def _is_one_stroke(one: PreparedRecording, model: Model) -> bool:
    """Return whether a wall is moved or pressed once, at a constant speed."""
    o, here = one.observed, slice(None)
    if model.nominal.environment.unilateral:
        spans = episodes(model, o)
        if len(spans) != 1:
            return False
        here = slice(*spans[0])
    return bend_of(o.t[here], o.x[here]) <= STRAIGHT


def _parts_of(recordings: Recordings, model: Model, pieces: int) -> list[Part]:
    parts, begin = [], 0
    total = sum(len(one.channels(model)) * one.block_count for one in recordings)
    least = -(-_LEAST_PARTS // len(recordings))
    for one in recordings:
        channels = one.channels(model)
        filled = np.concatenate([channel.filled for channel in channels])
        prefix = f'{one.name}, ' if len(recordings) > 1 else ''
        for name, blocks in _divide(one, model, least, pieces):
            here = np.tile(blocks, len(channels)) & filled
            if np.count_nonzero(here) >= _LEAST_RESIDUALS:
                there = np.zeros(total, bool)
                there[begin:begin + len(here)] = here
                parts.append(Part(prefix + name, there))
        begin += len(filled)
    return parts


def _divide(
    one: PreparedRecording, model: Model, least: int, pieces: int
) -> list[tuple[str, Flags]]:
    """Name the parts of one recording and find their blocks."""
    o, count = one.observed, one.block_count
    fitted = one.blocks(one.use.astype(float)) > 0.0
    found = [(first, stop) for first, stop in episodes(model, o)
             if fitted[first // one.block:stop // one.block + 1].any()]
    if len(found) > _MOST_PARTS:
        groups = np.array_split(np.arange(len(found)), _MOST_PARTS)
        spans = [(found[g[0]][0], found[g[-1]][1]) for g in groups]
        names = [f'episodes {g[0] + 1} to {g[-1] + 1}' if len(g) > 1 else f'episode {g[0] + 1}'
                 for g in groups]
        return _between(names, spans, count, one.block)
    if len(found) >= least:
        numbers = [k for k, pair in enumerate(episodes(model, o)) if pair in found]
        return _between([f'episode {k + 1}' for k in numbers], found, count, one.block)
    number = -(-max(least, _LEAST_PARTS if not found else 2) // max(len(found), 1))
    spans = found or [(0, len(o.t))]
    around = [blocks for _, blocks in _between(['' for _ in spans], spans, count, one.block)]
    parts: list[tuple[str, Flags]] = []
    for (first, stop), near in zip(spans, around):
        inside = near & (pieces > 1)  # of an event in free flight, too, pieces are spread
        inside[first // one.block:-(-stop // one.block)] = True
        split = np.array_split(np.flatnonzero(inside & fitted), number * pieces)
        for k in range(number):
            blocks = np.zeros(count, bool)
            for places in split[k::number]:
                blocks[places] = True
            places = np.flatnonzero(blocks)
            if len(places):
                begin, end = places[0] * one.block_s, (places[-1] + 1) * one.block_s
                every = f', 1 piece in {number}' if pieces > 1 else ''
                flight = near & ~inside
                flight[:places[0]] &= k == 0
                flight[places[-1]:] &= k == number - 1
                parts.append((f'{begin:.3g} to {end:.3g} s{every}', blocks | flight))
    return parts


def _between(
    names: Sequence[str], spans: Sequence[tuple[int, int]], count: int, block: int
) -> list[tuple[str, Flags]]:
    """Extend each span by half the gap to its neighbours."""
    edges = [(stop + first) // 2 // block for (_, stop), (first, _) in zip(spans, spans[1:])]
    parts = []
    for name, first, stop in zip(names, [0, *edges], [*edges, count]):
        blocks = np.zeros(count, bool)
        blocks[first:stop] = True
        parts.append((name, blocks))
    return parts


_LOOSE = 3.0  # typical sizes of a value: standard deviation of its prior
_SUSPICIOUS = 3.0  # times the error as fitted, or a part of it: a step that may not be linear
_DAMPING = (0.0, 0.01, 0.1, 1.0, 10.0)  # of a step, of the normal matrix (Marquardt 1963)
_USUAL = 0.455  # median of a squared normal error, in its mean


@dataclass(frozen=True, eq=False)
class Linearised:
    """A fit and its derivatives: fits on some of the parts follow by linear algebra."""

    recordings: Recordings  # with the discrepancy of the model
    found: Fit  # on all parts
    parts: Sequence[Part]  # of the recordings

    @cached_property
    def here(self) -> Array:
        """Return the residuals at the fit, shape (R,)."""
        model = self.found.model
        return residual_function(self.recordings, model, robust=False)(model.coordinates)

    @cached_property
    def jacobian(self) -> Array:
        """Differentiate the residuals at the fit, shape (R, F)."""
        model = self.found.model
        function = residual_function(self.recordings, model, robust=False)
        return jacobian_at(model, function, self.here)

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
        told = np.diag(normal)
        normal = normal + np.eye(len(gradient)) / _LOOSE**2 + damping * np.diag(told)
        # Rounding may hide the prior where two coordinates do the same: then the least change.
        unit = 1.0 / np.sqrt(np.maximum(told, 1.0))
        change = -unit * np.linalg.lstsq(
            normal * np.outer(unit, unit), unit * gradient, rcond=None)[0]
        low, high = ((bound - model.coordinates) / model.steps for bound in model.ranges)
        return np.clip(change, np.minimum(low, 0.0), np.maximum(high, 0.0))

    @cached_property
    def left_out(self) -> Array:
        """
        Return mean squares as predicted by the fit on the others, shape (2, P, CHANNELS).

        Large errors count linearly, as in a fit; those of an exact law, which are outliers, as
        one of five standard deviations does.
        """
        normal, gradient = (sum(each[k] for each in self._sums) for k in (0, 1))
        squares = np.zeros((len(self.parts), 2, CHANNELS))
        for k, (part, (of_part, pull)) in enumerate(zip(self.parts, self._sums)):
            change = self._step(normal - of_part, gradient - pull)
            errors = self.here[part.there] + self.jacobian[part.there] @ change
            squares[k] = self._mean_squares(part, errors)
            ratio = np.maximum(squares[k], 1.0) / np.maximum(self.fitted[:, k], 1.0)
            if np.any(np.maximum(ratio, 1.0 / ratio) > _SUSPICIOUS):
                squares[k] = self._mean_squares(part, self._stepped(
                    part, normal - of_part, gradient - pull))
        return squares.transpose(1, 0, 2)

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
        """Return mean squares of the errors of the fit, shape (2, P, CHANNELS); see `left_out`."""
        return np.stack([self._mean_squares(part, self.here[part.there])
                         for part in self.parts], axis=1)

    @cached_property
    def counts(self) -> Array:
        """Return the number of residuals, shape (P, CHANNELS)."""
        return np.array([np.bincount(self.channel[part.there], minlength=CHANNELS)
                         for part in self.parts], float)

    @cached_property
    def white(self) -> bool:
        """Return whether at least half of what the first channel leaves is white."""
        # Of white noise the squared steps are twice the squares (J. von Neumann, Distribution of
        # the ratio of the mean square successive difference, Ann. Math. Statist. 12, 1941).
        here = self.here[(self.channel == 0) & (self.in_noise > 0.0)]
        steps = np.diff(here)
        return bool(steps @ steps >= here @ here)

    def _mean_squares(self, part: Part, errors: Array) -> Array:
        """Average squares by channel, in those of noise, shape (2, CHANNELS); see `left_out`."""
        found, channel = np.zeros((2, CHANNELS)), self.channel[part.there]
        in_noise = self.in_noise[part.there]
        bent, squares = huber(errors) ** 2 * in_noise, errors**2 * in_noise
        for k in range(CHANNELS):
            here = channel == k
            if here.any():
                usual = max(1.0, float(np.median(squares[here])) / _USUAL)
                found[:, k] = np.mean(bent[here]), np.mean(
                    np.minimum(squares[here], ROBUST**2 * usual))
        return found

    def values_on(self, part: Part) -> Model:
        """Return the model as fitted to one part alone, with a loose prior at all parts."""
        k = next(k for k, one in enumerate(self.parts) if one is part)
        change = self._step(*self._sums[k])
        return self.found.model.with_free(
            self.found.model.coordinates + change * self.found.model.steps)


class Spared(NamedTuple):
    """Samples that nothing is fitted to."""

    name: str  # such as 'episode 2'
    recording: PreparedRecording  # it counts them
    samples: Flags  # (N,)


def predict(one: Scored, spared: Sequence[Spared]) -> Scored:
    """Return a model with its errors on further parts, which its fit predicts as it is."""
    told: Linearised = one.found
    model, like = told.found.model, told.recordings[0]
    for _, recording, samples in spared:
        weighed = replace(recording, force_discrepancy=like.force_discrepancy,
                          motion_discrepancy=like.motion_discrepancy, discount=None)
        channels = weighed.channels(model)
        inside = weighed.blocks(samples.astype(float)) == 1.0
        there = np.concatenate([inside & channel.filled for channel in channels])
        further = Linearised([discounted(weighed, model)], told.found, [Part('', there)])
        left, exact = further.fitted
        one = replace(
            one, left_out=np.vstack((one.left_out, left)), fitted=np.vstack((one.fitted, left)),
            counts=np.vstack((one.counts, further.counts)),
            as_exact=None if one.as_exact is None else np.concatenate(
                (one.as_exact, np.stack((exact, exact))), axis=1))
    return one
