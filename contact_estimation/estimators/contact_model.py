# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Equations of the environment as pure functions of scalars or arrays."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..exceptions import ParameterRangeError, SignalShapeError


def kelvin_voigt_force(
    delta: ArrayLike, delta_dot: ArrayLike, K_e: float, B_e: float
) -> NDArray[np.float64]:
    """
    Compute the force of a unilateral spring-damper environment on the tool.

    Eq. (3): F_e = -(K_e delta + B_e delta_dot) in contact (delta > 0), at most 0; else 0.
    The wall cannot pull, so the force is already 0 while withdrawing with delta > 0.

    delta (N,): penetration [m], positive in contact
    delta_dot (N,): penetration rate [m/s]
    K_e: stiffness [N/m], > 0
    B_e: damping [N s/m], >= 0
    Returns F_e (N,): force on the end-effector [N], negative while pressing
    """
    delta, delta_dot = np.asarray(delta, float), np.asarray(delta_dot, float)
    if delta.shape != delta_dot.shape:
        raise SignalShapeError(
            f'delta and delta_dot must have one shape, got {delta.shape} and {delta_dot.shape}'
        )
    if not K_e > 0.0:
        raise ParameterRangeError(f'K_e must be > 0 N/m, got {K_e!r}')
    if not B_e >= 0.0:
        raise ParameterRangeError(f'B_e must be >= 0 N s/m, got {B_e!r}')
    return np.where(delta > 0.0, np.minimum(0.0, -(K_e * delta + B_e * delta_dot)), 0.0)
