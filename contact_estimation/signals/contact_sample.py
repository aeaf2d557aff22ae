# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Motion and force at one instant."""

from __future__ import annotations

from typing import NamedTuple


class ContactSample(NamedTuple):
    """
    Motion and force at one instant, along one axis.

    A NamedTuple: creating a frozen dataclass of this size takes longer than an estimator update.

    Attributes
    ----------
    stamp_ns : int
        Header stamp of the wrench [ns].
    position : float
        x of the end-effector [m], +x into the wall.
    velocity : float
        Its rate [m/s]; NaN where not measured.
    force : float
        Measured F_e [N], negative while pressing.

    """

    stamp_ns: int
    position: float
    velocity: float
    force: float


AxesSample = tuple[ContactSample, ...]
"""One sample of each estimated axis, all with the same stamp, the contact axis first."""
