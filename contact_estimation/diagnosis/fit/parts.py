# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The parts of recordings that are left out in turn: contacts, or blocks of time."""

from __future__ import annotations

from typing import NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray

from .fitting import Fit
from ..checks.measures import bend_of, STRAIGHT
from ..observe.episodes import episodes
from ..observe.model import Model
from ..observe.prepared_recording import PreparedRecording, Recordings

Flags = NDArray[np.bool_]

_LEAST_PARTS, _MOST_PARTS = 4, 8
_EVENT, _PIECES = 0.6, 5  # share of the misfit in one block; pieces of a part
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

    """

    name: str
    there: Flags


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
