# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
The wrench at the contact from the torques of the joints, where an arm has no force sensor.

The generalised momentum p = M(q) q' obeys p' = tau + C(q, q')^T q' - g(q) - f(q') + tau_ext, so
that over a window of 10 ms

    mean of tau_ext = (p(end) - p(begin)) / duration - mean of (tau + C^T q' - g - f)

without the acceleration: the momentum observer of De Luca and Mattone (*Sensorless robot collision
detection and hybrid force/motion control*, ICRA 2005; Haddadin, De Luca and Albu-Schaeffer, IEEE
Trans. Robotics 33(6), 2017) with a finite memory. The motion is averaged over the same window and
both are stamped with its middle: a wall that obeys eq. (3) does so for averages, too, without a
lag. Windows do not overlap, so that their noise is white.

f(q') = F_c sgn(q') + B q' are friction and damping of the robot description, the rotors' inertia
is in M; `diagnose --nominal-robot --write-urdf` finds all three. The wrench w at the contact point
is the mean of its posterior given tau_ext = J^T w + e, a damped pseudo-inverse of J^T:

    w = (J S^-1 J^T + P^-1)^-1 J S^-1 tau_ext

S, the covariance of e, is measured as the torque that is left in free flight, to which that of a
joint at rest adds: its friction is anywhere within +-F_c. What errors of friction and inertia do
to K_hat and B_hat is propagated along the motion, see `LastingError`.

"""

from typing import NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray

from ..exceptions import ModelFileError
from ..kinematics.arm_dynamics import ArmDynamics
from ..kinematics.robot_model import RobotModel
from ..kinematics.tool_load import cross_matrix
from ..physics.joint_friction import sign

Array = NDArray[np.float64]

WINDOW_S = 0.01
REST = 0.01
"""Speed below which the direction of friction is not known [rad/s]: the resolution of encoders."""
_FIRST_STD, _FIRST_S = 1.0, 0.1  # of the torques before any free flight [N m], and its weight [s]
_PRIOR = np.repeat([300.0, 10.0], 3)  # standard deviations of force and moment at the contact


class Joints(NamedTuple):
    """Stamp [ns], and q, q' and the measured torque of each joint, shapes (n,)."""

    stamp_ns: int
    q: Array
    v: Array
    tau: Array


class ContactWrench(NamedTuple):
    """Motion and wrench in the middle of a window."""

    stamp_ns: int  # of the middle [ns]
    motion: Array  # (2 n,) means of q, then of q'
    # (6,) force [N] and torque about the tip's origin [N m] on the arm, in the tip's axes
    wrench: Array
    # (3, n + 1) errors of the force in axes of the base, each of one standard deviation [N]: of
    # the friction of each joint, and of the inertia
    errors: Array


class JointTorques:
    """
    Observe the external torques of an arm, and the wrench at its contact.

    urdf: description with masses, friction and damping
    model: from base to tip
    point (3,): where the tip touches, in its frame [m]
    model_std: relative standard deviation of friction and inertia of the description
    effort_sign: -1 where the driver publishes the torque of the joints on the motors
    longest_gap_s: between joint states, beyond which a window begins anew [s]
    arm: of the joints between base and tip
    external (n,): tau_ext of the last window [N m]
    """

    def __init__(
        self, urdf: str, model: RobotModel, point: Sequence[float], model_std: float = 0.05,
        effort_sign: float = 1.0, longest_gap_s: float = 0.05,
    ) -> None:
        self.arm = arm = ArmDynamics(urdf, model.joint_names)
        if arm.placeholder:
            raise ModelFileError(
                f'wrench_source joint_efforts needs a robot description with masses, but '
                f'{arm.placeholder}; use the one of the manufacturer, or diagnose --nominal-robot '
                '... --write-urdf')
        self._model, self._point = model, np.array(point, float)
        self._std, self._sign = model_std, effort_sign
        self._longest_ns = int(longest_gap_s * 1e9)
        self._rows: list[tuple[Joints, Array, Array]] = []  # with p and its rate but tau_ext
        self._last: list[Joints] = []
        count = len(arm.joints)
        self.external = np.zeros(count)
        self._squares, self._seconds = np.full(count, _FIRST_S * _FIRST_STD**2), _FIRST_S

    def add(self, joints: Joints) -> ContactWrench | None:
        """Add joint states, whose q' may be NaN; None where no window ends with them."""
        if self._last and not 0 < joints.stamp_ns - self._last[-1].stamp_ns <= self._longest_ns:
            self._rows.clear()
            self._last.clear()
        if not np.isnan(joints.v).any():
            return self._observe(joints)
        self._last = [*self._last[-2:], joints]
        if len(self._last) < 3:
            return None
        before, now, after = self._last
        rate = (after.q - before.q) / (1e-9 * (after.stamp_ns - before.stamp_ns))
        return self._observe(now._replace(v=rate), after)

    def _observe(self, joints: Joints, newest: Joints | None = None) -> ContactWrench | None:
        if newest is None:
            self._last = [joints]
        rows = self._rows
        p, rate = self.arm.momentum(joints.q, joints.v)
        rate += self._sign * joints.tau - self.arm.damping * joints.v
        rows.append((joints, p, rate - self.arm.friction * sign(joints.v, REST)))
        first = rows[0][0]
        if joints.stamp_ns - first.stamp_ns < WINDOW_S * 1e9 - 1e3:
            return None
        t = 1e-9 * np.array([row[0].stamp_ns - first.stamp_ns for row in rows])
        step, duration = np.diff(t), float(t[-1])
        share = 0.5 * np.append(step, 0.0) / duration + 0.5 * np.append(0.0, step) / duration
        q, v, rate = (share @ np.array(signal) for signal in (
            [row[0].q for row in rows], [row[0].v for row in rows], [row[2] for row in rows]))
        inertial = (rows[-1][1] - rows[0][1]) / duration
        self.external = inertial - rate
        self._duration = duration
        del rows[:-1]
        return self._contact((first.stamp_ns + joints.stamp_ns) // 2, q, v, inertial)

    def _contact(self, stamp_ns: int, q: Array, v: Array, inertial: Array) -> ContactWrench:
        arm, (R, _) = self.arm, self._model.pose(q)
        J, lever = self._model.jacobian(q), R @ self._point
        J[:3] -= cross_matrix(lever) @ J[3:]
        turns = sign(v, REST)
        at_rest = arm.friction**2 * (1.0 - turns**2) / 3.0
        weighed = J / (self._squares / self._seconds + at_rest)
        inverse = np.linalg.inv(weighed @ J.T + np.diag(_PRIOR**-2)) @ weighed
        force, moment = (inverse @ self.external).reshape(2, 3)
        wrench = np.concatenate([R.T @ force, R.T @ (moment + np.cross(lever, force))])
        errors = self._std * np.column_stack([
            inverse[:3] * (arm.friction * turns + arm.damping * v), inverse[:3] @ inertial])
        return ContactWrench(stamp_ns, np.concatenate([q, v]), wrench, errors)

    def note_free(self) -> None:
        """Learn from the last window, in free flight, by how much the torques are off."""
        self._squares = self._squares + self._duration * self.external**2
        self._seconds += self._duration
