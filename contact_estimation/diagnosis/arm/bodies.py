# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
What bodies can be: mass, moments and inertia of a density that is nowhere negative.

P. M. Wensing, S. Kim and J.-J. E. Slotine, Linear matrix inequalities for physically consistent
inertial parameter identification, IEEE RA-L 3(1), 2018: the pseudo-inertia is positive definite.
"""

from functools import lru_cache

import numpy as np

from .arm_recording import Array
from ...kinematics.arm_dynamics import PER_LINK
from ...kinematics.robot_model import pinocchio

_LEAST = 1e-9  # eigenvalue of a pseudo-inertia that counts as positive
_ROUND = np.array([1.0, 0.0, 0.0, 0.0, 2.0, 0.0, 2.0, 0.0, 0.0, 2.0])
_WIDER = 1e-2  # precision of a prior that tells little, in that of the prior of a load
_PLANES = 12  # of the cone of bodies, onto which a load is projected
_SETTLED = 0.01  # nats of a step that changes no decision


@lru_cache(maxsize=None)
def _each() -> Array:
    """Return the pseudo-inertia per unit of each parameter, (10, 4, 4)."""
    of = pinocchio().PseudoInertia.FromDynamicParameters
    return np.array([of(one).toMatrix() for one in np.eye(PER_LINK)])


def _pseudo(theta: Array) -> Array:
    return np.asarray(np.tensordot(theta, _each(), 1))


def is_body(theta: Array) -> bool:
    """Return whether a body can have ten parameters: its pseudo-inertia is positive definite."""
    return bool(np.linalg.eigvalsh(_pseudo(theta)).min() > _LEAST)


def cost_of_body(x: Array, spread: Array, sizes: Array, link: Array) -> float:
    """
    Return what data lose if a load leaves a body of a link [nat].

    x (10,), spread (10, 10): load in `sizes` (10,), which are its prior, and covariance of the
    fit. Data alone count: what they do not tell costs nothing. link (10,): of the description.
    """
    if is_body(link + sizes * x):
        return 0.0
    values, vectors = np.linalg.eigh(_pseudo(link))
    whole = (vectors * np.maximum(values, 0.0)) @ vectors.T  # some descriptions have no body
    both: Array = np.asarray(np.linalg.inv(spread), float)
    S: Array = np.asarray(np.linalg.inv(both - (1.0 - _WIDER) * np.eye(PER_LINK)), float)
    start = S @ both @ x
    y = _projected(start, S, whole, sizes)
    return float(0.5 * (y - start) @ np.linalg.solve(S, y - start))


def _projected(start: Array, S: Array, whole: Array, sizes: Array) -> Array:
    """Return the nearest load with which a pseudo-inertia `whole` is a body; S: covariance."""
    y, each = start, sizes[:, None, None] * _each()
    for _ in range(_PLANES):
        values, vectors = np.linalg.eigh(whole + np.tensordot(y, each, 1))
        if values[0] >= 0.0:
            break
        normal = vectors[:, 0] @ each @ vectors[:, 0]
        size = normal @ S @ normal
        y = y - S @ normal * (values[0] / size)
        if values[0] ** 2 < 2.0 * _SETTLED * size:
            break
    return np.asarray(y)


def possible_inertial(theta: Array, covariance: Array) -> Array:
    """Return the likeliest parameters (10,) of a body, or of a negative one for a lack."""
    sign = 1.0 if theta[0] >= 0.0 else -1.0
    body = _projected(sign * theta, covariance, np.zeros((4, 4)), np.ones(PER_LINK))
    short = np.linalg.eigvalsh(_pseudo(body))[0]
    # What is short of a body by less than data tell: _ROUND has the unit matrix.
    return np.asarray(sign * (body + max(_LEAST - short, 0.0) * _ROUND))
