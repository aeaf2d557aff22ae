# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Parameters of the simulated robot, wall and sensors, and the model files that hold them."""

from dataclasses import dataclass, replace
from os import PathLike
from pathlib import Path
from typing import Any

from ..exceptions import ModelFileError, ParameterRangeError
from ..parameter_files import read_parameter_file
from ..parameters import build, group, parameter, ParameterGroup, without
from ..physics import PhysicsParameters
from ..physics.numeric import SIGN_VELOCITY

PAPER_NOISE = {'sensors.force_noise': 1.0, 'sensors.distribution': 'uniform'}
"""The paper's simulated force sensor: uniform, +-1 N."""


@dataclass(frozen=True)
class WallParameters(ParameterGroup):
    """The environment, eq. (3)."""

    stiffness: float = parameter(
        4800.0, 'Stiffness K_e; below 0 only if permanently attached', 'N/m')
    damping: float = parameter(200.0, 'Damping B_e', 'N s/m', minimum=0.0)
    location: float = parameter(0.0, 'Position x_e of the untouched surface', 'm')
    inertia: float = parameter(0.0, 'Mass M_e moving with the tool in contact', 'kg', minimum=0.0)
    unilateral: bool = parameter(True, 'The wall cannot pull; false: permanently attached')

    def __post_init__(self) -> None:
        """Check all fields; what a drive moves, as a link above its joint, may be repelled."""
        super().__post_init__()
        if self.unilateral and self.stiffness < 0.0:
            raise ParameterRangeError(
                f'environment.stiffness must be a number >= 0 [N/m], got {self.stiffness:g}; only '
                'a permanently attached environment (environment.unilateral: false) may have less')


@dataclass(frozen=True)
class RobotParameters(ParameterGroup):
    """The robot under impedance control, eq. (1), or a bare arm."""

    mass: float = parameter(50.0, 'Target mass M_t', 'kg', minimum=1e-15)
    damping: float = parameter(1000.0, 'Target damping B_t', 'N s/m', minimum=0.0)
    stiffness: float = parameter(5000.0, 'Target stiffness K_t', 'N/m', minimum=0.0)
    force_tracking: bool = parameter(False, 'The robot adds F_r to its control force')
    control: str = parameter(
        'impedance', 'impedance: obeys eq. (1) with these values; force: a bare arm of this mass '
        'and damping, driven by the control force of the estimator `mrac`',
        choices=('impedance', 'force'), read_only=True)

    def law(self) -> 'RobotParameters':
        """Return the parameters of eq. (1) that the robot obeys; a bare arm has no stiffness."""
        if self.control == 'impedance':
            return self
        return replace(self, stiffness=0.0, force_tracking=True)


@dataclass(frozen=True)
class SensorParameters(ParameterGroup):
    """Noise and resolution of the sensors."""

    force_noise: float = parameter(
        0.0, 'Half width (uniform) or standard deviation (normal) of the force noise', 'N',
        minimum=0.0)
    position_noise: float = parameter(0.0, 'Position noise, like force_noise', 'm', minimum=0.0)
    velocity_noise: float = parameter(0.0, 'Velocity noise, like force_noise', 'm/s', minimum=0.0)
    position_quantisation: float = parameter(
        0.0, 'Resolution of the position; 0: unlimited', 'm', minimum=0.0)
    publish_velocity: bool = parameter(True, 'Whether joint_states contains velocities')
    distribution: str = parameter(
        'normal', 'Distribution of the noise; the paper uses uniform',
        choices=('normal', 'uniform'))


@dataclass(frozen=True)
class PlantParameters(ParameterGroup):
    """The simulated world: parameters of `plant_node` and of a model file."""

    environment: WallParameters = group(WallParameters)
    robot: RobotParameters = group(RobotParameters)
    sensors: SensorParameters = group(SensorParameters)
    physics: Any = group(PhysicsParameters)
    sample_rate: float = parameter(
        500.0, 'Sample rate of the sensors', 'Hz', minimum=1e-4, maximum=1e6, read_only=True)
    integration_rate: float = parameter(
        5000.0, 'Minimum rate of integration steps', 'Hz', minimum=1e-4, maximum=1e7,
        read_only=True)
    sign_velocity: float = parameter(
        SIGN_VELOCITY, 'Speed below which dry friction fades: sgn(v) = tanh(v / sign_velocity)',
        'm/s', minimum=1e-15, read_only=True)
    seed: int = parameter(0, 'Seed of all noise', minimum=0, read_only=True)


@dataclass(frozen=True)
class PlantNodeParameters(ParameterGroup):
    """The experiment, and when it starts and ends."""

    experiment: str = parameter(
        'sine', 'Name of an experiment, or a YAML file of segments', read_only=True)
    duration: float = parameter(
        0.0, 'Time after which the node ends; 0: that of the experiment', 's', minimum=0.0,
        read_only=True)
    repeat: bool = parameter(
        False, 'Repeat the experiment until the duration is over; without a '
        'duration, without end', read_only=True)
    subscribers: int = parameter(
        1, 'Number of subscribers of wrench and joint_states to wait for at the start', minimum=0,
        maximum=1000, read_only=True)
    patience_s: float = parameter(
        30.0, 'Start without them after this', 's', minimum=0.0, read_only=True)
    lockstep: bool = parameter(
        False, 'Send a sample only after the reference for the previous one has arrived: '
        'the run does not depend on the speed of the machine', read_only=True)
    frame_id: str = parameter('contact_frame', 'Frame of the wrench', read_only=True)
    joint: str = parameter('contact_x', 'Name of the joint', read_only=True)
    summary_file: str = parameter(
        '', 'At the end, write samples sent, samples dropped and latency to this JSON file',
        read_only=True)


def read_model(path: str | PathLike[str], seed: int | None = None) -> PlantParameters:
    """
    Read a model file: the section `plant_node` of a ROS 2 parameter file.

    Parameters
    ----------
    path : str or path-like
        YAML file; a missing key has its default.
    seed : int, optional
        Seed of all noise, >= 0; default: the seed of the file.

    Returns
    -------
    model : PlantParameters
        Environment, robot, sensors and physics.

    Raises
    ------
    ModelFileError
        If the file is missing or has no section `plant_node`.
    ContactEstimationError
        If a key is unknown or a value is out of range.

    """
    values = read_parameter_file(Path(path), 'plant_node')
    if not values:
        raise ModelFileError(
            f'model file {path} must have a section plant_node with ros__parameters, got none; '
            'see config/plant_node.yaml for an example')
    model = build(PlantParameters, without(PlantNodeParameters, values))
    return model if seed is None else replace(model, seed=seed)
