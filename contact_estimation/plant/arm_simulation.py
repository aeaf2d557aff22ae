# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Simulated motion of an arm under joint control, with the physics of JOINT_EFFECTS."""

from dataclasses import dataclass, field, replace
import math
from typing import Any, Callable, Sequence

import numpy as np

from .arm_models import TIP
from ..kinematics.arm_dynamics import ArmDynamics, PER_LINK
from ..physics.contact_law import ContactLaw
from ..physics.joint_effects import JOINT_EFFECTS, JointEffect, JointMotion, Place
from ..physics.numeric import Array
from ..reference.arm_excitation import ArmTrajectory

STEP_S = 1e-3
_BANDWIDTH, _RATIO = 2.0 * np.pi * 6.0, 0.7  # of the position control [rad/s], damping ratio
_SLOW = 0.05  # speed of which a fiftieth is the width of a sharp sgn [rad/s]
_SECANT = 1e-5  # [rad/s]
MOTOR = 0.03  # inertia of a motor behind a spring, in that of its link
_GEAR = 5e4, 20.0  # stiffness and damping of a gear with backlash, per its link's inertia
_INERTIAL = ('payload', 'link_inertia')
_SENSED = ('force_gain', 'force_bias', 'force_delay')


@dataclass(frozen=True)
class ArmLaw:
    """A law at a place."""

    effect: str  # key of JOINT_EFFECTS
    theta: Sequence[float]  # its coefficients
    place: Place = None  # of the kind that the effect has
    shape: float = 0.0  # value in which it is not linear


@dataclass(frozen=True)
class ArmSensors:
    """What joint states show of a motion."""

    rate: float = 200.0  # [Hz]
    # (n,) standard deviation [N m]
    torque_noise: Array = field(default_factory=lambda: np.zeros(1))
    position_step: float = 0.0  # resolution [rad]


@dataclass(frozen=True, eq=False)
class SimulatedArm:
    """Times (N,); positions, velocities, efforts of joints (N, n); wrenches of the tip (N, 6)."""

    t: Array
    q: Array
    v: Array
    tau: Array
    wrench: Array = field(default_factory=lambda: np.zeros((0, 6)))


@dataclass(frozen=True, eq=False)
class Impedance:
    """
    A plain Cartesian impedance, which does not shape the inertia, against a wall.

    u = g(q) + J^T (K (x_d - x) + D (v_d - v)) - d q' of the tip, the last link's origin; turning
    is held by a spring, too. Albu-Schaeffer, Ott and Hirzinger, Int. J. Robotics Research 26(1),
    2007.
    """

    normal: Array  # (3,) unit vector into the wall, axes of the root
    wall: ContactLaw  # along the normal, from the tip at the start
    # stiffness, damping, turning, joint_damping: [N/m], [N s/m], [N m/rad], [N m s/rad]
    stiffness: float = 2000.0
    damping: float = 150.0
    turning: float = 100.0
    joint_damping: float = 1.0
    noise: Array = field(default_factory=lambda: np.zeros(6))  # (6,) of the wrench


def simulate_arm(
    arm: ArmDynamics, wanted: ArmTrajectory, laws: Sequence[ArmLaw], sensors: ArmSensors,
    seed: int = 0, extra: Array | Callable[[Array, Array], Array] | None = None,
    impedance: Impedance | None = None,
) -> SimulatedArm:
    """
    Let an arm follow a trajectory.

    Linearly implicit Euler steps of 1 ms, so that dry friction sticks: with f the friction,
    (M + h df/dv + h D) v+ = M v + h (u - C v - g - f + df/dv v), D the gain of the control.

    arm: its true links, n joints
    wanted: that the control follows: feed-forward of the rigid arm, and position control
    laws: physics beyond rigid links
    sensors: of the joint states
    seed: of their noise
    extra (N, n): torque on the joints, which no law describes [N m]: over the times of `wanted`,
    or of q and q' of an instant, such as that of a wall
    impedance: control in place of that of the joints, and the wall; the tip follows that of
    `wanted`
    """
    body = _Body(arm, laws) if impedance is None else _PressingBody(arm, laws, impedance)
    feed = arm.torque(wanted.q, wanted.v, wanted.a)
    times = np.arange(wanted.t[0], wanted.t[-1], STEP_S)
    pushed = np.zeros_like(feed) if extra is None or callable(extra) else extra
    q_d, v_d, u_f, pushed = (
        np.stack([np.interp(times, wanted.t, column) for column in one.T], axis=1)
        for one in (wanted.q, wanted.v, feed, pushed))
    q, v, tau = (np.empty_like(u_f) for _ in range(3))
    wrench = np.zeros((len(times), 6))
    body.start(q_d[0])
    for k in range(len(times)):
        pushes = extra(body.q, body.v) if callable(extra) else pushed[k]
        if impedance is not None:
            wrench[k], touched = body.touch()
            pushes = pushes + touched
        q[k], v[k], tau[k] = body.step(q_d[k], v_d[k], u_f[k], pushes)
    rng = np.random.default_rng(seed)
    states = sensed(times, q, v, tau, laws, sensors, rng)
    if impedance is None:
        return states
    wrench = np.stack([np.interp(states.t, times, column) for column in wrench.T], axis=1)
    return replace(states, wrench=wrench + impedance.noise * rng.normal(size=wrench.shape))


class _Body:
    """The arm, its drives, and the laws that act on its motion."""

    def __init__(self, arm: ArmDynamics, laws: Sequence[ArmLaw]) -> None:
        self.arm, n = changed(arm, laws), len(arm.joints)
        self._sprung = [law for law in laws if law.effect in ('joint_flexibility', 'backlash')]
        self._rotor = np.zeros(n)
        static = []
        for law in laws:
            if law.effect == 'reflected_inertia':
                self._rotor[law.place] += law.theta[0]
            elif law.effect not in (*_INERTIAL, *_SENSED, 'base_tilt') and law not in self._sprung:
                static.append(law)
        self._grouped = _grouped(static)
        self._size, self._stiff, self._damp = position_control(self.arm, self._rotor)
        self._load = np.zeros(n)
        self.motors = [law.place for law in self._sprung]

    def start(self, q: Array) -> None:
        """Begin at rest."""
        self.q: Array = q.copy()
        self.v: Array = np.zeros(len(q))
        self.theta: Array = q[self.motors]
        self.omega: Array = np.zeros(len(self.motors))

    def _friction(self, v: Array) -> Array:
        """Return the torque of all laws that depend on the state."""
        n = len(self.q)
        motion = JointMotion(self.arm, self.q[None], v[None], np.zeros((1, n)), self._load[None],
                             np.full(n, _SLOW), np.zeros(n), self._load[None])
        out = np.zeros(n)
        for effect, place, shape, theta in self._grouped:
            for j, column in effect.columns(motion, place, shape).items():
                out[list(j) if isinstance(j, tuple) else j] += np.einsum(
                    'k...,k...->...', column[0], theta)
        return out

    def step(self, q_d: Array, v_d: Array, feed: Array, pushed: Array
             ) -> tuple[Array, Array, Array]:
        """Advance by one step; return measured positions and velocities, and the torques."""
        h, n, m = STEP_S, len(self.q), self.motors
        seen, fast = self.q.copy(), self.v.copy()
        seen[m], fast[m] = self.theta, self.omega
        u, damp = self._control(q_d, v_d, feed, seen)
        drag = self._friction(fast)
        slope = (self._friction(fast + _SECANT) - drag) / _SECANT
        M, bias = self.arm.forward(self.q, self.v, np.zeros(n))
        M = M + np.diag(self._rotor)
        A, b = np.zeros((n + len(m),) * 2), np.zeros(n + len(m))
        A[:n, :n] = M
        b[:n] = M @ self.v + h * (u - bias + pushed)
        drives = np.arange(n)
        drives[m] = n + np.arange(len(m))
        for k, (law, j) in enumerate(zip(self._sprung, m)):
            K, D, bent = self._spring(law, k)
            motor = MOTOR * self._size[j]
            A[n + k, n + k] = motor
            b[n + k] = motor * self.omega[k] + h * u[j]
            b[j] -= h * u[j]
            for row, sign in ((j, 1.0), (n + k, -1.0)):
                b[row] += sign * h * K * bent
                A[row, n + k] -= sign * h * (h * K + D)
                A[row, j] += sign * h * (h * K + D)
        A[np.ix_(drives, drives)] += h * (np.diag(slope) + damp)
        b[drives] += h * (slope * fast - drag)
        new = np.asarray(np.linalg.solve(A, b), np.float64)
        u -= damp @ new[drives]
        self._load = M @ (new[:n] - self.v) / h + bias
        self.v, self.omega = new[:n], new[n:]
        self.q, self.theta = self.q + h * self.v, self.theta + h * self.omega
        return seen, fast, u

    def _control(self, q_d: Array, v_d: Array, feed: Array, seen: Array) -> tuple[Array, Array]:
        """Return torques less what damps, and the damping, which is implicit."""
        return feed + self._stiff * (q_d - seen) + self._damp * v_d, np.diag(self._damp)

    def touch(self) -> tuple[Array, Array]:
        """Return the wrench of the wall at the tip, and the torques that it causes."""
        return np.zeros(6), np.zeros(len(self.q))

    def _spring(self, law: ArmLaw, k: int) -> tuple[float, float, float]:
        """Return stiffness, damping and deflection between a motor and its link."""
        bent, size = float(self.theta[k] - self.q[law.place]), float(self._size[law.place])
        if law.effect == 'joint_flexibility':
            K = 1.0 / law.theta[0]
            return K, 0.1 * np.sqrt(K * size), bent
        half = 0.5 * law.theta[0]
        if abs(bent) <= half:
            return 0.0, 0.0, 0.0
        return _GEAR[0] * size, _GEAR[1] * size, bent - half * np.sign(bent)


class _PressingBody(_Body):
    """The arm under Cartesian impedance, at a wall."""

    def __init__(self, arm: ArmDynamics, laws: Sequence[ArmLaw], impedance: Impedance) -> None:
        super().__init__(arm, laws)
        self._impedance = impedance

    def start(self, q: Array) -> None:
        """Begin at rest; the wall is where its law says, from the tip."""
        super().start(q)
        self._origin = self.arm.pose(q, TIP)[1]

    def _control(self, q_d: Array, v_d: Array, feed: Array, seen: Array) -> tuple[Array, Array]:
        one, arm, n = self._impedance, self.arm, len(seen)
        (R_d, p_d), (R, p) = arm.pose(q_d, TIP), arm.pose(seen, TIP)
        J, J_d = (arm.jacobian(x[None], TIP)[0] for x in (seen, q_d))
        pull = one.stiffness * (R.T @ (p_d - p)) + one.damping * (R.T @ R_d @ (J_d[:3] @ v_d))
        turn = 0.5 * one.turning * sum(np.cross(R.T @ R[:, k], R.T @ R_d[:, k]) for k in range(3))
        gravity = arm.forward(seen, np.zeros(n), np.zeros(n))[1]
        return (gravity + J.T @ np.concatenate([pull, turn]),
                one.damping * J[:3].T @ J[:3] + one.joint_damping * np.eye(n))

    def touch(self) -> tuple[Array, Array]:
        """Return the wrench of the wall at the tip, and the torques that it causes."""
        one = self._impedance
        R, p = self.arm.pose(self.q, TIP)
        J, n = self.arm.jacobian(self.q[None], TIP)[0], R.T @ one.normal
        x, v = float(one.normal @ (p - self._origin)), float(n @ J[:3] @ self.v)
        touch, wrench = one.wall.touch(0.0, x, v, (), math), np.zeros(6)
        if touch.contact:
            wrench[:3] = n * min(one.wall.pull, -touch.resistance)
        return wrench, J.T @ wrench


def position_control(arm: ArmDynamics, rotor: Array) -> tuple[Array, Array, Array]:
    """Return inertia, stiffness and damping of the position control of each joint, (n,)."""
    zero = np.zeros(len(arm.joints))
    size = np.diag(arm.forward(zero, zero, zero)[0]) + rotor
    return size, size * _BANDWIDTH**2, 2.0 * _RATIO * size * _BANDWIDTH


def changed(arm: ArmDynamics, laws: Sequence[ArmLaw]) -> ArmDynamics:
    """Return the arm with what its links carry, on its tilted base."""
    theta = arm.neutral.copy()
    for law in laws:
        if law.effect in _INERTIAL:
            first = PER_LINK * law.place
            theta[first:first + PER_LINK] += law.theta
    other = arm.with_parameters(theta)
    for law in laws:
        if law.effect == 'base_tilt':
            gravity = other.model.gravity.linear.copy()
            gravity[:2] += np.linalg.norm(gravity) * np.asarray(law.theta)
            other.model.gravity.linear = gravity
    return other


def _grouped(laws: Sequence[ArmLaw]) -> list[tuple[JointEffect, Place, Any, Array]]:
    """Evaluate the plain laws of all joints at once."""
    found: list[tuple[JointEffect, Place, Any, Array]] = []
    plain = ('coulomb_friction', 'viscous_friction')
    for name in plain:
        alike = [law for law in laws if law.effect == name]
        if alike:
            found.append((JOINT_EFFECTS[name], tuple(law.place for law in alike),
                          np.array([law.shape or 1e-3 for law in alike]),
                          np.array([law.theta for law in alike], dtype=float).T))
    return found + [(JOINT_EFFECTS[law.effect], law.place, law.shape,
                     np.asarray(law.theta, dtype=float)) for law in laws
                    if law.effect not in plain]


def sensed(
    t: Array, q: Array, v: Array, tau: Array, laws: Sequence[ArmLaw], sensors: ArmSensors,
    rng: np.random.Generator,
) -> SimulatedArm:
    """Sample with the errors of the sensors."""
    stamps = np.arange(t[0], t[-1], 1.0 / sensors.rate)
    late = sum(float(law.theta[0]) for law in laws if law.effect == 'force_delay')
    q, v, tau = (np.stack([np.interp(stamps - lag, t, column) for column in one.T], axis=1)
                 for one, lag in ((q, 0.0), (v, 0.0), (tau, late)))
    for law in laws:
        if law.effect == 'force_gain':
            tau[:, law.place] *= 1.0 + law.theta[0]
        elif law.effect == 'force_bias':
            tau[:, law.place] += law.theta[0]
    tau = tau + sensors.torque_noise * rng.normal(size=tau.shape)
    if sensors.position_step:
        q = sensors.position_step * np.round(q / sensors.position_step)
    return SimulatedArm(stamps, q, v, tau)
