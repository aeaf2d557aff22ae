# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
Kinematics and dynamics of a planar arm of three links, without gravity.

Coordinates are the angles a_i of the links to the x axis, in which the kinetic energy is
1/2 sum c_ij cos(a_i - a_j) w_i w_j with constant c_ij, plus the rotors; joint i turns by
a_i - a_(i-1). Plain scalars: arrays of length three are ten times
slower.
"""

from __future__ import annotations

from math import acos, atan2, cos, hypot, sin, tanh
from typing import NamedTuple

from .symmetric_matrix import solve, Symmetric
from .testbed_constants import ArmConstants, Triple


class Tip(NamedTuple):
    """Pose of the tip and its rate: x [m], y [m] and angle [rad]."""

    x: float
    y: float
    angle: float
    x_dot: float
    y_dot: float
    angle_dot: float


class PlanarArm:
    """Equations of motion M(a) a'' + h(a, a') = T + J^T F."""

    def __init__(self, constants: ArmConstants, rotors: bool = True) -> None:
        self._p = p = constants
        (l1, l2, _), (m1, m2, m3) = p.lengths, p.masses
        r1, r2, r3 = p.centres
        self._c11 = p.inertias[0] + m1 * r1**2 + (m2 + m3) * l1**2
        self._c22 = p.inertias[1] + m2 * r2**2 + m3 * l2**2
        self._c33 = p.inertias[2] + m3 * r3**2
        self._c12, self._c13, self._c23 = (m2 * r2 + m3 * l2) * l1, m3 * r3 * l1, m3 * r3 * l2
        j1, j2, j3 = p.rotor_inertias if rotors else (0.0, 0.0, 0.0)
        # 1/2 sum j_i (w_i - w_(i-1))^2
        self._c11, self._c22, self._c33 = self._c11 + j1 + j2, self._c22 + j2 + j3, self._c33 + j3
        self._j12, self._j23 = -j2, -j3

    def mass_matrix(self, angles: Triple) -> Symmetric:
        """
        Compute M(a).

        angles: link angles [rad]
        Returns M: upper triangle [kg m^2]
        """
        a1, a2, a3 = angles
        return (
            self._c11, self._c12 * cos(a1 - a2) + self._j12, self._c13 * cos(a1 - a3),
            self._c22, self._c23 * cos(a2 - a3) + self._j23, self._c33,
        )

    def centrifugal(self, angles: Triple, rates: Triple) -> Triple:
        """
        Compute h(a, a').

        angles, rates: link angles and rates [rad], [rad/s]
        Returns h: torques [N m]
        """
        (a1, a2, a3), (w1, w2, w3) = angles, rates
        s12, s13 = self._c12 * sin(a1 - a2), self._c13 * sin(a1 - a3)
        s23 = self._c23 * sin(a2 - a3)
        return (
            s12 * w2 * w2 + s13 * w3 * w3,
            s23 * w3 * w3 - s12 * w1 * w1,
            -s13 * w1 * w1 - s23 * w2 * w2,
        )

    def accelerations(
        self, angles: Triple, rates: Triple, torques: Triple, force_x: float
    ) -> Triple:
        """
        Solve the equations of motion, joint friction included.

        angles, rates: link angles and rates [rad], [rad/s]
        torques: motor torques [N m]
        force_x: force on the tip along x [N]
        Returns accelerations: link accelerations [rad/s^2]
        """
        (a1, a2, a3), (w1, w2, w3), (l1, l2, l3) = angles, rates, self._p.lengths
        # Innermost loop of the testbed: sines and cosines are computed once for M, h and J.
        c1, c2, c3, s1, s2, s3 = cos(a1), cos(a2), cos(a3), sin(a1), sin(a2), sin(a3)
        h12, h13 = self._c12 * (s1 * c2 - c1 * s2), self._c13 * (s1 * c3 - c1 * s3)
        h23 = self._c23 * (s2 * c3 - c2 * s3)
        f1, f2, f3 = self.joint_friction(rates)
        t1, t2, t3 = torques[0] - f1, torques[1] - f2, torques[2] - f3
        q1, q2, q3 = w1 * w1, w2 * w2, w3 * w3
        return solve(
            (
                self._c11, self._c12 * (c1 * c2 + s1 * s2) + self._j12,
                self._c13 * (c1 * c3 + s1 * s3), self._c22,
                self._c23 * (c2 * c3 + s2 * s3) + self._j23, self._c33,
            ),
            (
                t1 - t2 - h12 * q2 - h13 * q3 - force_x * l1 * s1,
                t2 - t3 - h23 * q3 + h12 * q1 - force_x * l2 * s2,
                t3 + h13 * q1 + h23 * q2 - force_x * l3 * s3,
            ),
        )

    def joint_friction(
        self, rates: Triple, dry: float = 1.0, viscous: float = 1.0
    ) -> Triple:
        """
        Compute the friction of the gears.

        rates: link rates [rad/s]
        dry, viscous: fractions of dry and viscous friction to include
        Returns torques: joint torques, positive against positive motion [N m]
        """
        (w1, w2, w3), s = rates, self._p.friction_rate
        (c1, c2, c3), (b1, b2, b3) = self._p.coulomb_frictions, self._p.viscous_frictions
        v2, v3 = w2 - w1, w3 - w2
        return (
            dry * (c1 * tanh(w1 / s)) + viscous * b1 * w1,
            dry * (c2 * tanh(v2 / s)) + viscous * b2 * v2,
            dry * (c3 * tanh(v3 / s)) + viscous * b3 * v3,
        )

    def tip_x(self, angles: Triple) -> float:
        """
        Compute x of the tip, as `tip` does.

        angles: link angles [rad]
        Returns x: distance from the base [m]
        """
        (a1, a2, a3), (l1, l2, l3) = angles, self._p.lengths
        return l1 * cos(a1) + l2 * cos(a2) + l3 * cos(a3)

    def tip(self, angles: Triple, rates: Triple) -> Tip:
        """
        Compute pose and rate of the tip.

        angles, rates: link angles and rates [rad], [rad/s]
        """
        (x1, x2, x3), (y1, y2, y3) = self.jacobian(angles)
        w1, w2, w3 = rates
        return Tip(
            y1 + y2 + y3, -(x1 + x2 + x3), angles[2],
            x1 * w1 + x2 * w2 + x3 * w3, y1 * w1 + y2 * w2 + y3 * w3, w3,
        )

    def jacobian(self, angles: Triple) -> tuple[Triple, Triple]:
        """
        Compute the rows of J for x and y of the tip; the third is (0, 0, 1).

        angles: link angles [rad]
        Returns by_x, by_y: d x / d a and d y / d a [m]
        """
        (a1, a2, a3), (l1, l2, l3) = angles, self._p.lengths
        return (
            (-l1 * sin(a1), -l2 * sin(a2), -l3 * sin(a3)),
            (l1 * cos(a1), l2 * cos(a2), l3 * cos(a3)),
        )

    def angles_at(self, x: float, y: float, angle: float) -> Triple:
        """
        Solve the inverse kinematics, elbow up.

        x, y, angle: pose of the tip [m], [m], [rad], within reach
        Returns angles: link angles [rad]
        """
        l1, l2, l3 = self._p.lengths
        wrist_x, wrist_y = x - l3 * cos(angle), y - l3 * sin(angle)
        reach = hypot(wrist_x, wrist_y)
        opening = acos((l1**2 + reach**2 - l2**2) / (2.0 * l1 * reach))
        a1 = atan2(wrist_y, wrist_x) + opening
        a2 = atan2(wrist_y - l1 * sin(a1), wrist_x - l1 * cos(a1))
        return a1, a2, angle
