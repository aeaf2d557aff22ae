# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Motion and force at one instant."""

from __future__ import annotations

from typing import NamedTuple


class ContactSample(NamedTuple):
    """
    Motion and force at one instant, along one axis.

    A NamedTuple: creating a frozen dataclass of this size takes longer than an estimator update.
    """

    stamp_ns: int  # header stamp of the wrench [ns]
    position: float  # x of the end-effector [m], +x into the wall
    velocity: float  # its rate [m/s]; NaN where not measured
    force: float  # measured F_e [N], negative while pressing


AxesSample = tuple[ContactSample, ...]
"""One sample of each estimated axis, all with the same stamp, the contact axis first."""
