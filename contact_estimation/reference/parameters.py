# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Parameters of the reference: conversion of forces into positions, and limits."""

from dataclasses import dataclass
from math import nan

from ..exceptions import ParameterRangeError
from ..parameters import group, parameter, ParameterGroup


@dataclass(frozen=True)
class PoseLimits(ParameterGroup):
    """Limits of ~/target_pose, beside those of x_r."""

    lead: float = parameter(
        0.1, 'Largest distance of the target from the measured position', 'm', minimum=1e-6,
        maximum=10.0)
    lower: tuple[float, ...] = parameter(
        (-10.0, -10.0, -10.0), 'Lower corner of the box, in the frame of kinematics.base, in '
        'which targets may lie', 'm')
    upper: tuple[float, ...] = parameter((10.0, 10.0, 10.0), 'Upper corner of that box', 'm')

    def __post_init__(self) -> None:
        """Check that the box is not empty."""
        super().__post_init__()
        if any(lower > upper for lower, upper in zip(self.lower, self.upper)):
            raise ParameterRangeError(
                'reference.limits.lower must be <= reference.limits.upper in each component, got '
                f'{list(self.lower)} and {list(self.upper)}; exchange them where lower is larger')


@dataclass(frozen=True)
class ReferenceParameters(ParameterGroup):
    """Conversion of a desired force into a reference position."""

    robot_stiffness: float = parameter(
        5000.0, 'K_t of the robot, used by the law `series`', 'N/m', minimum=1e-3)
    robot_force_tracking: bool = parameter(
        False, 'The robot adds F_r to its control force itself; excludes the law `series`')
    stiffness_floor: float = parameter(
        500.0, 'Lower limit of K_hat in the laws, so that a bad estimate commands no large depth',
        'N/m', minimum=1e-3)
    maximum_velocity: float = parameter(
        0.25, 'Limit of |dx_r/dt|, whether a force law is active or x_d passes through; must be '
        'above the speed of the planner, or x_r lags behind x_d', 'm/s', minimum=1e-6, maximum=1e6)
    maximum_depth: float = parameter(
        nan, 'Limit of x_r beyond environment.location; NaN: no limit', 'm', minimum=0.0,
        nan_is_off=True)
    fade_s: float = parameter(
        0.2, 'Time over which the offset between two laws fades out', 's', minimum=1e-3,
        maximum=60.0)
    maximum_force_rate: float = parameter(
        2000.0, 'Faster changes of F_r are treated as steps, without feed-forward', 'N/s',
        minimum=0.0)
    limits: PoseLimits = group(PoseLimits, 'Limits of ~/target_pose of an arm')


def refuse_double_tracking(law: str, force_tracking: bool) -> None:
    """Refuse the law `series` on a robot that tracks force itself."""
    if law == 'series' and force_tracking:
        raise ParameterRangeError(
            'reference_law series and a robot with force_tracking both correct for K_t, which '
            'together results in about 1.5 times the force; expected one of them, got both; use '
            'reference_law eq20 with force tracking, or switch force_tracking off')
