# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The files of one arm: recordings with the faults of real sensors, parameters, nominal models."""

from __future__ import annotations

import json
from pathlib import Path
import shutil
from typing import Any, Callable, Iterator, Mapping, NamedTuple

import numpy as np
import yaml

from .arm_models import Arm, Array, description_of, SENSOR, TIP
from .arm_simulation import ArmSimulation, Run, TIMESTEP, World
from ..kinematics.robot_model import RobotModel
from ..kinematics.tool_load import tool_wrench, ToolParameters
from ..parameter_files import read_parameter_file
from ..recordings import RecordingWriter
from ..recordings.encoding import encode_string, jazzy_typestore, TrajectoryEncoder

FORCE_BIAS, TORQUE_BIAS = (2.0, -1.5, 3.0), (0.05, -0.1, 0.08)  # [N], [N m]
FORCE_NOISE, TORQUE_NOISE = 0.15, 0.01  # [N], [N m]
_POSITION_NOISE, _VELOCITY_NOISE = 5e-6, 5e-4  # [rad], [rad/s]
_REFERENCE_PERIOD = 2  # [ms]
_BEGIN_NS = 1_000_000_000_000
_JOINTS, _WRENCH = 'sensor_msgs/msg/JointState', 'geometry_msgs/msg/WrenchStamped'
_TRAJECTORY, _STRING = 'trajectory_msgs/msg/JointTrajectory', 'std_msgs/msg/String'


class Message(NamedTuple):
    """One message of a recording."""

    stamp_ns: int  # header stamp [ns]
    # topic, type_name: without leading slash; such as 'std_msgs/msg/String'
    topic: str
    type_name: str
    data: bytes  # CDR


def messages(
    arm: Arm, run: Run, joints: tuple[str, ...], urdf: str, seed: int, begin_ns: int = _BEGIN_NS
) -> Iterator[Message]:
    """
    Iterate over the messages of a run.

    Names of the joints are shuffled anew in each of four kinds of messages, among them a joint
    that is not of the arm. Joint states come before the wrench of the same stamp.

    seed: of the noise and the order of names
    begin_ns: stamp of the first message [ns]
    """
    rng, store = np.random.default_rng(seed), _Types()
    bias = np.array(FORCE_BIAS + TORQUE_BIAS)
    noise = np.repeat([FORCE_NOISE, TORQUE_NOISE], 3)
    orders = [rng.permutation(len(joints) + 1) for _ in range(4)]
    names = (*joints, 'finger_joint')
    along_normal = run.reference.x.ndim == 1
    trajectory = TrajectoryEncoder('base', 'normal')
    yield Message(begin_ns, 'robot_description', _STRING, encode_string(urdf))
    for k in range(len(run.q)):
        stamp = begin_ns + round(k * TIMESTEP * 1e9)
        if along_normal and k % _REFERENCE_PERIOD == 0:
            x, v, a = (float(column[k]) for column in run.reference)
            yield Message(stamp, 'reference_trajectory', _TRAJECTORY,
                          trajectory.encode(stamp, x, v, a, 0.0))
        if k % arm.joint_period == 0:
            order = orders[k // arm.joint_period % len(orders)]
            q = run.q[k] + rng.normal(0.0, _POSITION_NOISE, len(joints))
            q_dot = run.q_dot[k] + rng.normal(0.0, _VELOCITY_NOISE, len(joints))
            yield Message(stamp, 'joint_states', _JOINTS, store.joint_state(
                stamp, [names[i] for i in order], np.append(q, 0.0)[order],
                np.append(q_dot, 0.0)[order]))
        if k % arm.wrench_period == 0:
            wrench = run.wrench[k] + bias + noise * rng.normal(size=6)
            yield Message(stamp, 'wrench', _WRENCH, store.wrench(stamp, wrench))


def write_recording(path: Path, stream: Iterator[Message]) -> Path:
    """Write messages as a rosbag2 folder."""
    with RecordingWriter.folder(path) as writer:
        for message in stream:
            writer.write(f'/{message.topic}', message.type_name, message.data, message.stamp_ns)
    return path


class _Types:
    """Messages by rosbags, not by the library's own encoders: an independent form."""

    def __init__(self) -> None:
        self._store = jazzy_typestore()
        types = self._store.types
        self._time = types['builtin_interfaces/msg/Time']
        self._header = types['std_msgs/msg/Header']
        self._vector = types['geometry_msgs/msg/Vector3']
        self._plain = types['geometry_msgs/msg/Wrench']
        self._stamped, self._joints = types[_WRENCH], types[_JOINTS]

    def wrench(self, stamp_ns: int, wrench: Array) -> bytes:
        """Return a raw wrench in the sensor's frame."""
        force, torque = self._vector(*wrench[:3]), self._vector(*wrench[3:])
        message = self._stamped(self._headed(stamp_ns, SENSOR), self._plain(force, torque))
        return bytes(self._store.serialize_cdr(message, _WRENCH))

    def joint_state(self, stamp_ns: int, names: list[str], q: Array, q_dot: Array) -> bytes:
        """Return a raw joint state."""
        message = self._joints(self._headed(stamp_ns, ''), names, q, q_dot, np.zeros(0))
        return bytes(self._store.serialize_cdr(message, _JOINTS))

    def _headed(self, stamp_ns: int, frame: str) -> Any:
        return self._header(self._time(*divmod(stamp_ns, 1_000_000_000)), frame)


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
