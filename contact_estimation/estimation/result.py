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
    """
    The stamp of a sample, unique even where the clock has jumped back.

    Attributes
    ----------
    jumps : int
        Number of backward clock jumps before the sample.
    stamp_ns : int
        Stamp of the sample [ns].

    """

    jumps: int
    stamp_ns: int


class Result(NamedTuple):
    """
    The estimates and the reference that belong to one sample.

    Attributes
    ----------
    sample : ContactSample
        Of the contact axis.
    estimates : AxesEstimates
        One for each estimated axis, the contact axis first.
    reference_stamp_ns : int
        Instant from which the robot follows the reference [ns].
    reference : Reference or None
        None where the session does not generate it (replay).
    arm : ArmState or None
        Pose and compensated wrench of an arm.

    """

    sample: ContactSample
    estimates: AxesEstimates
    reference_stamp_ns: int
    reference: Reference | None
    arm: ArmState | None = None

    @property
    def estimate(self) -> Estimate:
        """Estimate of the contact axis."""
        return self.estimates[0]
