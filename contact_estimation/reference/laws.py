# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
The laws that convert a desired force into a reference position.

Eq. (20) alone does not make F_e follow F_r: under eq. (1) the static force is
F_r K_t K_e / (K_hat (K_t + K_e)). Either the robot adds F_r to its control force (force
tracking), or the reference is deeper by F_r / K_t (`series`); both together result in too large a
force and are refused.
"""

from __future__ import annotations

from typing import Callable

Compliance = Callable[[float, float], float]


def eq20_compliance(K_hat: float, K_t: float) -> float:
    """
    Eq. (20): x_r = x_e + F_r / K_hat.

    K_hat: estimated stiffness of the environment [N/m], > 0
    K_t: target stiffness of the robot [N/m]; not used
    Returns compliance: (x_r - x_e) / F_r [m/N]
    """
    return 1.0 / K_hat


def series_compliance(K_hat: float, K_t: float) -> float:
    """
    Springs in series: x_r = x_e + F_r (1 / K_hat + 1 / K_t).

    K_hat, K_t: stiffness of environment and robot [N/m], > 0
    Returns compliance: (x_r - x_e) / F_r [m/N]
    """
    return 1.0 / K_hat + 1.0 / K_t


LAWS: dict[str, Compliance | None] = {
    'eq20': eq20_compliance,
    'series': series_compliance,
    'pass_through': None,
}
"""Compliance by name of the law; None: x_d passes through, whatever F_r is."""
