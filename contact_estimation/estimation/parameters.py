# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""All parameters of on-line estimation, each declared once."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import nan
from typing import Any

from .arm import check_arm
from .axis_parameters import check_axes, check_matrix, FurtherAxesParameters
from .robot_compliance import RobotParameters
from ..estimators import EstimatorsTuning, MATRIX_ESTIMATORS, MULTIPLE_MODEL, ONLINE_ESTIMATORS
from ..estimators.environment_parameters import EnvironmentParameters
from ..estimators.stiffness_matrix import StiffnessMatrixParameters
from ..estimators.supervision_parameters import ExcitationParameters, TrackingParameters
from ..kinematics.parameters import (
    ForceSensorParameters, JOINT_EFFORTS, KinematicsParameters, TOPIC)
from ..kinematics.tool_load import ToolParameters
from ..parameters.specification import group, parameter, ParameterGroup
from ..physics import PhysicsParameters
from ..reference.laws import LAWS
from ..reference.parameters import ReferenceParameters, refuse_double_tracking
from ..signals.butterworth import check_cutoff
from ..signals.conditioning import ConditioningParameters
from ..signals.contact_parameters import ContactParameters
from ..signals.synchronisation import SynchronisationParameters


@dataclass(frozen=True)
class EstimationParameters(ParameterGroup):
    """Parameters that determine estimates and reference, shared by node and replay."""

    estimator: str = parameter(
        MULTIPLE_MODEL, 'Which estimator runs', choices=ONLINE_ESTIMATORS
    )
    reference_law: str = parameter(
        'eq20', 'Force law: how the desired force sets the reference position', choices=tuple(LAWS)
    )
    force_reference: float = parameter(
        nan, 'F_r until a setpoint arrives on desired_trajectory; NaN: no force desired', 'N',
        minimum=0.0, nan_is_off=True,
    )
    sample_rate: float = parameter(
        500.0, 'Nominal rate of the wrench, for which filters and relations are designed', 'Hz',
        minimum=1.0, maximum=1e5,
    )
    axis: str = parameter(
        'x', 'Axis of the wrench that is the contact axis', choices=('x', 'y', 'z'), read_only=True
    )
    joint: str = parameter(
        '', 'Joint whose position is the contact axis; empty: the only one', read_only=True
    )
    frame_id: str = parameter(
        '', 'Expected frame of the wrench; empty: that of the first wrench. Others are rejected',
        read_only=True,
    )
    force_sign: float = parameter(
        1.0, '1, or -1 where the sensor publishes the force that the robot applies', minimum=-1.0,
        maximum=1.0, read_only=True,
    )
    robot_description_file: str = parameter(
        '', 'URDF of an arm; empty: the text comes on the topic robot_description',
        read_only=True,
    )
    pose_source: str = parameter(
        'joints', 'Where the pose of an arm comes from: its joints and robot description, or the '
        'transforms of tf between kinematics.base and kinematics.tip', choices=('joints', 'tf'),
        read_only=True,
    )
    wrench_source: str = parameter(
        TOPIC, 'Where the wrench comes from: its topic, or the efforts of the joint states of an '
        'arm without a force sensor, by the masses and joint friction of its robot description',
        choices=(TOPIC, JOINT_EFFORTS), read_only=True,
    )
    joint_torques_std: float = parameter(
        0.05, 'With joint_efforts: relative standard deviation of friction and inertia of the '
        'robot description, which widens those of K_hat and B_hat', minimum=0.0, maximum=1.0,
        read_only=True,
    )
    kinematics: KinematicsParameters = group(
        KinematicsParameters, 'An arm: x and v along contact.normal follow from its joints')
    force_sensor: ForceSensorParameters = group(ForceSensorParameters, 'Force sensor of an arm')
    tool: ToolParameters = group(ToolParameters, 'Load of the tool on the force sensor of an arm')
    further_axes: FurtherAxesParameters = group(
        FurtherAxesParameters, 'Axes estimated beside the contact axis, each independently; '
        'all other parameters are shared')
    matrix_estimator: str = parameter(
        'off', 'Estimator of the full 3 x 3 stiffness and damping; needs all three axes',
        choices=('off', *MATRIX_ESTIMATORS), read_only=True,
    )
    stiffness_matrix: StiffnessMatrixParameters = group(StiffnessMatrixParameters)
    environment: EnvironmentParameters = group(EnvironmentParameters)
    conditioning: ConditioningParameters = group(ConditioningParameters)
    contact: ContactParameters = group(ContactParameters)
    excitation: ExcitationParameters = group(ExcitationParameters)
    tracking: TrackingParameters = group(TrackingParameters)
    synchronisation: SynchronisationParameters = group(SynchronisationParameters)
    robot: RobotParameters = group(RobotParameters)
    reference: ReferenceParameters = group(ReferenceParameters)
    physics: Any = group(PhysicsParameters)
    tuning: Any = group(EstimatorsTuning)

    def __post_init__(self) -> None:
        """Check parameters that must be consistent with each other."""
        super().__post_init__()
        check_cutoff(self.conditioning.cutoff_frequency, self.sample_rate)
        check_arm(self)
        check_axes(self.axis, self.joint, self.further_axes)
        check_matrix(self.matrix_estimator, tuple(self.joints))
        refuse_double_tracking(self.reference_law, self.reference.robot_force_tracking)

    @property
    def joints(self) -> dict[str, str]:
        """Return the joint of each estimated axis, the contact axis first."""
        further = self.further_axes.named()
        return {self.axis: self.joint, **{axis: own.joint for axis, own in further.items()}}

    @property
    def motion_topic(self) -> str:
        """Topic from which positions come."""
        return 'tf' if self.pose_source == 'tf' else 'joint_states'

    def of_axis(self, axis: str) -> EstimationParameters:
        """
        Return the parameters of one axis: its own surface location, all else shared.

        Parameters
        ----------
        axis : str
            One of `joints`.

        Returns
        -------
        parameters : EstimationParameters
            With the location of that axis in `environment`.

        """
        if axis == self.axis:
            return self
        location = self.further_axes.named()[axis].location
        return replace(self, environment=replace(self.environment, location=location))
