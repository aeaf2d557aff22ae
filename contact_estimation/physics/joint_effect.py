# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Base class of the physics of an arm, and the motion along which it acts."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any, Callable, Mapping, Sequence

import numpy as np

from .numeric import Array
from ..kinematics.arm_dynamics import ArmDynamics, Outside

_STEP = 1e-6  # of finite differences [rad]

Place = Any
"""A joint, or the link that it moves: int; two joints and the sign of their sum; the arm: None."""


@dataclass(frozen=True)
class JointMotion:
    """Motion of an arm and what its description makes of it."""

    arm: ArmDynamics  # of the description, n joints
    # q, v, a: positions, velocities, accelerations [rad], [rad/s], [rad/s^2]
    q: Array
    v: Array
    a: Array
    load: Array  # what the drives must give, see `torque` [N m]
    # speed, middle: what each joint exceeds in 5 % of the time [rad/s], and its mean position
    # [rad]
    speed: Array
    middle: Array
    # the load within the band of the motion [N m]: what bends a joint is differentiated twice
    carried: Array
    period: float = 0.0  # between samples [s]
    outside: Outside | None = None  # measured contact

    @cached_property
    def felt(self) -> Array:
        """Return J(q)^T F, the torque of what acts on the arm, shape (N, n) [N m]."""
        return self.arm.torque_from(self.q, self.outside)

    @cached_property
    def regressor(self) -> Array:
        """Return Y of `ArmDynamics.regressor`, shape (N, n, 10 n)."""
        return self.arm.regressor(self.q, self.v, self.a)

    @cached_property
    def slopes(self) -> tuple[Array, Array, Array]:
        """Return the derivatives of the load by q, q' and q'', each of shape (N, n, n)."""
        by_q, by_v, by_a = self.arm.derivatives(self.q, self.v, self.a)
        if self.outside is not None:
            for j, step in enumerate(_STEP * np.eye(self.q.shape[1])):
                moved = self.arm.torque_from(self.q + step, self.outside)
                by_q[:, :, j] -= (moved - self.felt) / _STEP
        return by_q, by_v, by_a

    def rate(self, signal: Array) -> Array:
        """Return the time derivative of a signal, first axis time."""
        return np.asarray(np.gradient(signal, self.period, axis=0))

    def lagging(self, joint: int, shift: Array) -> Array:
        """Return the change of the load if a joint's link lags by a small angle, shape (N, n)."""
        rate = self.rate(shift)
        by_q, by_v, by_a = (slope[:, :, joint] for slope in self.slopes)
        return np.asarray(-(by_q.T * shift + by_v.T * rate + by_a.T * self.rate(rate)).T)


@dataclass(frozen=True)
class JointEffect:
    """
    Physics that adds to the torques of an arm: tau = RNEA(q, q', q'') + sum theta_k columns_k.

    Attributes
    ----------
    name, family, equation : str
        As of `Effect`.
    coefficients : tuple of (str, str)
        Symbol and unit of each theta_k; rad stands for m where a joint slides.
    law : callable
        Of motion, place and shape: the K columns of the joint itself, each of shape (N,) [N m]
        per unit; or, of what shows in several joints, columns (N, K) by joint.
    place : str
        Where it acts: 'joint', 'link', 'pair' of neighbouring joints or 'arm'.
    group : str
        Of laws of which a place has one at most; the family by default.
    shape : tuple of (str, str), optional
        Symbol and unit of a value in which the law is not linear, if it has one.
    shapes : callable
        Of motion and place: the values of `shape` that are compared.
    typical : callable, optional
        Of motion and place: standard deviations of the coefficients before any data, shape (K,);
        any size up to twice the variation of the joint's torque by default.
    possible : callable
        Whether coefficients (K,) are physically possible.
    laws : int
        Number of laws that it adds to plain friction, which every joint has.
    is_curve : bool
        Whether it is a curve that follows almost any slow misfit of a joint.
    needs_wrench : bool
        Whether it is of a sensor of force and torque.

    """

    name: str
    family: str
    equation: str
    coefficients: tuple[tuple[str, str], ...]
    law: Callable[[JointMotion, Place, Any], Sequence[Array] | Mapping[int, Array]]
    place: str = 'joint'
    group: str = ''
    shape: tuple[str, str] | None = None
    shapes: Callable[[JointMotion, Place], tuple[float, ...]] = lambda motion, place: (0.0,)
    typical: Callable[[JointMotion, Place], Array] | None = None
    possible: Callable[[Array], bool] = lambda theta: True
    laws: int = 1
    is_curve: bool = False
    needs_wrench: bool = False

    def columns(self, motion: JointMotion, place: Place, shape: Any = 0.0) -> dict[int, Array]:
        """
        Return the torque per unit of each coefficient, (N, K) [N m], by joint where it is not 0.

        The place is of the kind `self.place`; shape: value in which the law is not linear.
        """
        found = self.law(motion, place, shape)
        if isinstance(found, Mapping):
            return dict(found)
        return {place: np.stack(found, axis=1)}


def positive(theta: Array) -> bool:
    """Return whether no coefficient is negative, as of what only dissipates or stores energy."""
    return bool((theta >= 0.0).all())
