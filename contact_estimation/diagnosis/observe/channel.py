# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""A measured and predicted signal: its noise, and the samples that count, block by block."""

from dataclasses import dataclass
from functools import cached_property
from typing import Sequence

import numpy as np
from scipy import sparse
from scipy.linalg import eigh
from scipy.ndimage import maximum_filter1d

from .driven_wall import DrivenWall
from .model import Model
from .observed import Observed
from .observer import innovations_of
from .smoothing import is_slow, least_noise, lost_by_lines, white_noise_std
from ...physics.numeric import Array, Flags, SecondOrder

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
    def averaging(self) -> sparse.csr_array:
        """Return `average` as a matrix, shape (blocks, N), for many errors that are short."""
        weights = self._weights
        entries = np.arange(weights.size + 1)
        return sparse.csr_array(
            (weights.ravel(), entries[:-1], entries[::self.block]),
            shape=(len(weights), len(self.use)))

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


ROBUST = 5.0
"""Standard deviations beyond which residuals count linearly (Huber 1964)."""

_REWEIGHTED = 3  # times


@dataclass(frozen=True, eq=False)
class Discount:
    """The whitening of residuals r with covariance I + C C^T, C the columns given to `of`."""

    directions: Array  # (R, C) orthonormal
    shares: Array  # (C,) the part of the residuals along each direction that is taken away, 0 to 1
    # residuals of the greatest of each nuisance, those of one channel, of which what fits best is
    # taken away; and the least of it, in the greatest
    nuisances: Sequence[tuple[slice, Array, float]]

    @classmethod
    def of(
        cls, columns: sparse.csc_array, nuisances: Sequence[tuple[slice, Array, float]]
    ) -> 'Discount':
        """Discount what uncertain parameters and nuisances could explain."""
        squares, turns = eigh(
            (columns.T @ columns).toarray(), subset_by_value=(LEAST_VARIANCE, np.inf))
        directions = columns @ (turns / np.sqrt(squares))
        return cls(directions, 1.0 - 1.0 / np.sqrt(1.0 + squares), nuisances)

    def apply(self, residuals: Array) -> Array:
        """Whiten residuals."""
        left = residuals.copy()
        for channel, greatest, least in self.nuisances:
            left[channel] -= _size(left[channel], greatest, least) * greatest
        return left - self.directions @ (self.shares * (self.directions.T @ left))


def _size(residuals: Array, greatest: Array, least: float) -> float:
    """Fit the size of a nuisance, in the greatest one; large residuals count linearly."""
    size = 0.0
    for _ in range(_REWEIGHTED):
        weighed = greatest / np.maximum(np.abs(residuals - size * greatest), ROBUST)
        size = min(max(float(weighed @ residuals / (weighed @ greatest)), least), 1.0)
    return size


_WINDOW_S = 0.1
_LEAST_WINDOWS = 5
_MEMORY = 2.0  # times 1 / omega_o: the observer has half forgotten an error


def force_noise(model: Model, observed: Observed) -> float:
    """
    Estimate the standard deviation of the force noise.

    From free flight, each tenth of a second less its own line: bias, drift and the slow force of a
    tool's mass do not count. Without free flight, from the top of the spectrum.
    """
    o = observed
    least = least_noise(o.force)
    span = max(6, round(_WINDOW_S * o.pace / o.h))
    law = model.laws().contact
    if law.unilateral:
        margin = 0.05 * float(np.ptp(o.x))
        free = (o.x < model.nominal.environment.location - margin) & o.measured
        squares = []
        line = np.vander(np.linspace(-1.0, 1.0, span), 2)
        project = line @ np.linalg.pinv(line)
        for first in range(0, len(o.t) - span + 1, span):
            if free[first:first + span].all():
                window = o.force[first:first + span]
                squares.append(float(np.sum((window - project @ window) ** 2)) / (span - 2))
        if len(squares) >= _LEAST_WINDOWS:
            # The median is that of a chi-square over its degrees of freedom (Wilson and
            # Hilferty 1931); few windows with a disturbance do not change it.
            freedom = float(span - 2)
            bias = (1.0 - 2.0 / (9.0 * freedom)) ** 3
            return max(float(np.sqrt(np.median(squares) / bias)), least)
    return max(white_noise_std(o.force[o.measured]), least)


def motion_noise(
    model: Model, observed: Observed, force_noise: float, widening: float = 1.0, block: int = 1,
) -> float:
    """Return the standard deviation of the motion error of a correct model."""
    if observed.driven_by_force(model.nominal):
        return DrivenWall(model, observed).kalman_filter(force_noise, widening, block)[1]
    return observed.position_noise


def force_error(model: Model, observed: Observed) -> Array | None:
    """Return the error of the wall's force that errors of the motion cause."""
    o = observed
    if o.motion_error is None:
        return None
    x_error, v_error = o.motion_error
    return np.hypot(model.stiffness * x_error, model.damping * v_error)


def innovation_error(
    model: Model, observed: Observed, observer: SecondOrder | None
) -> Array | None:
    """Return the error of a robot's innovations that errors of the motion cause."""
    o, robot = observed, model.laws().robot
    if observer is None or o.reference is None:
        return None
    push_error, of_command = force_error(model, o), o.command_error
    if push_error is None and of_command is None:
        return None
    if push_error is None:
        push_error = np.zeros(len(o.t))
    elif is_slow(o.h):
        command = robot.impedance_force(0.0, 0.0, o.reference)
        push_error = push_error + lost_by_lines(o.force) + lost_by_lines(command)
    if of_command is not None:
        push_error = push_error + of_command
    pulse = np.zeros(len(o.t))
    pulse[1] = 1.0
    answer = innovations_of(pulse, observer, observer, o.observer_cutoff, o.h)
    reach = 1 + 2 * round(_MEMORY / (o.observer_cutoff * o.h))
    return np.asarray(np.linalg.norm(answer) * maximum_filter1d(push_error, reach))
