# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""What an error of the force that lasts, unlike noise, does to K_hat and B_hat."""

from __future__ import annotations

from math import hypot, sqrt

from ..estimators.estimate import ParameterEstimate

_LEAST = 1e-6  # spread of a contact that has just begun [m], [m/s]


class LastingError:
    """
    Widen the deviations of K_hat and B_hat by those of an error of F_e that is no white noise.

    An error e of the force changes the least-squares slope over x by cov(e, x) / var(x), which is
    at most std(e) / std(x); so does its slope over v. This bound is the deviation that is added:
    whether the error goes with x is not known. Spreads are those within contacts.
    """

    def __init__(self) -> None:
        self.restart()

    def restart(self) -> None:
        """Forget all contacts: the wall is another."""
        self._count, self._squares = 0, [0.0, 0.0, 0.0]  # of the force error, x and v
        self.begin()

    def begin(self) -> None:
        """Begin a contact."""
        self._own, self._means = 0, (0.0, 0.0)

    def add(self, std: float, x: float, v: float) -> None:
        """Add a sample in contact: deviation of the error [N], x [m] and v [m/s]."""
        self._own += 1
        self._count += 1
        off = x - self._means[0], v - self._means[1]
        mean = self._means = (self._means[0] + off[0] / self._own,
                              self._means[1] + off[1] / self._own)
        squares = std * std, off[0] * (x - mean[0]), off[1] * (v - mean[1])
        for place, square in enumerate(squares):
            self._squares[place] += square

    def widened(self, estimate: ParameterEstimate) -> ParameterEstimate:
        """Return an estimate with wider deviations; unchanged where there was no error."""
        if not self._squares[0]:
            return estimate
        error, *spreads = (sqrt(square / self._count) for square in self._squares)
        by_x, by_v = (error / max(spread, _LEAST) for spread in spreads)
        return estimate._replace(stiffness_std=hypot(estimate.stiffness_std, by_x),
                                 damping_std=hypot(estimate.damping_std, by_v))
