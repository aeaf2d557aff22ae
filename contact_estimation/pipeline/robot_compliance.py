# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Compliance of the robot between its position sensors and the tool, in series with the wall."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import hypot
from typing import Any

from ..estimators.estimate import ParameterEstimate
from ..parameters.specification import parameter, ParameterGroup
from ..physics import effects_that_are_on
from ..physics.robot_effect import RobotEffect

_LEAST_SHARE = 0.02
"""Of the deflection that must be the wall's; below, K_e is too uncertain to be limited more."""


@dataclass(frozen=True)
class RobotParameters(ParameterGroup):
    """What of the robot the contact data cannot show."""

    compliance: float = parameter(
        0.0,
        'Deflection of robot, sensor and tool between position sensor and contact, per force; the '
        'estimates are of the wall alone then. 1 / 50 kN/m is 2e-5', 'm/N',
        minimum=0.0, maximum=1.0,
    )
    compliance_std: float = parameter(
        0.0,
        'Standard deviation of the compliance, which widens the deviations of K_hat and B_hat',
        'm/N', minimum=0.0, maximum=1.0,
    )


def with_joints(robot: RobotParameters, physics: Any) -> RobotParameters:
    """Add the compliance of joints that are known physics."""
    joints = [effect.joint(1.0) for effect in effects_that_are_on(physics)
              if isinstance(effect, RobotEffect)]
    yields = sum(joint.compliance for joint in joints if joint is not None)
    return replace(robot, compliance=robot.compliance + yields) if yields else robot


def of_the_wall(
    estimate: tuple[float, float, float, float, float, float], robot: RobotParameters
) -> ParameterEstimate:
    """
    Return the wall's part of what wall and robot in series appear as.

    A spring 1 / C in series with K_e + B_e s appears as K = K_e / (1 + C K_e) and
    B = B_e / (1 + C K_e)^2 at frequencies below those of both.

    estimate: the fields of a `ParameterEstimate` of the measured force and position
    robot: compliance C [m/N] and its standard deviation
    """
    K, B, K_std, B_std, shift, inertia = estimate
    C, C_std = robot.compliance, robot.compliance_std
    share = max(1.0 - C * K, _LEAST_SHARE)  # K / K_e
    K_e, B_e = K / share, B / share**2
    by_K = 2.0 * B_e * C / share  # dB_e / dK
    return ParameterEstimate(
        K_e, B_e, hypot(K_std / share**2, K_e * K_e * C_std),
        hypot(B_std / share**2, by_K * K_std, 2.0 * B_e * K_e * C_std), shift, inertia,
    )


def seen_by_the_robot(stiffness: float, robot: RobotParameters) -> float:
    """
    Return the stiffness of wall and robot in series, which relates measured position and force.

    stiffness: K_e of the wall alone [N/m]
    robot: compliance C [m/N]
    Returns stiffness: K_e / (1 + C K_e) [N/m]
    """
    return stiffness / (1.0 + robot.compliance * stiffness)
