# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Base class of the effects of the robot, and its joint."""

from dataclasses import dataclass
from math import sqrt
from typing import Any, NamedTuple

from .effect import Effect, Need
from .numeric import Number


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
        """Return f (N,) [N] from how far the motor leads the link [m], and how fast [m/s]."""
        return self.stiffness * bent + self.damping * rate


@dataclass(frozen=True)
class RobotEffect(Effect):
    """
    Physics of the robot: how its motion departs from the target impedance of eq. (1).

    A subclass overrides the hooks that its law changes. u and velocity are numbers or ndarrays,
    shape (N,); m is the module `math` or `numpy`.
    """

    port = 'robot'
    needs = frozenset({Need.ROBOT})

    def impedance(
        self, mass: float, damping: float, stiffness: float
    ) -> tuple[float, float, float]:
        """Return M_t [kg], B_t [N s/m] and K_t [N/m] that the robot has in place of these."""
        return mass, damping, stiffness

    @property
    def reflected_inertia(self) -> float:
        """Mass that the feed-forward does not compensate [kg]."""
        return 0.0

    @property
    def reference_delay(self) -> float:
        """Delay of the reference [s]."""
        return 0.0

    @property
    def lag(self) -> float:
        """Time constant with which the drives follow the control force [s]."""
        return 0.0

    def control(self, u: Number, m: Any) -> Number:
        """Return the control force that the drives deliver of the commanded one [N]."""
        return u

    def drag(self, velocity: Number, m: Any) -> Number:
        """Return the force that resists the motion of the robot [N]."""
        return 0.0 * velocity

    def joint(self, mass: float) -> Joint | None:
        """Return the spring between motor, whose position is measured, and link, both of mass."""
        return None
