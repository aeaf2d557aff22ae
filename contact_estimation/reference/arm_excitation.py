# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Motions of an arm by which the inertia of its links can be told."""

from dataclasses import dataclass
import json

import numpy as np

from ..kinematics.arm_dynamics import ArmDynamics
from ..physics.numeric import Array

_PERIOD_S, _RAMP_S, _FREE_S = 6.0, 1.0, 1.5
_TONES, _LOWEST_HZ, _HIGHEST_HZ = 6, 0.4, 4.0
_ASIDE_M, _ASIDE_HZ = 0.06, 0.17
_DAMPED = 1e-3  # singular values left out, in the largest


def pressing_motion(
    arm: ArmDynamics, frame: str, q: Array, normal: Array, rng: np.random.Generator,
    depth: float = 0.05, excitation: float = 0.012, duration: float = 24.0, rate: float = 200.0,
) -> 'ArmTrajectory':
    """
    Return a motion that presses several times, with tones, and moves aside along the wall.

    It begins at q (n,) and goes `depth` [m] along the normal (3,), with tones of size `excitation`
    [m]; the link that presses does not turn.
    """
    t = np.arange(0.0, duration, 1.0 / rate)
    within = t % _PERIOD_S
    s = np.clip(np.minimum((within - _FREE_S) / _RAMP_S, (_PERIOD_S - within) / _RAMP_S), 0.0, 1.0)
    pressing = s * s * (3.0 - 2.0 * s)
    tones, phases = rng.uniform(_LOWEST_HZ, _HIGHEST_HZ, _TONES), rng.uniform(0.0, 6.0, _TONES)
    wave = np.sum([np.sin(2.0 * np.pi * f * t + phase) / np.sqrt(f)
                   for f, phase in zip(tones, phases)], axis=0)
    aside = np.eye(3)[int(np.argmin(np.abs(normal)))]
    path = np.outer(pressing * (depth + excitation * wave / np.abs(wave).max()), normal)
    path += np.outer(_ASIDE_M * np.sin(2.0 * np.pi * _ASIDE_HZ * t), aside)
    followed = [np.asarray(q, float)]
    for step in np.diff(path, axis=0):
        here = followed[-1]
        twist = np.concatenate([arm.pose(here, frame)[0].T @ step, np.zeros(3)])
        followed.append(here + np.linalg.pinv(arm.jacobian(here[None], frame)[0], _DAMPED) @ twist)
    v = np.gradient(np.array(followed), t, axis=0)
    return ArmTrajectory(t, np.array(followed), v, np.gradient(v, t, axis=0), np.nan)


_HARMONICS = 5
_OF_LIMIT = 0.8  # of positions, speeds and efforts
_TURN, _SPEED = 2.0, 1.5  # [rad], [rad/s] where a description has no limit
_BLEND_S = 1.0  # from rest, and to it
_SHOWN = 60  # samples of a motion for its condition
_SINGULAR = 1e-6  # of the largest singular value: parameters that no motion tells


@dataclass(frozen=True)
class ArmTrajectory:
    """A motion of an arm with n joints."""

    t: Array  # (N,) times [s]
    # q, v, a (N, n): positions, velocities, accelerations [rad], [rad/s], [rad/s^2]
    q: Array
    v: Array
    a: Array
    condition: float  # of the regressor of the links' parameters

    def as_csv(self, arm: ArmDynamics) -> str:
        """Return a table: time, then position, velocity and acceleration of each joint."""
        names = [f'{kind}.{name}' for kind in ('position', 'velocity', 'acceleration')
                 for name in arm.joints]
        rows = np.column_stack([self.t, self.q, self.v, self.a])
        return '\n'.join([','.join(['t', *names]), *(
            ','.join(f'{value:.6g}' for value in row) for row in rows)]) + '\n'

    def as_message(self, arm: ArmDynamics) -> str:
        """Return a trajectory_msgs/msg/JointTrajectory as YAML, as `ros2 topic pub` takes it."""
        stamps = [divmod(round(1e9 * t), 1_000_000_000) for t in self.t.tolist()]
        rows = [np.round(one, 9).tolist() for one in (self.q, self.v, self.a)]
        return '\n'.join([
            f'joint_names: {json.dumps(arm.joints)}', 'points:',
            *(f'- {{positions: {q}, velocities: {v}, accelerations: {a}, '
              f'time_from_start: {{sec: {sec}, nanosec: {ns}}}}}'
              for q, v, a, (sec, ns) in zip(*rows, stamps))]) + '\n'


def exciting_trajectory(
    arm: ArmDynamics, seed: int = 0, duration: float = 20.0, rate: float = 100.0, tries: int = 50,
) -> 'ArmTrajectory':
    """
    Return the best conditioned of some random motions within the limits of a description.

    Finite Fourier series (Swevers, Ganseman, Tukel, De Schutter and Van Brussel, IEEE Trans.
    Robotics and Automation 13(5), 1997), from rest to rest. Collisions are not checked.
    """
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, duration, 1.0 / rate)
    drawn = [_drawn(arm, t, rng) for _ in range(tries)]
    scores = [_condition(arm, *motion) for motion in drawn]
    best = int(np.argmin(scores))
    return ArmTrajectory(t, *drawn[best], scores[best])


def _drawn(arm: ArmDynamics, t: Array, rng: np.random.Generator) -> tuple[Array, Array, Array]:
    """Draw a motion: harmonics of a tenth of a hertz, as large as the limits allow."""
    limits, n = arm.limits, len(arm.joints)
    free = ~np.isfinite(limits['position']).all(axis=0)
    low, high = np.where(free, [[-_TURN], [_TURN]], limits['position'])
    middle = 0.5 * (low + high)
    reach = _OF_LIMIT * np.minimum(0.5 * (high - low), 2.0 * _TURN)
    speed = _OF_LIMIT * np.minimum(limits['velocity'], _SPEED)
    x = np.zeros((len(t), n))
    for k in range(1, _HARMONICS + 1):
        size, phase = rng.normal(size=n) / k, rng.uniform(0.0, 2.0 * np.pi, n)
        x += size * np.sin(2.0 * np.pi * 0.1 * k * t[:, None] + phase)
    s = np.clip(np.minimum(t, t[-1] - t) / _BLEND_S, 0.0, 1.0)[:, None]
    x = x * s**3 * (10.0 - 15.0 * s + 6.0 * s**2)
    v = np.gradient(x, t, axis=0)
    scale = np.minimum(reach / np.abs(x).max(axis=0), speed / np.abs(v).max(axis=0))
    x, v = x * scale, v * scale
    a = np.gradient(v, t, axis=0)
    rows = slice(None, None, max(1, len(t) // _SHOWN))
    effort = np.abs(arm.torque(middle + x[rows], v[rows], a[rows])).max(axis=0)
    still = np.abs(arm.torque(middle + x[rows], 0.0 * v[rows], 0.0 * a[rows])).max(axis=0)
    # Slower where the drives are too weak: inertial torques fall with the square of the speed.
    room = np.maximum(_OF_LIMIT * limits['effort'] - still, 0.0)
    slower = float(np.sqrt(np.min(np.clip(room / np.maximum(effort - still, 1e-9), 0.04, 1.0))))
    if slower < 1.0:
        inner = slower * t
        x, v, a = (np.stack([np.interp(inner, t, column) for column in one.T], 1) * slower**k
                   for k, one in enumerate((x, v, a)))
    return middle + x, v, a


def _condition(arm: ArmDynamics, q: Array, v: Array, a: Array) -> float:
    """Return the condition of the regressor, over the parameters that a motion can tell."""
    rows = slice(None, None, max(1, len(q) // _SHOWN))
    Y = arm.regressor(q[rows], v[rows], a[rows])
    Y = Y.reshape(-1, Y.shape[2]) / (np.abs(Y).max(axis=(0, 1)) + 1e-12)
    singular = np.linalg.svd(Y, compute_uv=False)
    return float(singular[0] / singular[singular > _SINGULAR * singular[0]][-1])
