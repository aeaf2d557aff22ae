# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The files of one arm: description, recordings of simulated runs, parameters, nominal models."""

from __future__ import annotations

import json
from pathlib import Path
import shutil
from typing import Any, Callable, Mapping

import numpy as np
import yaml

from .arm_models import Arm, Array, description_of, SENSOR, TIP
from .arm_recording import FORCE_BIAS, messages, TORQUE_BIAS, write_recording
from .simulation import ArmSimulation, Run, World
from ...kinematics.robot_model import RobotModel
from ...kinematics.tool_load import tool_wrench, ToolParameters
from ...parameters.file import read_parameter_file

_KNOWN_WORSE = {'stiffness': 1.06, 'damping': 0.8}  # nominal over true


class ArmFiles:
    """A folder with all files of one arm."""

    def __init__(self, arm: Arm, folder: Path) -> None:
        self.arm, self._folder = arm, folder
        self._urdf = description_of(arm)
        self.description = folder / f'{arm.name}.urdf'
        self.description.write_text(self._urdf)
        self._joints = RobotModel(self._urdf, arm.base, TIP).joint_names

    def calibration(self, seed: int) -> Path:
        """Record 12 poses in free flight."""
        run = ArmSimulation(self.arm, self._urdf, World()).calibrate(seed)
        return self._record(run, f'poses_{seed}', seed)

    def touch(self, world: World, seed: int, name: str) -> tuple[Run, Path]:
        """Simulate three touches and record them."""
        run = ArmSimulation(self.arm, self._urdf, world).touch(seed)
        return run, self._record(run, f'{name}_{seed}', seed + 1000)

    def parameters(self, run: Run) -> dict[str, Any]:
        """Return the parameters of the estimator node for a run, without those of the tool."""
        return {
            'estimator': 'kalman', 'sample_rate': 1000.0 / self.arm.wrench_period,
            'kinematics.base': self.arm.base, 'kinematics.tip': TIP,
            'contact.normal': [float(part) for part in run.normal],
            'force_sensor.frame': SENSOR, 'environment.location': run.location,
        }

    def parameter_file(self, name: str, values: dict[str, Any]) -> Path:
        """Write parameters as a ROS 2 parameter file."""
        plain = {key: [*value] if isinstance(value, tuple) else value
                 for key, value in values.items()}
        path = self._folder / f'{self.arm.name}_{name}.yaml'
        path.write_text(yaml.safe_dump({'/**': {'ros__parameters': plain}}))
        return path

    def nominal_model(self, name: str, run: Run, world: World) -> Path:
        """
        Write the nominal model for `diagnose`: no physics, K_e 6 % too high, B_e 20 % too low.

        world: True K_e [N/m] and B_e [N s/m]
        """
        environment = {'stiffness': world.K_e * _KNOWN_WORSE['stiffness'],
                       'damping': world.B_e * _KNOWN_WORSE['damping'], 'location': run.location}
        model = {'environment': environment, 'robot': run.impedance}
        path = self._folder / f'{self.arm.name}_{name}.nominal.yaml'
        path.write_text(yaml.safe_dump({'plant_node': {'ros__parameters': model}}))
        return path

    def force_along_normal(self, run: Run, tool: Mapping[str, Any]) -> Array:
        """
        Compute the force along the normal as a sensor without noise measures it.

        Returns force (N,): force along the normal, with the bias of the sensor [N]
        """
        model = RobotModel(self._urdf, self.arm.base, SENSOR)
        axes = np.array([model.pose(q)[0] for q in run.q])
        wrench = run.wrench + np.array(FORCE_BIAS + TORQUE_BIAS)
        if tool:
            own = ToolParameters(*(tool[f'tool.{field}'] for field in (
                'mass', 'centre', 'force_bias', 'torque_bias')))
            wrench = wrench - tool_wrench(own, axes)
        return np.einsum('i,nij,nj->n', run.normal, axes, wrench[:, :3])

    def path(self, name: str) -> Path:
        """Return the path of another file of the arm."""
        return self._folder / f'{self.arm.name}_{name}'

    def _record(self, run: Run, name: str, seed: int) -> Path:
        shutil.rmtree(self.path(name), ignore_errors=True)  # of an interrupted study
        stream = messages(self.arm, run, self._joints, self._urdf, seed)
        return write_recording(self.path(name), stream)

    def kept(self, name: str, make: Callable[[], Any]) -> Any:
        """Return results from a JSON file, which is made where it does not exist."""
        path = self.path(f'{name}.results.json')
        if not path.exists():
            path.write_text(json.dumps(make(), indent=1) + '\n')
        return json.loads(path.read_text())


def world_of(seed: int, friction: float = 0.0) -> World:
    """
    Draw a wall.

    seed: seed of the draw; 0 gives 5000 N/m and 80 N s/m
    friction: dry friction of the joints, as a force along the normal [N]
    """
    rng = np.random.default_rng(seed)
    K_e, B_e = rng.uniform(4000.0, 7000.0), rng.uniform(60.0, 140.0)
    return World(friction=friction) if seed == 0 else World(K_e, B_e, friction=friction)


def tool_parameters(path: Path) -> dict[str, Any]:
    """Read the parameter file that `calibrate_tool` wrote."""
    return read_parameter_file(path, 'estimator_node')
