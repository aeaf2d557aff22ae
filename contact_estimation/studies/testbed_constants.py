# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
All constants of the virtual testbed, each with its origin, and the wall of all cases.

"Paper" marks values from Erickson, Weber and Sharf (2003), sections 3 and 5. The paper leaves the
others open. They were chosen once, to suit the described hardware and with the plain algorithms
only (indirect_adaptive and rls on data processed as in the paper, then signal_processing), before
any improved estimator ran on the testbed, and are frozen since. Ten runs gave these |errors| of
the average estimate of K_e / B_e in percent, the paper's in parentheses (indirect_adaptive under
the law `series`, which presses with 50 N as in the paper's figure 10):

- testbed_sine: indirect_adaptive 15.6 / 27.0 (12.6 / 15.7), rls 22.4 / 24.8 (3.5 / 22);
- testbed_none: indirect_adaptive 11.6 / 62.0 (8.9 / 60), rls 11.4 / 65.4 (19.2 / 85),
  signal_processing 37.0 / 48.1 (37 / 82).

These figures are of the estimators as they were when the constants were frozen. All agree within
a factor of two except K_e of rls under excitation: the 6 N subtracted whichever way the wall moves
are 12.5 % of 48 N for every estimator, and no choice of constants hides this.
"""

from __future__ import annotations

from dataclasses import dataclass

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
    """All constants of the testbed."""

    __test__ = False  # not a test, despite its name

    arm: ArmConstants = ArmConstants()
    controller: ControllerConstants = ControllerConstants()
    wall: FlexibleWallConstants = FlexibleWallConstants()
    sensing: SensingConstants = SensingConstants()
    sample_rate: float = 500.0  # [Hz], paper
    steps_per_sample: int = 4  # of the integration, at 2 kHz


TESTBED = TestbedConstants()
"""The constants used by all runs."""
