# Copyright 2026 contact_estimation authors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""Parameters of the simulated robot, wall and sensors: the model file."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from ..parameters.specification import group, parameter, ParameterGroup
from ..physics import PhysicsParameters

PAPER_NOISE = {'sensors.force_noise': 1.0, 'sensors.distribution': 'uniform'}
"""The paper's simulated force sensor: uniform, +-1 N."""


@dataclass(frozen=True)
class WallParameters(ParameterGroup):
    """The environment, eq. (3)."""

    stiffness: float = parameter(4800.0, 'K_e', 'N/m', minimum=0.0)
    damping: float = parameter(200.0, 'B_e', 'N s/m', minimum=0.0)
    location: float = parameter(0.0, 'Surface of the untouched wall, x_e', 'm')
    inertia: float = parameter(0.0, 'M_e, moves with the tool while in contact', 'kg', minimum=0.0)
    unilateral: bool = parameter(True, 'The wall cannot pull; false: permanently attached')


@dataclass(frozen=True)
class RobotParameters(ParameterGroup):
    """The robot under impedance control, eq. (1), or a bare arm."""

    mass: float = parameter(50.0, 'M_t', 'kg', minimum=1e-6)
    damping: float = parameter(1000.0, 'B_t', 'N s/m', minimum=0.0)
    stiffness: float = parameter(5000.0, 'K_t', 'N/m', minimum=0.0)
    force_tracking: bool = parameter(False, 'Adds F_r to the control force')
    control: str = parameter(
        'impedance', 'impedance: obeys eq. (1) with these; force: a bare arm of this mass and '
        'damping, pushed by the control force of the estimator `mrac`',
        choices=('impedance', 'force'), read_only=True,
    )

    def law(self) -> RobotParameters:
        """
        Give the parameters of eq. (1) that the robot obeys.

        Returns
        -------
        robot : RobotParameters
            Of a bare arm: without stiffness, F_r pushes, and the reference must rest.

        """
        if self.control == 'impedance':
            return self
        return replace(self, stiffness=0.0, force_tracking=True)


@dataclass(frozen=True)
class SensorParameters(ParameterGroup):
    """What the sensors add."""

    force_noise: float = parameter(
        0.0, 'Half width (uniform) or standard deviation (normal) of the force noise', 'N',
        minimum=0.0,
    )
    position_noise: float = parameter(0.0, 'As force_noise, of the position', 'm', minimum=0.0)
    velocity_noise: float = parameter(0.0, 'As force_noise, of the velocity', 'm/s', minimum=0.0)
    position_quantisation: float = parameter(
        0.0, 'Step of the position reading; 0: none', 'm', minimum=0.0
    )
    publish_velocity: bool = parameter(True, 'joint_states carries a velocity')
    distribution: str = parameter(
        'normal', 'Of the noise; the paper has uniform', choices=('normal', 'uniform')
    )


@dataclass(frozen=True)
class PlantParameters(ParameterGroup):
    """The simulated world, as `plant_node` and the model file have it."""

    environment: WallParameters = group(WallParameters)
    robot: RobotParameters = group(RobotParameters)
    sensors: SensorParameters = group(SensorParameters)
    physics: Any = group(PhysicsParameters)
    sample_rate: float = parameter(
        500.0, 'Rate of the samples', 'Hz', minimum=1.0, maximum=1e5, read_only=True
    )
    integration_rate: float = parameter(
        5000.0, 'Least rate of integration steps', 'Hz', minimum=1.0, maximum=1e6,
        read_only=True,
    )
    seed: int = parameter(0, 'Of all noise', minimum=0, read_only=True)
