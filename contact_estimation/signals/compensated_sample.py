# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""A sample with known physics compensated, and the interface of compensations."""

from __future__ import annotations

from typing import NamedTuple, Protocol

from .contact_sample import ContactSample


class CompensatedSample(NamedTuple):
    """
    The terms of the relation that is left of a sample after known physics are compensated.

    Attributes
    ----------
    depth : float
        Penetration of the surface at its known position [m], NaN where that is not known.
    pressing : float
        -F_e without what the sensor adds, and a weight [N]: decides contact.
    rest : float
        The same less the known force of the environment [N]: what K_e and B_e explain.
    travel : float
        Displacement whose rate multiplies B_e [m].
    velocity : float
        That rate [m/s], NaN where not measured.
    stiffness_column, constant_column : float
        phi_K [m], and its slope over the depth.
    inertial_force : float
        Force of M_e that `rest` is less of [N].
    hindrance : str
        Why the relation does not hold; '' where it does.

    """

    depth: float
    pressing: float
    rest: float
    travel: float
    velocity: float
    stiffness_column: float
    constant_column: float
    inertial_force: float
    hindrance: str


class SampleCompensation(Protocol):
    """Anything that compensates known physics sample by sample."""

    def take(self, sample: ContactSample, location: float, pressing: float) -> CompensatedSample:
        """
        Compensate one sample.

        Parameters
        ----------
        sample : ContactSample
            Stamped after the last one.
        location : float
            x_e nominal [m]; NaN: not known yet.
        pressing : float
            -F_e less the bias [N].

        """
