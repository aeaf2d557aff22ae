# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
Relations y = phi^T theta that hold at every instant of contact, and their filtered rows.

A relation turns raw samples into one row (y, phi_K, phi_B, phi_c, phi_M), or None where it does
not hold at this instant. The row is gated and filtered afterwards, all columns alike, so that
neither the touch-down nor the filter biases the estimate. y is the pressing force -F_e.
"""

from abc import ABC, abstractmethod
from math import ceil, pi, sqrt
from typing import Sequence

from .contact_sample import CompensatedSample
from .filters import ButterworthBank

Row = Sequence[float]
COLUMNS = 5
"""Of a row: y, phi_K, phi_B, phi_c, phi_M."""


_ZEROS = (0.0,) * COLUMNS


class Relation(ABC):
    """
    Base of all relations.

    sample_period_s: nominal T [s]; relations over several samples hold only across regular spacing
    """

    def __init__(self, sample_period_s: float) -> None:
        self._longest = 1.5 * sample_period_s
        self.leave()

    @abstractmethod
    def leave(self) -> None:
        """End the contact: forget the samples before."""

    @abstractmethod
    def row(self, dt: float, delta: float, velocity: float, pressing: float) -> Row | None:
        """
        Build the row of an instant in contact.

        dt: time since the last sample [s]
        delta: x - x_e nominal [m]
        velocity: its rate [m/s], NaN where not measured
        pressing: -F_e, less the force of known physics [N]
        """


class VelocityRelation(Relation):
    """Eq. (7): F = K_e delta + B_e v; from differences where no velocity is measured."""

    def leave(self) -> None:
        self._last: tuple[float, float] | None = None

    def row(self, dt: float, delta: float, velocity: float, pressing: float) -> Row | None:
        last, self._last = self._last, (delta, pressing)
        if velocity == velocity:
            return pressing, delta, velocity, 1.0, 0.0
        # Without velocity: the trapezoid of eq. (3) over one interval. Averaging force and
        # position over the interval over which the difference is taken keeps them in phase.
        if last is None or not 0.0 < dt <= self._longest:
            return None
        return (
            0.5 * (pressing + last[1]),
            0.5 * (delta + last[0]),
            (delta - last[0]) / dt,
            1.0,
            0.0,
        )


class TustinRelation(Relation):
    """
    Eq. (31): the bilinear form of M_e a + B_e v + K_e delta over three samples.

    Divided by 4, and written for (K_e, B_e, M_e) instead of (A, B, C): the same relation, in
    coordinates in which the covariance can be read. Uses positions only.
    """

    def __init__(self, sample_period_s: float) -> None:
        super().__init__(sample_period_s)
        self._per_T = 0.5 / sample_period_s
        self._per_T2 = 1.0 / sample_period_s**2

    def leave(self) -> None:
        self._consecutive = 0
        self._d1 = self._d2 = self._f1 = self._f2 = 0.0

    def row(self, dt: float, delta: float, velocity: float, pressing: float) -> Row | None:
        d1, d2, f1, f2 = self._d1, self._d2, self._f1, self._f2
        self._d1, self._d2, self._f1, self._f2 = delta, d1, pressing, f1
        self._consecutive = self._consecutive + 1 if dt <= self._longest else 1
        if self._consecutive < 3:
            return None
        return (
            0.25 * (pressing + 2.0 * f1 + f2),
            0.25 * (delta + 2.0 * d1 + d2),
            self._per_T * (delta - d2),
            1.0,
            self._per_T2 * (delta - 2.0 * d1 + d2),
        )


class GatedRows:
    """
    Rows of a relation in contact and zeros out of contact, all passed through one filter.

    cutoff_frequency: of the filter [Hz]; 0: none
    sample_rate: nominal [Hz]
    """

    def __init__(
        self, relation: type[Relation], cutoff_frequency: float, sample_rate: float
    ) -> None:
        self._relation_class, self._T = relation, 1.0 / sample_rate
        self._bank = ButterworthBank(COLUMNS, cutoff_frequency, sample_rate)
        # The slower pole decays with cutoff / sqrt(2): after this number of samples 1e-9 is left.
        per_radian = sample_rate / (2.0 * pi * cutoff_frequency) if cutoff_frequency else 0.0
        self._tail = ceil(21.0 * sqrt(2.0) * per_radian)
        self.restart()

    def restart(self) -> None:
        """Start afresh with the next sample."""
        self._bank.reset()
        self._tail_left = 0
        self._left = True  # the relations know no sample
        # The second and third build the columns of K_e and x_e where known physics bend them.
        self._relation, *self._columns = (self._relation_class(self._T) for _ in range(3))

    def in_contact(self, dt: float, delta: float, velocity: float, pressing: float) -> Row | None:
        """Return the filtered row of a sample in contact."""
        return self._filtered(self._relation.row(dt, delta, velocity, pressing))

    def compensated(self, dt: float, now: CompensatedSample) -> Row | None:
        """Return a row as `in_contact`, columns of K_e and x_e weighted over time as the force."""
        relation, (stiffness, constant) = self._relation, self._columns
        travel, v = now.travel, now.velocity
        row = relation.row(dt, travel, v, now.rest)
        K = stiffness.row(dt, travel, v, now.stiffness_column)
        c = constant.row(dt, travel, v, now.constant_column)
        if row and K and c:
            row = row[0], K[0], row[2], c[0], row[4]
        else:
            row = None
        return self._filtered(row)

    def _filtered(self, row: Row | None) -> Row | None:
        self._tail_left = self._tail
        self._left = False
        if row is None:  # the relation waits for consecutive samples
            self._bank.take(_ZEROS)
            return None
        return self._bank.take(row)

    def leave(self) -> None:
        """Filter the zeros of a sample out of contact, until the response has decayed."""
        if not self._left:
            self._left = True
            for relation in (self._relation, *self._columns):
                relation.leave()
        if self._tail_left:
            self._bank.take(_ZEROS)
            self._tail_left -= 1
            if not self._tail_left:
                self._bank.reset()
