# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""On-line estimation of K_e, B_e and friction from the force vector of several contact points."""

from dataclasses import dataclass
from math import sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .contact_points import (
    Array, ContactGeometry, force_regressor, frictionless_directions, point_motions, PointMotions,
    ToolMotion)
from .estimate import EstimateStatus
from ..exceptions import SignalShapeError
from ..parameters import parameter, ParameterGroup


@dataclass(frozen=True)
class ContactPointsParameters(ParameterGroup):
    """Prior, noise and memory of the estimation from several contact points."""

    initial_stiffness: float = parameter(3000.0, 'First guess of K_e', 'N/m', minimum=1e-3)
    initial_damping: float = parameter(50.0, 'First guess of B_e', 'N s/m', minimum=0.0)
    initial_friction: float = parameter(
        0.0, 'First guess of mu; the known mu where friction_std is 0', minimum=0.0, maximum=10.0)
    stiffness_std: float = parameter(
        1e5, 'Prior standard deviation of K_e', 'N/m', minimum=1e-3, maximum=1e12)
    damping_std: float = parameter(
        1e4, 'Prior standard deviation of B_e', 'N s/m', minimum=1e-3, maximum=1e12)
    friction_std: float = parameter(
        1.0, 'Prior standard deviation of mu; 0: known, not estimated', minimum=0.0, maximum=1e3)
    forgetting_factor: float = parameter(
        0.999, 'Forgetting factor lambda per sample in contact; closer to 1: smoother, slower',
        minimum=0.5, maximum=1.0)
    force_noise: float = parameter(
        0.6, 'Standard deviation of each force component', 'N', minimum=1e-9, maximum=1e6)
    position_noise: float = parameter(
        1e-5, 'Standard deviation of the position of a point; samples with a point closer to its '
        'surface are not used', 'm', minimum=0.0)
    sliding_speed: float = parameter(
        2e-3, 'Below this speed a point counts as sticking, and force directions that its '
        'friction may affect are not used; choose it well above the velocity noise', 'm/s',
        minimum=0.0)
    maximum_relative_std: float = parameter(
        0.2, 'K_hat and B_hat are updated only while their relative standard deviation is lower',
        minimum=1e-4)


_STEPS = 2  # Gauss-Newton steps per sample, starting from the last result
_SURE = 3.0  # standard deviations
_UNSURE = 'a point may touch or not'
_STICKING = 'points stick: their friction is unknown'


class ContactPointsSample(NamedTuple):
    """Force and motion at one instant."""

    stamp_ns: int  # header stamp of the wrench [ns]
    force: Array  # (3,) measured F_e on the tool [N]
    motion: ToolMotion  # pose and twist, in the frame of the force


class ContactPointsEstimate(NamedTuple):
    """Estimate after one sample."""

    stamp_ns: int  # stamp of the sample [ns]
    # stiffness, damping, friction: K_hat [N/m], B_hat [N s/m] and mu_hat
    stiffness: float
    damping: float
    friction: float
    # stiffness_std, damping_std, friction_std: their standard deviations; 0 for a friction that is
    # known
    stiffness_std: float
    damping_std: float
    friction_std: float
    touching: tuple[bool, ...]  # points that are known to press
    status: EstimateStatus  # free, estimating or frozen
    reason: str  # why parameters are frozen, else ''


class ContactPointsEstimator:
    """
    Recursive least squares on eq. (6), three rows per sample.

    The force is linear in (K_e, B_e, mu K_e, mu B_e). Their information Lambda = P^-1 is
    updated as in eqs. (36) to (38), written for P^-1, which does not wind up while nothing
    slides. The three parameters are the best point on theta = (K, B, mu K, mu B), found by
    Gauss-Newton steps: least squares over all samples.

    Which points press follows from geometry: a point that penetrates and moves deeper presses
    for any K_e and B_e; a withdrawing point presses if K_hat delta + B_hat deltadot exceeds its
    uncertainty. Samples with an undecided point are not used.

    The friction of a sticking point does not follow from its motion: the direction of a measured
    velocity near 0 is noise and biases mu and K_hat towards 0. Only rows that friction of
    sticking points cannot affect are used.
    """

    def __init__(
        self, geometry: ContactGeometry, parameters: ContactPointsParameters | None = None
    ) -> None:
        self.geometry = geometry
        self.parameters = parameters or ContactPointsParameters()
        self.reset()

    def reset(self) -> None:
        """Restart from the first guess."""
        p = self.parameters
        self._prior = np.array([p.initial_stiffness, p.initial_damping, p.initial_friction])
        spread = np.array([p.stiffness_std, p.damping_std, p.friction_std or 1.0])
        self._free = np.array([True, True, p.friction_std > 0.0])
        self._prior_information = np.diag(spread**-2.0)
        self._covariance = np.diag(np.where(self._free, spread, 0.0) ** 2)
        self._theta = self._prior.copy()
        self._information, self._squared = np.zeros((4, 4)), np.zeros((4, 4))
        self._projected_force = np.zeros(4)
        self._stiffness, self._damping = p.initial_stiffness, p.initial_damping
        self._reason = 'weak excitation'

    def update(self, sample: ContactPointsSample) -> ContactPointsEstimate:
        """Process one sample."""
        force = np.asarray(sample.force, float)
        if force.shape != (3,):
            raise SignalShapeError(f'force must have shape (3,), got {force.shape}')
        motions = point_motions(self.geometry, sample.motion)
        touching, unsure = self._judge(motions)
        if unsure.any():
            return self._estimate(sample, touching, EstimateStatus.FROZEN, _UNSURE)
        if not touching.any():
            return self._estimate(sample, touching, EstimateStatus.FREE, '')
        rows = self._rows(motions, touching)
        if not len(rows):
            return self._estimate(sample, touching, EstimateStatus.FROZEN, _STICKING)
        Phi = force_regressor(self.geometry, motions, touching)
        self._learn(rows @ Phi, rows @ force)
        held = self._reason == 'weak excitation'
        status = EstimateStatus.FROZEN if held else EstimateStatus.ESTIMATING
        return self._estimate(sample, touching, status, self._reason)

    def _judge(self, motions: PointMotions) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
        """Return which points press, and for which this is undecided."""
        delta, rate = motions.delta, motions.delta_dot
        margin = _SURE * self.parameters.position_noise
        K, B, _ = self._theta
        KK, KB, BB = self._covariance[0, 0], self._covariance[0, 1], self._covariance[1, 1]
        spread = np.sqrt(np.maximum(KK * delta**2 + 2.0 * KB * delta * rate + BB * rate**2, 0.0))
        pressing = K * delta + B * rate  # (N,) [N]
        sure = _SURE * spread + K * margin
        presses = (delta > margin) & ((rate >= 0.0) | (pressing > sure))
        let_go = (rate < 0.0) & (pressing < -sure)
        return presses, ~presses & ~let_go & (delta > -margin)

    def _rows(self, motions: PointMotions, touching: NDArray[np.bool_]) -> Array:
        """Return the directions in which the force follows from the motion."""
        if not self._free[2] and self._prior[2] == 0.0:
            return np.eye(3)  # no friction
        sticks = np.linalg.norm(motions.slip, axis=1) < self.parameters.sliding_speed
        return frictionless_directions(self.geometry, touching & sticks)

    def _learn(self, Phi: Array, force: Array) -> None:
        """Add up to three rows to the information and update the parameters."""
        p = self.parameters
        gain, forget = Phi.T / p.force_noise**2, p.forgetting_factor
        rows = gain @ Phi  # (4, 4)
        self._information = forget * self._information + rows
        self._squared = forget**2 * self._squared + rows  # for the noise, weighted by lambda^2
        self._projected_force = forget * self._projected_force + gain @ force
        for _ in range(_STEPS):
            self._theta = self._step(self._theta)
        self._covariance = self._spread(self._theta)
        self._hold()

    def _step(self, theta: Array) -> Array:
        """Return the minimum of the linearised problem within the limits."""
        free, low = self._free.copy(), np.array([1e-3, 0.0, 0.0])
        for _ in theta:
            J = _jacobian(theta)
            residual = self._projected_force - self._information @ _products(theta)
            slope = J.T @ residual + self._prior_information @ (self._prior - theta)
            curvature = J.T @ self._information @ J + self._prior_information
            moved = theta.copy()
            moved[free] += np.linalg.solve(curvature[np.ix_(free, free)], slope[free])
            outside = free & (moved < low)
            if not outside.any():
                return moved
            theta = np.where(outside, low, theta)
            free &= ~outside
        return theta

    def _spread(self, theta: Array) -> Array:
        """Return the covariance; with forgetting, a sandwich of weights and squared weights."""
        J, free = _jacobian(theta), np.ix_(self._free, self._free)
        weighted = (J.T @ self._information @ J + self._prior_information)[free]
        squared = (J.T @ self._squared @ J + self._prior_information)[free]
        inverse = np.linalg.inv(weighted)
        covariance = np.zeros((3, 3))
        covariance[free] = inverse @ squared @ inverse
        return covariance

    def _hold(self) -> None:
        """Publish the parameters whose standard deviation is small enough."""
        limit = self.parameters.maximum_relative_std
        K, B, _ = self._theta
        known_K = sqrt(self._covariance[0, 0]) <= limit * K
        known_B = sqrt(self._covariance[1, 1]) <= limit * B
        if known_K:
            self._stiffness = float(K)
        if known_B:
            self._damping = float(B)
        self._reason = {
            (True, True): '', (True, False): 'damping frozen: weak excitation',
            (False, True): 'stiffness frozen: weak excitation', (False, False): 'weak excitation',
        }[known_K, known_B]

    def _estimate(
        self, sample: ContactPointsSample, touching: NDArray[np.bool_], status: EstimateStatus,
        reason: str,
    ) -> ContactPointsEstimate:
        K_std, B_std, mu_std = np.sqrt(np.maximum(np.diag(self._covariance), 0.0)).tolist()
        return ContactPointsEstimate(
            sample.stamp_ns, self._stiffness, self._damping, float(self._theta[2]), K_std, B_std,
            mu_std, tuple(touching.tolist()), status, reason)


def _products(theta: Array) -> Array:
    """Return the four parameters in which the force is linear."""
    K, B, mu = theta
    return np.array([K, B, mu * K, mu * B])


def _jacobian(theta: Array) -> Array:
    """Return the Jacobian of `_products`, shape (4, 3)."""
    K, B, mu = theta
    return np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [mu, 0.0, K], [0.0, mu, B]])
