# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
Mass, centre of gravity and biases of a tool from wrenches in free flight.

Blocks of 0.1 s are the data. Those of fast motion, where the kinematics and their clock matter
more than the weight, are left out beforehand, those that no tool's weight explains (contact) by a
robust fit. Errors within a pose are correlated (noise of the joints, hysteresis, creep), so the
blocks of one pose count as one datum: the standard deviations come from the differences between
poses, widened where the residuals of successive poses are correlated (drift).

"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from .tool_load import Array, ToolParameters
from ..exceptions import EstimationError

_OUTLIER = 6.0  # robust standard deviations
_MOST_OUTLIERS = 0.35  # of the blocks: beyond, the robust fit itself cannot be trusted
_SAME_POSE = np.cos(np.radians(10.0))
_BLOCKS_OF_POSE = 3  # at least
_SETTLED = 5.0  # blocks, beyond which a longer pose adds little information
_MOST_MISFIT = 0.2  # of the variation of the forces
_TORQUE_ARM = 0.1  # ratio of torque to force errors at the start of the fit [m]
_ROUNDS = 30
_LEAST_MASS = 2.0  # standard deviations
_LEAST_SPREAD = 0.15  # standard deviation of gravity's direction: about 9 degrees


class CalibrationBlocks(NamedTuple):
    """Mean wrenches and regressors of blocks of a recording, in the order of time."""

    f: Array  # (N, 3) weight per mass less the acceleration, in the sensor's frame [m/s^2]
    Phi: Array  # (N, 6, 10) as of `load_regressor`
    wrench: Array  # (N, 6) mean force [N] and torque [N m]
    slow: np.ndarray  # (N,) whether the motion is slow enough


@dataclass(frozen=True)
class ToolCalibration:
    """A tool with its uncertainty."""

    tool: ToolParameters  # mass, centre and biases
    mass_std: float  # standard deviation of the mass [kg]
    # centre_std, force_bias_std, torque_bias_std (3,): standard deviations [m], [N], [N m]
    centre_std: Array
    force_bias_std: Array
    torque_bias_std: Array
    # force_rms, torque_rms: residuals between poses [N], [N m]
    force_rms: float
    torque_rms: float
    poses: int  # number of poses used
    # blocks, fast, contact: number of blocks in all, and of those left out for fast motion or
    # contact
    blocks: int
    fast: int
    contact: int


def calibrate_tool(blocks: CalibrationBlocks, force_sign: float = 1.0) -> ToolCalibration:
    """Fit mass, centre of gravity and biases."""
    slow = np.flatnonzero(blocks.slow)
    if len(slow) < 4 * _BLOCKS_OF_POSE:
        raise EstimationError(
            f'the arm rests or moves slowly in {len(slow) * 0.1:.1f} s of '
            f'{len(blocks.slow) * 0.1:.1f} s; record at least 12 poses, each held for 2 s')
    require_directions(blocks.f[slow])
    theta, sigma = _robust_fit(blocks.Phi[slow], blocks.wrench[slow])
    errors = _size(blocks.wrench[slow] - blocks.Phi[slow] @ theta, sigma)
    free = slow[errors < _OUTLIER]
    _require_free_flight(len(free), len(slow))
    poses = _poses(blocks.f, free)
    if len(poses) < 4:
        raise EstimationError(
            f'the free flight of the recording has {len(poses)} poses of 0.3 s or more, expected '
            'at least 4, better 12; hold each pose for 2 s')
    require_directions(np.array([blocks.f[pose].mean(axis=0) for pose in poses]))
    theta, P, rms = _fit_between_poses(blocks, poses)
    _require_tool(blocks.wrench[free], theta, rms, force_sign)
    m, c = theta[0], theta[1:4] / theta[0]
    J = np.column_stack([-c / m, np.eye(3) / m])  # of c = m c / m
    std = np.sqrt(np.diag(P))
    return ToolCalibration(
        ToolParameters(float(m), *(tuple(part.tolist()) for part in (c, theta[4:7], theta[7:]))),
        float(std[0]), np.sqrt(np.diag(J @ P[:4, :4] @ J.T)), std[4:7], std[7:], *rms,
        len(poses), len(blocks.slow), len(blocks.slow) - len(slow), len(slow) - len(free))


def _robust_fit(Phi: Array, wrench: Array) -> tuple[Array, Array]:
    """Minimise the sum of the error's sizes, and not of their squares."""
    sigma = np.array([1.0, _TORQUE_ARM])
    weight = np.ones(len(Phi))
    for _ in range(_ROUNDS):
        theta = _weighted(Phi, wrench, sigma, weight)[0]
        errors = wrench - Phi @ theta
        # The scale of one component, from the median of its magnitude; noise-free data have one.
        halves = errors.reshape(-1, 2, 3)
        sigma = np.maximum(1.4826 * np.median(np.abs(halves), axis=(0, 2)), [1e-6, 1e-7])
        weight = 1.0 / np.maximum(_size(errors, sigma), 1.0)
    return theta, sigma


def _size(errors: Array, sigma: Array) -> Array:
    """Return the larger of the errors of force and torque, in standard deviations, (N,)."""
    halves = np.linalg.norm(errors.reshape(-1, 2, 3), axis=2) / sigma / np.sqrt(3.0)
    return np.asarray(halves.max(axis=1))


def _weighted(Phi: Array, wrench: Array, sigma: Array, weight: Array) -> tuple[Array, Array]:
    """Return weighted least squares and the inverse of its normal matrix."""
    scale = np.sqrt(weight)[:, None] / np.repeat(sigma, 3)  # (N, 6)
    A = (Phi * scale[..., None]).reshape(-1, Phi.shape[-1])
    Q, T = np.linalg.qr(A)
    inverse = np.linalg.inv(T)
    return inverse @ (Q.T @ (wrench * scale).ravel()), inverse @ inverse.T


def _poses(f: Array, free: np.ndarray) -> list[np.ndarray]:
    """Cut the blocks of free flight where they are interrupted or the gravity has turned."""
    directions = f / np.linalg.norm(f, axis=1, keepdims=True)
    poses: list[list[int]] = []
    for block in free:
        follows = bool(poses) and poses[-1][-1] == block - 1
        if follows and directions[poses[-1][0]] @ directions[block] > _SAME_POSE:
            poses[-1].append(block)
        else:
            poses.append([block])
    return [np.array(pose) for pose in poses if len(pose) >= _BLOCKS_OF_POSE]


def _fit_between_poses(
    blocks: CalibrationBlocks, poses: list[np.ndarray]
) -> tuple[Array, Array, tuple[float, float]]:
    """Return the fit to one datum a pose, its covariance and the residuals' rms."""
    Phi = np.array([blocks.Phi[pose].mean(axis=0) for pose in poses])
    wrench = np.array([blocks.wrench[pose].mean(axis=0) for pose in poses])
    counts = np.array([len(pose) for pose in poses], float)
    weight = (1.0 + _SETTLED / counts.max()) / (1.0 + _SETTLED / counts)
    sigma = np.array([1.0, _TORQUE_ARM])
    # Four unknowns enter the forces and six the torques.
    freedom = np.array([3.0 * len(poses) - 4.0, 3.0 * len(poses) - 6.0])
    for _ in range(_ROUNDS):
        theta, P = _weighted(Phi, wrench, sigma, weight)
        halves = (wrench - Phi @ theta).reshape(-1, 2, 3)
        squares = np.einsum('g,gij->i', weight, halves**2)
        sigma = np.maximum(np.sqrt(squares / freedom), [1e-9, 1e-10])
    rho = _correlation(halves * np.sqrt(weight)[:, None, None] / sigma[:, None])
    P = P * (1.0 + rho) / (1.0 - rho)
    _require_weight(float(theta[0]), float(np.sqrt(P[0, 0])))
    return theta, P, (float(sigma[0]), float(sigma[1]))


def _require_weight(m: float, std: float) -> None:
    if abs(m) <= _LEAST_MASS * std:
        raise EstimationError(
            f'the mass is {m:.2g} +- {std:.2g} kg, so the sensor carries no tool, or no weight '
            'explains the forces; mount the tool, or leave tool.* out without one, and check '
            'that both topics are of the same arm')


def _correlation(residuals: Array) -> float:
    """Return the correlation of successive poses, 0 where it is negative, at most 0.9."""
    power = float(np.sum(residuals**2))
    lagged = float(np.sum(residuals[1:] * residuals[:-1]))
    return min(max(lagged / power, 0.0), 0.9) if power > 0.0 else 0.0


def _require_free_flight(free: int, slow: int) -> None:
    if slow - free > _MOST_OUTLIERS * slow:
        raise EstimationError(
            f'in {100 * (slow - free) / slow:.0f} % of the recording the wrench is not that of a '
            'tool alone: record free flight, without contact and with no cable pulling, and check '
            'that the wrench is expressed in force_sensor.frame')


def _require_tool(
    wrench: Array, theta: Array, rms: tuple[float, float], force_sign: float
) -> None:
    variation = float(np.linalg.norm(np.std(wrench[:, :3], axis=0)))
    if rms[0] > _MOST_MISFIT * variation:
        raise EstimationError(
            f'no weight explains the forces: they vary by {variation:.3g} N and a tool leaves '
            f'{rms[0]:.3g} N; check force_sensor.frame, the unit of the joints [rad] and that '
            'both topics are of the same arm')
    if theta[0] <= 0.0:
        raise EstimationError(
            f'the mass is {theta[0]:.3g} kg, so the weight pulls up: change the sign of '
            f'force_sign (now {force_sign:g}), or turn force_sensor.frame, and calibrate again')


def require_directions(f: Array) -> None:
    """
    Require that gravity has turned about two axes of the sensor.

    The force separates the mass from its bias where gravity's direction d varies at all; the
    torque m c x d separates the centre along u from the torque's bias where d varies across u.
    So the variation must span two directions.

    f (N, 3): weight per mass in the sensor's frame [m/s^2]
    """
    directions = f / np.linalg.norm(f, axis=1, keepdims=True)
    mean = directions.mean(axis=0)
    _, spreads, axes = np.linalg.svd((directions - mean) / np.sqrt(len(f)), full_matrices=False)
    if spreads[1] >= _LEAST_SPREAD:
        return
    one_turn = spreads[0] >= _LEAST_SPREAD
    # Else the two axes that are most nearly perpendicular to the mean.
    missing = axes[2:] if one_turn else np.eye(3)[np.argsort(np.abs(mean))[:2]]
    undetermined = 'the centre of gravity' if one_turn else 'mass and centre of gravity'
    varies = f'varies only along {_text(axes[0])}' if one_turn else 'hardly varies'
    named = ' and '.join(dict.fromkeys(_text(each) for each in missing))
    raise EstimationError(
        f"gravity in the sensor's frame {varies} (mean direction {_text(mean, sign=True)}), which "
        f'does not determine {undetermined}; add poses in which gravity points along {named} of '
        'the sensor, either way: tilt the tool by 60 degrees or more towards each')


def _text(direction: Array, sign: bool = False) -> str:
    """Write a direction by the axis nearest to it, or by its components."""
    unit = direction / max(float(np.linalg.norm(direction)), 1e-12)
    main = int(np.argmax(np.abs(unit)))
    if abs(unit[main]) > 0.95:
        return ('-' if sign and unit[main] < 0.0 else '') + 'xyz'[main]
    return '(' + ', '.join(f'{part:.2f}' for part in unit) + ')'
