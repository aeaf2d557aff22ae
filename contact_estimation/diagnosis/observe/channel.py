# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""A measured and predicted signal: its noise, and the samples that count, block by block."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

LEAST_VARIANCE = 0.02
"""Least variance along a direction, in that of the noise: of less a hundredth were taken away."""


@dataclass(frozen=True, eq=False)
class Channel:
    """How the errors of one signal, force or motion, become residuals."""

    noise: float  # standard deviation of the error of a correct model, a sample [N] or [m]
    # (N,) factor by which jitter of the stamps widens the noise of each sample, not the
    # discrepancy
    spread: Array
    use: Flags  # (N,) samples that count
    block: int  # samples averaged to one residual
    # standard deviation of what no law of the library explains, in the unit of the noise. It is
    # correlated over a block and longer, so that averaging does not reduce it
    discrepancy: float = 0.0

    @cached_property
    def counts(self) -> Array:
        """Return the samples that count in each block, shape (blocks,)."""
        return sum_blocks(self.use.astype(float), self.block)

    @cached_property
    def filled(self) -> Flags:
        """Blocks with samples that count, shape (blocks,); the residual is 0 elsewhere."""
        return self.counts > 0.0

    @cached_property
    def _sum_std(self) -> Array:
        """Return the standard deviation of a block's sum, shape (blocks,)."""
        counts = np.maximum(self.counts, 1.0)
        return np.hypot(self.noise * np.sqrt(counts), self.discrepancy * counts)

    @cached_property
    def noise_of_means(self) -> Array:
        """Return the standard deviation by noise of each block's mean, shape (blocks,)."""
        counts = np.maximum(self.counts, 1.0)
        inverse = sum_blocks(self.use / self.spread, self.block) + ~self.filled
        return np.asarray(self.noise * np.sqrt(counts) / inverse)

    @cached_property
    def _weights(self) -> Array:
        """Return the weight of each sample in its block's residual, shape (blocks, block)."""
        unknown = self.discrepancy * np.sqrt(self.block)
        widened = np.hypot(self.noise * self.spread, unknown)
        weights = np.hypot(self.noise, unknown) / widened * self.use
        return np.asarray(_in_blocks(weights, self.block) / self._sum_std[:, np.newaxis])

    @property
    def error(self) -> float:
        """Return the standard deviation of a sample: noise and discrepancy."""
        return float(np.hypot(self.noise, self.discrepancy))

    @property
    def noise_share(self) -> Array:
        """Part of the variance of each block's mean that is noise, shape (blocks,)."""
        noise = self.noise_of_means**2
        return np.asarray(noise / (noise + self.discrepancy**2) * self.filled)

    def average(self, error: Array) -> Array:
        """Average an error over blocks."""
        # Weighing and summing at once: every evaluation of a model asks for two averages.
        return np.asarray(np.einsum('ij,ij->i', _in_blocks(error, self.block), self._weights))


def sum_blocks(signal: Array, block: int) -> Array:
    """Sum a signal over blocks; an incomplete last block is left out."""
    return np.asarray(np.einsum('ij->i', _in_blocks(signal, block)))


def _in_blocks(signal: Array, block: int) -> Array:
    """Return a signal block by block, shape (N // block, block)."""
    count = len(signal) // block
    return signal[:count * block].reshape(count, block)


@dataclass(frozen=True, eq=False)
class Discount:
    """The whitening of residuals r with covariance I + C C^T, C the columns given to `of`."""

    directions: Array  # (R, C) orthonormal
    shares: Array  # (C,) the part of the residuals along each direction that is taken away, 0 to 1

    @classmethod
    def of(cls, columns: Array) -> 'Discount':
        """Discount what uncertain parameters could explain."""
        squares, turns = np.linalg.eigh(columns.T @ columns)
        large = squares > LEAST_VARIANCE
        directions = columns @ (turns[:, large] / np.sqrt(squares[large]))
        return cls(directions, 1.0 - 1.0 / np.sqrt(1.0 + squares[large]))

    def apply(self, residuals: Array) -> Array:
        """Whiten residuals."""
        return residuals - self.directions @ (self.shares * (self.directions.T @ residuals))
