# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""A sample with known physics compensated, and the interface of compensations."""

from __future__ import annotations

from typing import NamedTuple, Protocol

from .contact_sample import ContactSample


class CompensatedSample(NamedTuple):
    """The terms of the relation that is left of a sample after known physics are compensated."""

    # penetration of the surface at its known position [m], NaN where that is not known
    depth: float
    pressing: float  # -F_e without what the sensor adds, and a weight [N]: decides contact
    rest: float  # the same less the known force of the environment [N]: what K_e and B_e explain
    travel: float  # displacement whose rate multiplies B_e [m]
    velocity: float  # that rate [m/s], NaN where not measured
    # stiffness_column, constant_column: phi_K [m], and its slope over the depth
    stiffness_column: float
    constant_column: float
    inertial_force: float  # force of M_e that `rest` is less of [N]
    hindrance: str  # why the relation does not hold; '' where it does


class SampleCompensation(Protocol):
    """Anything that compensates known physics sample by sample."""

    def take(self, sample: ContactSample, location: float, pressing: float) -> CompensatedSample:
        """
        Compensate one sample.

        location: x_e nominal [m]; NaN: not known yet
        pressing: -F_e less the bias [N]
        """
