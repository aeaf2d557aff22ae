# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""All parameters of on-line estimation, each declared once."""

from dataclasses import dataclass, replace
from math import hypot, nan
from typing import Any

from .arm_kinematics import check_arm
from ..estimators import EstimatorsTuning, MATRIX_ESTIMATORS, MULTIPLE_MODEL, ONLINE_ESTIMATORS
from ..estimators.estimate import ParameterEstimate
from ..estimators.parameters import EnvironmentParameters, ExcitationParameters, TrackingParameters
from ..estimators.stiffness_matrix import StiffnessMatrixParameters
from ..exceptions import ParameterRangeError
from ..kinematics.parameters import (
    ForceSensorParameters, JOINT_EFFORTS, KinematicsParameters, TOPIC)
from ..kinematics.tool_load import ToolParameters
from ..parameters import group, parameter, ParameterGroup
from ..physics import effects_that_are_on, PhysicsParameters
from ..physics.robot_effect import RobotEffect
from ..reference.parameters import ReferenceParameters, refuse_double_tracking
from ..reference.reference_generator import LAWS
from ..signals.conditioning import ConditioningParameters, ContactParameters
from ..signals.filters import check_cutoff
from ..signals.synchronisation import SynchronisationParameters


@dataclass(frozen=True)
class FurtherAxisParameters(ParameterGroup):
    """One axis that is estimated beside the contact axis."""

    joint: str = parameter(
        '', 'Joint whose position is this axis; empty: not estimated', read_only=True
    )
    location: float = parameter(
        0.0, 'Surface of the untouched wall along this axis; NaN: taken at the first touch', 'm',
        nan_is_off=True,
    )


@dataclass(frozen=True)
class FurtherAxesParameters(ParameterGroup):
    """Axes estimated beside the contact axis, each with an eq. (3) of its own; none by default."""

    x: FurtherAxisParameters = group(FurtherAxisParameters)
    y: FurtherAxisParameters = group(FurtherAxisParameters)
    z: FurtherAxisParameters = group(FurtherAxisParameters)

    def named(self) -> dict[str, FurtherAxisParameters]:
        """Return the axes that are estimated."""
        every = {'x': self.x, 'y': self.y, 'z': self.z}
        return {axis: own for axis, own in every.items() if own.joint}


def check_axes(axis: str, joint: str, further: FurtherAxesParameters) -> None:
    """Check that every axis is estimated once and from a joint of its own."""
    others = further.named()
    if axis in others:
        raise ParameterRangeError(
            f'further_axes.{axis}.joint must be empty, since {axis} is the contact axis, got '
            f'{others[axis].joint!r}; name it in joint, or choose another axis'
        )
    if others and not joint:
        raise ParameterRangeError(
            f'joint must name the joint of axis {axis} where further axes are estimated '
            f'({", ".join(others)}), got an empty text'
        )
    joints = [joint, *(own.joint for own in others.values())]
    if len(set(joints)) < len(joints):
        raise ParameterRangeError(
            f'joint and further_axes.*.joint must name different joints, got {joints}; each axis '
            'has a position of its own'
        )


def check_matrix(matrix_estimator: str, axes: tuple[str, ...]) -> None:
    """Check that the full matrices have three axes."""
    if matrix_estimator != 'off' and len(axes) < 3:
        raise ParameterRangeError(
            f'matrix_estimator {matrix_estimator} needs the axes x, y and z, got '
            f'{", ".join(axes)}; name the other joints in further_axes.*.joint'
        )


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


def include_joint_compliance(robot: RobotParameters, physics: Any) -> RobotParameters:
    """Add the compliance of joints that are known physics."""
    joints = [effect.joint(1.0) for effect in effects_that_are_on(physics)
              if isinstance(effect, RobotEffect)]
    yields = sum(joint.compliance for joint in joints if joint is not None)
    return replace(robot, compliance=robot.compliance + yields) if yields else robot


def remove_robot_compliance(
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


def add_robot_compliance(stiffness: float, robot: RobotParameters) -> float:
    """
    Return the stiffness of wall and robot in series, which relates measured position and force.

    stiffness: K_e of the wall alone [N/m]
    robot: compliance C [m/N]
    Returns stiffness: K_e / (1 + C K_e) [N/m]
    """
    return stiffness / (1.0 + robot.compliance * stiffness)


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
        FurtherAxesParameters, 'Axes estimated in addition to the contact axis, each '
        'independently; all other parameters are shared')
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

    def of_axis(self, axis: str) -> 'EstimationParameters':
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
