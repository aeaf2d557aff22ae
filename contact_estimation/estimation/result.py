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
