# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Base class of the effects of the robot, and its joint."""

from __future__ import annotations

from math import sqrt
from typing import Any, NamedTuple

from .effect import Effect
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
        """
        Return the force with which the motor pushes the link.

        bent, rate (N,): position of the motor less that of the link [m], and its rate [m/s]
        Returns force (N,): f [N]
        """
        return self.stiffness * bent + self.damping * rate


class RobotEffect(Effect):
    """Physics of the robot: how its motion departs from the target impedance of eq. (1)."""

    port = 'robot'
    needs_robot = True
    mass_scale: float = 1.0
    damping_scale: float = 1.0
    stiffness_scale: float = 1.0
    reflected_inertia: float = 0.0
    """Mass that the feed-forward does not compensate [kg]."""

    reference_delay: float = 0.0
    """Delay of the reference [s]."""

    actuator_lag: float = 0.0
    """Time constant with which the drives follow the control force [s]."""

    def control(self, u: Number, m: Any) -> Number:
        """
        Return the control force that the drives deliver.

        Parameters
        ----------
        u : float or ndarray, shape (N,)
            Force commanded by the impedance law [N].
        m : module
            `math` or `numpy`.

        Returns
        -------
        u : float or ndarray, shape (N,)
            Delivered force [N].

        """
        return u

    def drag(self, velocity: Number, m: Any) -> Number:
        """
        Return the force that resists the motion of the robot.

        Parameters
        ----------
        velocity : float or ndarray, shape (N,)
            Velocity of the end-effector [m/s].
        m : module
            `math` or `numpy`.

        Returns
        -------
        force : float or ndarray, shape (N,)
            Drag [N], positive where it resists positive velocity.

        """
        return 0.0 * velocity

    def joint(self, mass: float) -> Joint | None:
        """
        Return the spring between the motor, whose position is measured, and the link.

        Parameters
        ----------
        mass : float
            Of both [kg].

        Returns
        -------
        joint : Joint or None
            None for a rigid robot.

        """
        return None
