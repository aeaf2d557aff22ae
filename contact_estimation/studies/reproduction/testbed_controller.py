# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Impedance control of the arm, eq. (1), by computed torque with an imperfect model."""

from __future__ import annotations

from math import cos, sin

from .symmetric_matrix import times
from .testbed_arm import PlanarArm
from .testbed_constants import TestbedConstants, Triple
from ...estimators.offline_estimator import TargetImpedance
from ...reference.setpoints import Reference


class ImpedanceController:
    """
    Joint torques that make the tip obey eq. (1) along x, given an exact model.

    T = M_hat J^-1 (x''_d - J' a') + h_hat - J^T F. The model lacks the
    rotors and part of the joint friction: the actual impedance differs from the target.
    """

    def __init__(self, constants: TestbedConstants, target: TargetImpedance) -> None:
        self._arm, self._p = constants.arm, constants.controller
        self._model = PlanarArm(constants.arm, rotors=False)
        self._target = target

    def torques(
        self, angles: Triple, rates: Triple, force: float, reference: Reference
    ) -> Triple:
        """
        Compute the motor torques for one sample period.

        angles, rates: link angles and rates [rad], [rad/s]
        force: measured F_e [N]
        reference: x_r with derivatives, relative to the wall's surface
        Returns torques: joint torques [N m]
        """
        accelerations = self._link_accelerations(angles, rates, force, reference)
        t1, t2, t3 = times(self._model.mass_matrix(angles), accelerations)
        h1, h2, h3 = self._model.centrifugal(angles, rates)
        x1, x2, x3 = self._model.jacobian(angles)[0]
        # Generalised forces of the link angles: T_i = tau_i - tau_(i+1).
        tau3 = t3 + h3 - x3 * force
        tau2 = t2 + h2 - x2 * force + tau3
        tau1 = t1 + h1 - x1 * force + tau2
        f1, f2, f3 = self._model.joint_friction(
            rates, self._p.coulomb_compensation, self._p.viscous_compensation)
        return tau1 + f1, tau2 + f2, tau3 + f3

    def _link_accelerations(
        self, angles: Triple, rates: Triple, force: float, reference: Reference
    ) -> Triple:
        """Solve J a'' = x''_d - J' a' for a''."""
        p, target, arm = self._p, self._target, self._arm
        tip = self._model.tip(angles, rates)
        x = tip.x - arm.surface_x
        a_x = reference.acceleration + (
            target.damping * (reference.velocity - tip.x_dot)
            + target.stiffness * (reference.position - x) + force
        ) / target.mass
        a_y = -(
            p.lateral_damping * tip.y_dot + p.lateral_stiffness * (tip.y - arm.tip_y)
        ) / p.lateral_mass
        a_3 = -p.angular_rate * (
            2.0 * tip.angle_dot + p.angular_rate * (tip.angle - arm.tip_angle)
        )
        (a1, a2, a3), (w1, w2, w3), (l1, l2, l3) = angles, rates, arm.lengths
        c1, s1, c2, s2, c3, s3 = cos(a1), sin(a1), cos(a2), sin(a2), cos(a3), sin(a3)
        # x'' = -sum l (s a'' + c w^2), y'' = sum l (c a'' - s w^2)
        right_x = -a_x - l1 * c1 * w1 * w1 - l2 * c2 * w2 * w2 - l3 * (s3 * a_3 + c3 * w3 * w3)
        right_y = a_y + l1 * s1 * w1 * w1 + l2 * s2 * w2 * w2 - l3 * (c3 * a_3 - s3 * w3 * w3)
        bend = sin(a1 - a2)  # zero for a stretched arm
        return (
            (right_x * c2 - right_y * s2) / (l1 * bend),
            (right_y * s1 - right_x * c1) / (l2 * bend),
            a_3,
        )
