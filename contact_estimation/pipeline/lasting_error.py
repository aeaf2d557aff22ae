# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""What an error of the force that lasts, unlike noise, does to K_hat and B_hat."""

from math import hypot, nan
from typing import Sequence

import numpy as np
from numpy.typing import NDArray

from ..estimators.estimate import ParameterEstimate
from ..estimators.multiple_model.contact import ContactFilter
from ..signals.conditioning import ZeroTracker

_FIRST = 5  # samples of contact


class LastingError:
    """
    Widen the deviations of K_hat and B_hat by those of errors of F_e that are no white noise.

    An error e of the force changes the least-squares coefficients of x and v, with an intercept
    for each contact, by cov((x, v))^-1 cov((x, v), e), and without one, where the surface is
    known, by the same of moments about the surface: the larger counts. Errors of several causes,
    each given with the course that one standard deviation of its size has, add in squares.

    contact: of which the noise and the level of the force are
    """

    def __init__(self, contact: ContactFilter) -> None:
        self._contact = contact
        self.restart()
        self._means: NDArray[np.float64] | None = None
        self._sums: NDArray[np.float64] | None = None  # about the means, and about the surface
        self._own = self._count = 0

    def restart(self) -> None:
        """Take no rate from the position before the next sample."""
        self._last_d = nan

    def follow_zero(self, tracker: ZeroTracker, pressing: float) -> None:
        """Let the tracker alone follow the zero; the filter of the contact finds what it is."""
        contact, noise = self._contact, self._contact.noise_std
        if contact.level:
            tracker.step(contact.level, contact.level_variance / noise**2)
        elif contact.is_quiet:
            tracker.correct(pressing, noise)
        contact.set_level(0.0, (tracker.zero_std * noise)**2)

    def note(
        self, touching: bool, dt: float, d: float, v: float, errors: tuple[float, ...],
        tracker: ZeroTracker | None,
    ) -> None:
        """
        Add up what errors may have done to the estimate.

        touching: whether the sample is in contact
        dt, d, v: time since the last sample [s], depth [m], NaN before the surface is known,
        measured rate, NaN without [m/s]
        errors, tracker: of the force [N], and that of its zero
        """
        rate = v if v == v else (d - self._last_d) / dt if dt > 0.0 else 0.0
        self._last_d = d
        if errors:
            self._contact.expect_noise(hypot(*errors))
        if not touching or d != d or rate != rate:
            self._own = 0
            return
        of_zero = (tracker.zero_std * self._contact.noise_std,) if tracker is not None else ()
        self._add(d, rate, (*errors, *of_zero))

    def _add(self, d: float, v: float, errors: Sequence[float]) -> None:
        row = np.array([d, v, *errors])
        if self._sums is None or self._sums.shape[1] != len(row):
            self._sums, self._own, self._count = np.zeros((2, len(row), len(row))), 0, 0
        if not self._own or self._means is None:
            self._means = np.zeros(len(row))
        self._own += 1
        self._count += 1
        off = row - self._means
        self._means = self._means + off / self._own
        self._sums += np.outer(off, row - self._means), np.outer(row, row)

    def widened(self, estimate: ParameterEstimate) -> ParameterEstimate:
        """Return an estimate with wider deviations; unchanged where there was no error."""
        if self._sums is None or self._count < _FIRST:
            return estimate
        least = np.diag([1e-15, 1e-12])
        by_K, by_B = np.max([np.linalg.norm(np.linalg.solve(
            sums[:2, :2] + least, sums[:2, 2:]), axis=1) for sums in self._sums], axis=0)
        return estimate._replace(stiffness_std=hypot(estimate.stiffness_std, by_K),
                                 damping_std=hypot(estimate.damping_std, by_B))
