# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""A spring and a damper between motor and link."""

from __future__ import annotations

from math import sqrt
from typing import Any, NamedTuple


class Joint(NamedTuple):
    """Elastic joint."""

    compliance: float  # c [m/N], > 0
    mass: float  # of the link, m [kg]
    damping_ratio: float  # of the link on the joint

    @property
    def stiffness(self) -> float:
        """1 / C [N/m]."""
        return 1.0 / self.compliance

    @property
    def damping(self) -> float:
        """Return c = 2 zeta sqrt(m / C) [N s/m]."""
        return 2.0 * self.damping_ratio * sqrt(self.mass / self.compliance)

    def force(self, bent: Any, rate: Any) -> Any:
        """
        Return the force with which the motor pushes the link.

        bent, rate (N,): position of the motor less that of the link [m], and its rate [m/s]
        Returns force (N,): f [N]
        """
        return self.stiffness * bent + self.damping * rate
