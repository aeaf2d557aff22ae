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
The parts of recordings that are left out in turn: contacts, or blocks of time.

No part outweighs the others: a law holds in every part, not only where most is missing.
"""

from __future__ import annotations

from typing import NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray

from .discrepancy import CHANNELS, forces, has_discrepancy
from .fitting import Fit
from ..checks.measures import bend_of, STRAIGHT
from ..observe.episodes import episodes
from ..observe.model import Model
from ..observe.prepared_recording import PreparedRecording, Recordings

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

_LEAST_PARTS, _MOST_PARTS = 4, 8
_EVENT, _PIECES = 0.6, 5  # share of the misfit in one block; pieces of a part
_OUTWEIGHS = 2.0  # times the median misfit of the parts, beyond which a part counts no more
_USUAL = 0.25  # of the discrepancy, in squares per residual: more is lacking, not a trifle
_LEAST_RESIDUALS = 8  # of a part


class Part(NamedTuple):
    """
    A part of the recordings.

    Attributes
    ----------
    name : str
        Such as 'episode 2' or '3.0 to 4.5 s'.
    there : ndarray of bool, shape (R,)
        Its residuals among the stacked ones of all recordings.
    channel : ndarray of int
        Of these residuals: 0 is the force, or the only channel, 1 the motion.
    weights : ndarray
        Of the squares of these residuals: channels with a discrepancy are compared as forces.
    noise : ndarray, shape (CHANNELS,)
        Expected weighted sum of squares if all of them were noise.
    counts : float
        Factor by which `evened` lessened weights and noise.

    """

    name: str
    there: Flags
    channel: NDArray[np.int_]
    weights: Array
    noise: Array
    counts: float = 1.0

    def squares(self, residuals: Array) -> Array:
        """Sum the weighted squares of stacked residuals, shape (R,), on the part by channel."""
        return _sum_by_channel(self.channel, self.weights * residuals[self.there] ** 2)

    def scaled(self, factor: float) -> 'Part':
        """Return the part with all its squares, and their noise, multiplied by a factor."""
        return self._replace(weights=factor * self.weights, noise=factor * self.noise,
                             counts=factor * self.counts)


def _sum_by_channel(channel: NDArray[np.int_], values: Array) -> Array:
    return np.asarray(np.bincount(channel, values, CHANNELS), float)


def parts_of(recordings: Recordings, found: Fit) -> list[Part]:
    """
    Divide the fitted samples of recordings into parts.

    Parameters
    ----------
    recordings : sequence of PreparedRecording
        Fitted together.
    found : Fit
        The recalibrated model.

    Returns
    -------
    parts : list of Part
        Contacts with the free flight around them; blocks of equal duration where there are few
        contacts or a permanently attached wall, the first and last of a contact with the free
        flight beside them. Where one of those blocks has nearly all of the misfit, a single event,
        each part is a set of shorter blocks spread over the contact and the flight around it.
        So it is in one stroke at constant speed: depths beyond a fit's are no test of a law.

    """
    parts = _parts_of(recordings, found.model, 1)
    misfit = np.array([part.squares(found.residuals).sum() for part in parts])
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
        noise = np.concatenate([channel.noise_share for channel in channels])
        weights = np.repeat(_weights(one, model), one.block_count)
        channel = np.repeat(np.arange(len(channels)), one.block_count)
        prefix = f'{one.name}, ' if len(recordings) > 1 else ''
        for name, blocks in _divide(one, model, least, pieces):
            here = np.tile(blocks, len(channels)) & filled
            if np.count_nonzero(here) >= _LEAST_RESIDUALS:
                there = np.zeros(total, bool)
                there[begin:begin + len(here)] = here
                parts.append(Part(
                    prefix + name, there, channel[here], weights[here],
                    _sum_by_channel(channel[here], weights[here] * noise[here])))
        begin += len(filled)
    return parts


def _weights(one: PreparedRecording, model: Model) -> Array:
    """Weigh the channels' squares by their errors as forces, if these are not noise only."""
    if not has_discrepancy([one]):
        return np.ones(len(one.channels(model)))
    stds = np.array(forces(one, model))
    return np.asarray((stds / stds.max()) ** 2)


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


def evened(parts: Sequence[Part], whole: Array) -> tuple[list[Part], Array]:
    """
    Let no part outweigh the others: a law holds in every part, not only where most is missing.

    Parameters
    ----------
    parts : sequence of Part
        Of the recordings.
    whole : ndarray, shape (parts, CHANNELS)
        `left_out_errors` of the model whose misfit counts as 1.

    Returns
    -------
    parts : list of Part
        Those with more than twice the median misfit count as if they had twice the median.
    whole : ndarray, shape (parts, CHANNELS)
        The same errors on these parts.

    """
    # Where the rest determines no prediction of a part, its error may be of any size; what others
    # lack, of about the size of the discrepancy, must not be a trifle beside it.
    lacking = (whole - noise_of(whole, parts)).sum(axis=1)
    usual = np.array([_USUAL * np.count_nonzero(part.there) for part in parts])
    misfit = np.where(lacking > usual, lacking, above_noise(whole, parts))
    factors = np.minimum(1.0, _OUTWEIGHS * np.median(misfit) / misfit)
    return ([part.scaled(float(factor)) for part, factor in zip(parts, factors)],
            factors[:, np.newaxis] * whole)


def counts_of(parts: Sequence[Part], residual_count: int) -> Array:
    """
    Return by how much residuals count where no part outweighs the others.

    Parameters
    ----------
    parts : sequence of Part
        From `evened`.
    residual_count : int
        Number R of stacked residuals.

    Returns
    -------
    counts : ndarray, shape (R,)
        Factor of each square.

    """
    counts = np.ones(residual_count)
    for part in parts:
        counts[part.there] = part.counts
    return counts


def noise_of(squares: Array, parts: Sequence[Part]) -> Array:
    """
    Return the squared errors that noise alone would leave.

    Parameters
    ----------
    squares : ndarray, shape (parts, CHANNELS)
        `left_out_errors`.
    parts : sequence of Part
        With their noise.

    Returns
    -------
    noise : ndarray, shape (parts, CHANNELS)
        In no channel more, on all parts together, than there is: where the noise is estimated too
        large, the misfit of the other channel must not make up for it.

    """
    noise = np.array([part.noise for part in parts])
    every = np.maximum(noise.sum(axis=0), 1e-300)
    return np.asarray(noise * np.minimum(1.0, squares.sum(axis=0) / every))


def above_noise(
    squares: Array, parts: Sequence[Part], columns: slice = slice(None)
) -> Array:
    """
    Subtract the noise from squared errors.

    Parameters
    ----------
    squares, parts
        As of `noise_of`.
    columns : slice
        Channels that count.

    Returns
    -------
    misfit : ndarray, shape (parts,)
        At least a hundredth of the mean over the parts, so that shares stay finite.

    """
    misfit = (squares - noise_of(squares, parts))[:, columns].sum(axis=1)
    squares = squares[:, columns].sum(axis=1)
    least = max(0.01 * float(np.mean(misfit)), 1e-3 * float(np.mean(squares)), 1e-300)
    return np.asarray(np.maximum(misfit, least))
