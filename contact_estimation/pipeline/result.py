# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The outputs for one sample."""

from __future__ import annotations

from typing import NamedTuple

from ..estimators.estimate import Estimate
from ..kinematics.contact_kinematics import ArmState
from ..reference.setpoints import Reference
from ..signals.contact_sample import ContactSample

AxesEstimates = tuple[Estimate, ...]
"""Estimates of one sample, one for each axis, the contact axis first."""


class Moment(NamedTuple):
    """The stamp of a sample, unique even where the clock has jumped back."""

    jumps: int  # number of backward clock jumps before the sample
    stamp_ns: int  # stamp of the sample [ns]


class Result(NamedTuple):
    """The estimates and the reference that belong to one sample."""

    sample: ContactSample  # of the contact axis
    estimates: AxesEstimates  # one for each estimated axis, the contact axis first
    reference_stamp_ns: int  # instant from which the robot follows the reference [ns]
    reference: Reference | None  # None where the session does not generate it (replay)
    arm: ArmState | None = None  # pose and compensated wrench of an arm

    @property
    def estimate(self) -> Estimate:
        """Estimate of the contact axis."""
        return self.estimates[0]
