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

"""Running sums over the rows of a window: all that judgements of an estimate need to know."""

from __future__ import annotations

from collections import deque
from itertools import chain
from math import ceil
from typing import NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray

from ..signals.relations import COLUMNS, NoiseGain, Row

_BLOCKS = 10  # of the window
_CHUNK = 10  # rows
_FADING = 0.97  # per block, of the rows before the window: those of about three windows count

RECENT = 20
"""Number of rows that show a change."""

LARGEST = 1e24
"""Sum of squares; larger ones come from impossible parameters, and overflow when squared."""


class Window(NamedTuple):
    """
    Sums over the rows of the window.

    Attributes
    ----------
    effective_samples : float
        Sum of the shares of white force noise left in the rows.
    rate_noise : float
        Sum of the variances of phi_B for a position variance of 1 [1/s^2].
    products : ndarray, shape (5, 5)
        Sum of row^T row.

    """

    effective_samples: float
    rate_noise: float
    products: NDArray[np.float64]

    def shifted(self, shift: float) -> 'Window':
        """
        Return the sums with the surface moved: phi_K less shift phi_c.

        Parameters
        ----------
        shift : float
            How far into the wall the surface is [m].

        """
        move = np.eye(COLUMNS)
        move[1, 3] = -shift
        return Window(
            self.effective_samples, self.rate_noise, move @ self.products @ move.T)


_EMPTY = Window(0.0, 0.0, np.zeros((COLUMNS, COLUMNS)))


class RowSums:
    """
    Sums over chunks of ten rows, blocks of chunks, and the window of ten blocks.

    Parameters
    ----------
    rows : int
        Number of rows of a whole window.

    Attributes
    ----------
    completed : int
        Number of blocks completed since the start.

    """

    def __init__(self, rows: int) -> None:
        self._block = max(1, round(rows / _BLOCKS))
        self._chunk = min(_CHUNK, self._block)
        self._past: deque[Window] = deque(maxlen=_BLOCKS - 1)
        self._chunks: list[Window] = []  # of the present block
        self._last: deque[Window] = deque(maxlen=ceil(RECENT / self._chunk))
        self._before: Window | None = None  # rows before the window, faded
        self._window: Window | None = None
        self._count = 0  # rows of the present block
        self.completed = 0

    @property
    def wanted(self) -> int:
        """Return the number of rows that complete the present chunk."""
        return min(self._chunk - self._count % self._chunk, self._block - self._count)

    @property
    def left(self) -> int:
        """Return the number of rows that complete the present block."""
        return self._block - self._count

    @property
    def full(self) -> bool:
        """Whether as many rows have come as the window holds."""
        return self.completed >= _BLOCKS

    def add(self, rows: Sequence[Row], gains: Sequence[NoiseGain]) -> None:
        """
        Add rows of contact, at most `left`.

        Parameters
        ----------
        rows : sequence of sequence of float
            (y, phi_K, phi_B, phi_c, phi_M) each.
        gains : sequence of NoiseGain
            How noise enters each row.

        """
        table = np.fromiter(chain.from_iterable(rows), float, COLUMNS * len(rows))
        table = table.reshape(-1, COLUMNS)
        begin, end = 0, self.wanted
        while begin < len(rows):
            part = table[begin:end]
            chunk = Window(*_total(gains[begin:end]), part.T @ part)
            self._chunks.append(chunk)
            self._last.append(chunk)
            begin, end = end, end + self._chunk
        self._count += len(rows)
        self._window = None

    def close_block(self) -> None:
        """Start the next block where the present one is complete."""
        if self._count >= self._block:
            if len(self._past) == self._past.maxlen:
                self._fade(self._past[0])
            self._past.append(sum_of(self._chunks))
            self._chunks, self._count = [], 0
            self.completed += 1

    def _fade(self, leaving: Window) -> None:
        """Note a block that leaves the window, and fade those before it."""
        if self._before is None:
            self._before = leaving
            return
        effective, rate, products = self._before
        self._before = sum_of([
            Window(_FADING * effective, _FADING * rate, _FADING * products), leaving])

    @property
    def blocks(self) -> Sequence[Window]:
        """Return the blocks of the window, the last one possibly not complete."""
        return [*self._past, sum_of(self._chunks)] if self._chunks else list(self._past)

    def window(self) -> Window:
        """
        Return the sums over the window.

        Returns
        -------
        window : Window
            Up to the last row.

        """
        if self._window is None:
            self._window = sum_of([*self._past, *self._chunks])
        return self._window

    def contact(self) -> Window:
        """
        Return the sums over the contact, which show the surface best: its touch-down among them.

        Returns
        -------
        contact : Window
            The window and, the less the older they are, the rows before it.

        """
        if self._before is None:
            return self.window()
        return sum_of([self._before, self.window()])

    def recent(self) -> Window:
        """
        Return the sums over the last rows, which show a change of the wall first.

        Returns
        -------
        recent : Window
            Over about 20 rows.

        """
        return sum_of([*self._last])

    def keep_recent(self) -> None:
        """Discard all but the rows of `recent`, as after a change of the wall."""
        self._past.clear()
        self._before = None
        self._chunks, self._window = list(self._last), None
        self._count = min(self._chunk, self._count)
        self.completed = 0

    def shift(self, shift: float) -> None:
        """
        Move the surface for the rows collected so far.

        Parameters
        ----------
        shift : float
            How far into the wall [m].

        """
        for windows in (self._past, self._last, self._chunks):
            for k, window in enumerate(windows):
                windows[k] = window.shifted(shift)
        self._before = self._before and self._before.shifted(shift)
        self._window = None


def _total(gains: Sequence[NoiseGain]) -> NoiseGain:
    """Return the sum of the gains of rows, which usually are equal."""
    if gains and gains.count(gains[0]) == len(gains):
        return NoiseGain(len(gains) * gains[0].force, len(gains) * gains[0].rate)
    return NoiseGain(sum(gain.force for gain in gains), sum(gain.rate for gain in gains))


def sum_of(windows: Sequence[Window]) -> Window:
    """
    Add up sums.

    Parameters
    ----------
    windows : sequence of Window
        Over rows of their own each.

    """
    if not windows:
        return _EMPTY
    effective, rate_noise, products = windows[0]
    for more, rate, others in windows[1:]:
        effective += more
        rate_noise += rate
        products = products + others
    return Window(effective, rate_noise, products)
