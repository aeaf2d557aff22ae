# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Parameters of the estimator node itself."""

from dataclasses import dataclass

from ..parameters import group, parameter, ParameterGroup
from ..reference.stable_gains import StabilityParameters


@dataclass(frozen=True)
class EstimatorNodeParameters(ParameterGroup):
    """Rates and options of the node."""

    diagnostics_rate: float = parameter(
        2.0, 'Rate of /diagnostics', 'Hz', minimum=1.0, maximum=10.0, read_only=True)
    silence_s: float = parameter(
        0.5, 'Diagnostics are an error after this time without a wrench', 's', minimum=0.01)
    hardware_id: str = parameter(
        '', 'Of sensor or robot, for /diagnostics; empty: the frame of the wrench, else its topic',
        read_only=True)
    publish_target_pose: bool = parameter(
        False, 'Publish the measured pose with x_r along the normal on ~/target_pose, for '
        'Cartesian controllers of an arm (kinematics.tip)')
    stability: StabilityParameters = group(
        StabilityParameters, 'Gains of the robot, judged on the estimated wall: ~/stability')
    dedicated_wait_set: bool = parameter(
        True, 'Serve data on a dedicated wait set; false: on the executor, as usual in rclpy',
        read_only=True)
