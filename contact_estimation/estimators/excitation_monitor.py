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

"""Excitation: how precisely the last window of data determines each parameter."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from math import ceil, inf, sqrt
from typing import NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray

from .estimator import Frozen
from ..parameters.specification import parameter, ParameterGroup
from ..signals.relations import COLUMNS, NoiseGain, Row

_BLOCKS = 10  # of the window; judged a block at a time, since excitation changes slowly
_EARLY = 10  # rows between judgements

RECENT = 20
"""Number of rows that show a change."""


@dataclass(frozen=True)
class ExcitationParameters(ParameterGroup):
    """When a parameter is frozen for lack of excitation."""

    window_s: float = parameter(
        1.0, 'Length of the window over which excitation is evaluated', 's',
        minimum=0.01, maximum=100.0,
    )
    maximum_relative_std: float = parameter(
        0.2,
        'A parameter is frozen while its predicted relative standard deviation is above this; '
        'large: never frozen',
        minimum=1e-4,
    )


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
        return self._replace(products=move @ self.products @ move.T)


_EMPTY = Window(0.0, 0.0, np.zeros((COLUMNS, COLUMNS)))


class ExcitationMonitor:
    """
    Predict the standard deviations that the window permits: eq. (27) made quantitative.

    sigma_F^2 (sum phi phi^T)^-1 is the Cramer-Rao bound of K_e and B_e over the window. Where it
    exceeds a share of the estimate, noise would dominate an update, and the parameter is frozen.
    Where the location is estimated too, it is marginalised out.

    Parameters
    ----------
    parameters : ExcitationParameters
        Window and limit.
    sample_period_s : float
        Nominal T [s].

    """

    def __init__(self, parameters: ExcitationParameters, sample_period_s: float) -> None:
        self._T = sample_period_s
        self._block = 0
        self.configure(parameters)

    def configure(self, parameters: ExcitationParameters) -> None:
        """
        Set a new window and limit; the rows collected stay unless the window changes.

        Parameters
        ----------
        parameters : ExcitationParameters
            Window and limit.

        """
        block = max(1, round(parameters.window_s / self._T / _BLOCKS))
        if block != self._block:
            self._block = block
            self.reset()
        self._limit = parameters.maximum_relative_std

    def reset(self) -> None:
        """Discard all rows."""
        self._past: deque[Window] = deque(maxlen=_BLOCKS - 1)
        self._before = _EMPTY  # sum of the past
        chunk = min(_EARLY, self._block)
        self._last: deque[Window] = deque(maxlen=max(1, ceil(RECENT / chunk) - 1))
        self._start_block()
        self._start_chunk()
        self.completed = 0  # blocks
        self.frozen = Frozen(True, True)
        self.stiffness_std = inf
        self.damping_std = inf

    def _start_block(self) -> None:
        self._chunks: list[Window] = []
        self._count = 0
        self._next = min(_EARLY, self._block)

    def _start_chunk(self) -> None:
        self._rows: list[Row] = []
        self._sums: Window | None = None
        self._window: Window | None = None
        self._effective = self._rate_noise = 0.0

    @property
    def until_judgement(self) -> int:
        """Return the number of rows that may be added before the next judgement is due."""
        return self._next - self._count

    def add(self, rows: Sequence[Row], gains: Sequence[NoiseGain] = ()) -> None:
        """
        Add rows of contact, at most `until_judgement`.

        Parameters
        ----------
        rows : sequence of sequence of float
            (y, phi_K, phi_B, phi_c, phi_M) each.
        gains : sequence of NoiseGain
            How noise enters each row.

        """
        self._rows += rows
        self._count += len(rows)
        self._sums = self._window = None
        for force, rate in gains:
            self._effective += force
            self._rate_noise += rate

    @property
    def blocks(self) -> Sequence[Window]:
        """Return the blocks of the window, the last one possibly not complete."""
        block = [*self._chunks, self._chunk()] if self._rows else self._chunks
        return [*self._past, _sum(block)] if block else list(self._past)

    def window(self) -> Window:
        """
        Return the sums over the window.

        Returns
        -------
        window : Window
            Up to the last row.

        """
        if self._window is None:
            self._window = _sum([self._before, *self._chunks, self._chunk()])
        return self._window

    def recent(self) -> Window:
        """
        Return the sums over the last rows, which show a change of the wall first.

        Returns
        -------
        recent : Window
            Over about 20 rows.

        """
        return _sum([*self._last, self._chunk()])

    def keep_recent(self) -> None:
        """Discard all but the rows of `recent`, as after a change of the wall."""
        self._past.clear()
        self._before, self._window = _EMPTY, None
        self._chunks = list(self._last)
        self._count = self._next = len(self._rows)
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
        self._before = self._before.shifted(shift)
        self._sums, self._window = self._chunk().shifted(shift), None

    def _chunk(self) -> Window:
        if self._sums is None:
            rows = np.array(self._rows, float).reshape(-1, COLUMNS)
            self._sums = Window(self._effective, self._rate_noise, rows.T @ rows)
        return self._sums

    def judge(
        self,
        noise_variance: float,
        stiffness: float,
        damping: float,
        location_std: float | None,
    ) -> None:
        """
        Judge the excitation of the window; sets `frozen` and the predicted standard deviations.

        Parameters
        ----------
        noise_variance : float
            Of the unfiltered equation [N^2]; the filter passes the band in which phi lives
            unchanged, so the bound is that of the raw samples.
        stiffness, damping : float
            The scales to compare with, > 0: the estimates with lower bounds.
        location_std : float or None
            Prior standard deviation of x_e [m] where x_e is estimated too, else None.

        """
        self._judge(self.window().products, noise_variance, stiffness, damping, location_std)
        chunk = self._chunk()
        self._chunks.append(chunk)
        self._last.append(chunk)
        self._start_chunk()
        if self._count >= self._block:
            self._past.append(_sum(self._chunks))
            self._before = _sum(self._past)
            self.completed += 1
            self._start_block()
        else:
            self._next = min(self._count + _EARLY, self._block)

    def _judge(
        self,
        products: NDArray[np.float64],
        noise_variance: float,
        stiffness: float,
        damping: float,
        location_std: float | None,
    ) -> None:
        (_, Ky, By, cy, _), (_, KK, KB, Kc, _), (_, _, BB, Bc, _), (*_, cc, _), _ = (
            products.tolist()
        )
        limit_K = self._limit * max(stiffness, Ky / KK if KK > 0.0 else 0.0)
        if location_std is not None:
            # Marginalise the location out (Schur complement), with its prior as information.
            cc += noise_variance / max((stiffness * location_std) ** 2, 1e-30)
            KK -= Kc * Kc / cc
            KB -= Kc * Bc / cc
            BB -= Bc * Bc / cc
            Ky -= Kc * cy / cc
            By -= Bc * cy / cc
        # The fit over the window counts as well, as does its secant stiffness: with an initial
        # value far too soft, a stiff and damped wall would otherwise appear unexcited.
        determinant = KK * BB - KB * KB
        fitted_B = (KK * By - KB * Ky) / determinant if determinant > 1e-12 * KK * BB else 0.0
        limit_B = self._limit * max(damping, fitted_B)
        both_K, both_B = _std(noise_variance, KK, KB, BB), _std(noise_variance, BB, KB, KK)
        alone_K, alone_B = _std(noise_variance, KK, 0.0, 1.0), _std(noise_variance, BB, 0.0, 1.0)
        self.stiffness_std, self.damping_std = both_K, both_B
        if both_K <= limit_K and both_B <= limit_B:
            self.frozen = Frozen(False, False)
        elif alone_K <= limit_K:
            self.frozen = Frozen(False, True)
            self.stiffness_std = alone_K
        elif alone_B <= limit_B:
            self.frozen = Frozen(True, False)
            self.damping_std = alone_B
        else:
            self.frozen = Frozen(True, True)


def _sum(windows: Sequence[Window]) -> Window:
    effective, rate_noise, products = zip(*windows)
    return Window(sum(effective), sum(rate_noise), sum(products))


def _std(noise_variance: float, own: float, cross: float, other: float) -> float:
    """Return the square root of a diagonal entry of sigma^2 [[own, cross], [cross, other]]^-1."""
    information = own - (cross * cross / other if other > 0.0 else 0.0)
    if information <= 1e-12 * own or own <= 0.0:
        return inf
    return sqrt(noise_variance / information)
