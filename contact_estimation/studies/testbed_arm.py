# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""A planar arm of three links without gravity, and its impedance control by computed torque."""

from dataclasses import dataclass
from math import acos, atan2, cos, hypot, sin
from typing import NamedTuple

import numpy as np

from ..estimators.offline_estimator import TargetImpedance
from ..physics.numeric import Array
from ..reference.setpoints import Reference

K_E, B_E = 4800.0, 200.0
"""True stiffness [N/m] and damping [N s/m] of the wall."""

Triple = tuple[float, float, float]


@dataclass(frozen=True)
class ArmConstants:
    """A horizontal arm of three modular links with geared joint motors (paper: Figure 3)."""

    # About half a metre each, judged from the photograph; the last carries the force sensor.
    lengths: Triple = (0.50, 0.45, 0.20)  # [m]
    # Mass of each link with the motor module at its far end.
    masses: Triple = (6.0, 4.0, 1.5)  # [kg]
    # Distance of the centre of mass from the near joint; motor modules at the far ends.
    centres: Triple = (0.32, 0.27, 0.10)  # [m]
    # About the centre of mass; rod plus end mass.
    inertias: Triple = (0.15, 0.08, 0.008)  # [kg m^2]
    # Rotor inertias reflected to the joints; not in the controller's model.
    rotor_inertias: Triple = (0.68, 0.45, 0.075)  # [kg m^2]
    # Dry friction of the gears, which changes sign over `friction_rate`.
    coulomb_frictions: Triple = (1.0, 0.7, 0.2)  # [N m]
    friction_rate: float = 0.01  # [rad/s]
    viscous_frictions: Triple = (1.5, 1.0, 0.2)  # [N m s]
    # Pose of the tip relative to the base at the wall's surface: elbow bent, +x into the wall.
    surface_x: float = 0.70  # x of the wall's surface from the base [m]
    tip_y: float = 0.20  # [m]
    tip_angle: float = 0.0  # last link along the contact axis [rad]


@dataclass(frozen=True)
class ControllerConstants:
    """Impedance control at the sample rate with an imperfect model of the arm."""

    # Fractions of the joint friction that the feed-forward compensates.
    coulomb_compensation: float = 0.8
    viscous_compensation: float = 1.0
    # Across the contact axis and about the tip the arm holds its pose.
    lateral_mass: float = 50.0  # [kg]
    lateral_damping: float = 1000.0  # [N s/m]
    lateral_stiffness: float = 5000.0  # [N/m]
    angular_rate: float = 12.0  # natural frequency, critically damped [rad/s]


@dataclass(frozen=True)
class FlexibleWallConstants:
    """Plate on linear bearings before springs and oil dampers (paper: Figure 4)."""

    stiffness: float = K_E  # [N/m], paper
    damping: float = B_E  # [N s/m], paper
    # Breakaway force (paper), which the paper's processing subtracts from the force.
    static_friction: float = 6.0  # [N]
    # Friction of the rolling bearings, approached over the Stribeck velocity. With the full 6 N
    # the plain estimates of B_e would be off by 100 % and more under excitation.
    sliding_friction: float = 0.6  # [N]
    stribeck_velocity: float = 2e-3  # [m/s]
    # The bearings creep over this distance before they slide (Dahl's model).
    presliding: float = 2e-5  # [m]


@dataclass(frozen=True)
class SensingConstants:
    """Force sensor and potentiometer."""

    force_noise: float = 1.0  # half width of uniform noise [N], paper
    # Resistance track and wiring: half width of uniform noise.
    potentiometer_noise: float = 2e-5  # [m]
    # 12 bits over a travel of 50 mm.
    potentiometer_step: float = 0.05 / 4096  # [m]
    filter_cutoff: float = 50.0  # Butterworth of second order [Hz], paper


@dataclass(frozen=True)
class TestbedConstants:
    """
    All constants of the testbed, each with its origin.

    "Paper" marks values from Erickson, Weber and Sharf (2003), sections 3 and 5. The paper leaves
    the others open. They were chosen once, to suit the described hardware and with the plain
    algorithms only (indirect_adaptive and rls on data processed as in the paper, then
    signal_processing), before any improved estimator ran on the testbed, and are frozen since. Ten
    runs gave these |errors| of the average estimate of K_e / B_e in percent, the paper's in
    parentheses (indirect_adaptive under the law `series`, which presses with 50 N as in the
    paper's figure 10):

    - testbed_sine: indirect_adaptive 15.6 / 27.0 (12.6 / 15.7), rls 22.4 / 24.8 (3.5 / 22);
    - testbed_none: indirect_adaptive 11.6 / 62.0 (8.9 / 60), rls 11.4 / 65.4 (19.2 / 85),
      signal_processing 37.0 / 48.1 (37 / 82).

    These figures are of the estimators as they were when the constants were frozen. All agree
    within a factor of two except K_e of rls under excitation: the 6 N subtracted whichever way the
    wall moves are 12.5 % of 48 N for every estimator, and no choice of constants hides this.
    """

    __test__ = False  # not a test, despite its name

    arm: ArmConstants = ArmConstants()
    controller: ControllerConstants = ControllerConstants()
    wall: FlexibleWallConstants = FlexibleWallConstants()
    sensing: SensingConstants = SensingConstants()
    sample_rate: float = 500.0  # [Hz], paper
    steps_per_sample: int = 4  # of the integration, at 2 kHz


TESTBED = TestbedConstants()
"""The constants used by all runs."""


class Tip(NamedTuple):
    """Pose of the tip and its rate: x [m], y [m] and angle [rad]."""

    x: float
    y: float
    angle: float
    x_dot: float
    y_dot: float
    angle_dot: float


_BETWEEN = np.eye(3) - np.eye(3, k=-1)
"""From the angles of links to those of the joints between them."""


class PlanarArm:
    """Equations of motion M(a) a'' + h(a, a') = T + J^T F of link angles a, shape (3,) [rad]."""

    def __init__(self, constants: ArmConstants, rotors: bool = True) -> None:
        self._p = constants
        self._l, m, r, j = (np.array(each) for each in (
            constants.lengths, constants.masses, constants.centres, constants.rotor_inertias))
        self._coulomb, self._viscous = (np.array(each) for each in (
            constants.coulomb_frictions, constants.viscous_frictions))
        beyond = np.cumsum(m[::-1])[::-1] - m  # mass that the end of each link carries
        of_pairs = np.triu(np.outer(self._l, m * r + beyond * self._l), 1)
        self._C = of_pairs + of_pairs.T + np.diag(
            constants.inertias + m * r**2 + beyond * self._l**2)
        self._J = _BETWEEN.T @ np.diag(j) @ _BETWEEN if rotors else np.zeros((3, 3))

    def mass_matrix(self, angles: Array) -> Array:
        """Compute M(a), shape (3, 3) [kg m^2]."""
        return self._C * np.cos(angles[:, None] - angles) + self._J

    def centrifugal(self, angles: Array, rates: Array) -> Array:
        """Compute the torques h(a, a') [N m] at rates [rad/s]."""
        return np.asarray((self._C * np.sin(angles[:, None] - angles)) @ rates**2)

    def accelerations(
        self, angles: Array, rates: Array, torques: Array, force_x: float
    ) -> Array:
        """Return a'' [rad/s^2] under motor torques [N m] and a force on the tip along x [N]."""
        driven = _BETWEEN.T @ (torques - self.joint_friction(rates))
        return np.linalg.solve(
            self.mass_matrix(angles),
            driven - self.centrifugal(angles, rates) + force_x * self.jacobian(angles)[0])

    def joint_friction(self, rates: Array, dry: float = 1.0, viscous: float = 1.0) -> Array:
        """Compute the friction of the gears, of which shares are dry and viscous [N m]."""
        v = _BETWEEN @ rates
        return np.asarray(dry * self._coulomb * np.tanh(v / self._p.friction_rate)
                          + viscous * self._viscous * v)

    def tip_x(self, angles: Array) -> float:
        """Compute the distance of the tip from the base [m], as `tip` does."""
        return float(self._l @ np.cos(angles))

    def tip(self, angles: Array, rates: Array) -> Tip:
        """Compute pose and rate of the tip at link angles [rad] and rates [rad/s]."""
        x, y = self.jacobian(angles)
        return Tip(*(float(each) for each in (
            y.sum(), -x.sum(), angles[2], x @ rates, y @ rates, rates[2])))

    def jacobian(self, angles: Array) -> Array:
        """Compute d x / d a and d y / d a of the tip, (2, 3) [m]; the third row is (0, 0, 1)."""
        return np.array([-self._l * np.sin(angles), self._l * np.cos(angles)])

    def angles_at(self, x: float, y: float, angle: float) -> Array:
        """Solve the inverse kinematics for link angles [rad], elbow up."""
        l1, l2, l3 = self._p.lengths
        wrist_x, wrist_y = x - l3 * cos(angle), y - l3 * sin(angle)
        reach = hypot(wrist_x, wrist_y)
        opening = acos((l1**2 + reach**2 - l2**2) / (2.0 * l1 * reach))
        a1 = atan2(wrist_y, wrist_x) + opening
        a2 = atan2(wrist_y - l1 * sin(a1), wrist_x - l1 * cos(a1))
        return np.array([a1, a2, angle])


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

    def torques(self, angles: Array, rates: Array, force: float, reference: Reference) -> Array:
        """Compute the motor torques for one sample period [N m] from the measured F_e [N]."""
        model, (x, y) = self._model, self._model.jacobian(angles)
        wanted = self._tip_accelerations(model.tip(angles, rates), force, reference)
        turning = np.array([-y @ rates**2, x @ rates**2, 0.0])  # J' a'
        accelerations = np.linalg.solve([x, y, (0.0, 0.0, 1.0)], wanted - turning)
        driven = (model.mass_matrix(angles) @ accelerations + model.centrifugal(angles, rates)
                  - force * x)
        return np.asarray(np.cumsum(driven[::-1])[::-1] + model.joint_friction(
            rates, self._p.coulomb_compensation, self._p.viscous_compensation))

    def _tip_accelerations(self, tip: Tip, force: float, reference: Reference) -> Array:
        """Return x''_d: eq. (1) along x; across it and about the tip the arm holds its pose."""
        p, target, arm = self._p, self._target, self._arm
        a_x = reference.acceleration + (
            target.damping * (reference.velocity - tip.x_dot)
            + target.stiffness * (reference.position - (tip.x - arm.surface_x)) + force
        ) / target.mass
        a_y = -(
            p.lateral_damping * tip.y_dot + p.lateral_stiffness * (tip.y - arm.tip_y)
        ) / p.lateral_mass
        a_3 = -p.angular_rate * (
            2.0 * tip.angle_dot + p.angular_rate * (tip.angle - arm.tip_angle))
        return np.array([a_x, a_y, a_3])
