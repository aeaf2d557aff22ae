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

"""Plant, estimator and recorder with one experiment; everything ends with the plant."""

from pathlib import Path
from typing import Any

from contact_estimation.estimators import ESTIMATORS
from contact_estimation.exceptions import ContactEstimationError
from contact_estimation.reference.laws import LAWS
from contact_estimation.ros.loop_configuration import configure
from launch import LaunchContext, LaunchDescription  # type: ignore[attr-defined]
from launch.actions import (
    DeclareLaunchArgument,
    EmitEvent,
    OpaqueFunction,
    RegisterEventHandler,
    SetEnvironmentVariable,
)
from launch.event_handlers import OnProcessExit
from launch.events import Shutdown
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue
from launch_ros.substitutions import FindPackageShare

PACKAGE = 'contact_estimation'


def check(context: LaunchContext) -> None:
    """Refuse wrong arguments before any process starts."""
    given = {name: LaunchConfiguration(name).perform(context) for name in (
        'output', 'experiment', 'duration', 'seed', 'estimator', 'params')}
    if Path(given['output']).exists():
        raise RuntimeError(f'output must name a folder to be made, {given["output"]} exists')
    try:
        duration, seed = _number('duration', given, float), _number('seed', given, int)
        configure(given['experiment'], given['params'], given['estimator'], duration or None, seed)
    except ContactEstimationError as error:
        raise RuntimeError(str(error)) from error


def _number(name: str, given: dict[str, str], kind: type) -> Any:
    try:
        return kind(given[name])
    except ValueError as error:
        raise RuntimeError(f'{name} must be a number, got {given[name]!r}') from error


def ended(event: Any, context: LaunchContext) -> list[EmitEvent]:
    """End all with the plant; a node that dies makes the launch fail."""
    if event.returncode != 0 and not context.is_shutdown:
        raise RuntimeError(f'{event.process_name} ended with exit code {event.returncode}')
    return [EmitEvent(event=Shutdown(reason='the experiment is over'))]


def generate_launch_description() -> LaunchDescription:
    """Describe the three nodes and their arguments."""
    config = PathJoinSubstitution([FindPackageShare(PACKAGE), 'config'])
    plant = Node(
        package=PACKAGE, executable='plant_node', name='plant_node', output='screen',
        parameters=[
            PathJoinSubstitution([config, 'plant_node.yaml']),
            {
                'experiment': LaunchConfiguration('experiment'),
                'duration': ParameterValue(LaunchConfiguration('duration'), value_type=float),
                'seed': ParameterValue(LaunchConfiguration('seed'), value_type=int),
                'subscribers': 2,
            },
        ],
    )
    estimator = Node(
        package=PACKAGE, executable='estimator_node', name='estimator_node', output='screen',
        parameters=[
            LaunchConfiguration('params'),
            {
                'estimator': LaunchConfiguration('estimator'),
                'reference_law': LaunchConfiguration('reference_law'),
            },
        ],
    )
    recorder = Node(
        package=PACKAGE, executable='recorder_node', name='recorder_node', output='screen',
        parameters=[{'output': LaunchConfiguration('output')}],
    )
    nodes = (recorder, estimator, plant)
    return LaunchDescription([
        DeclareLaunchArgument('output', description='folder for the recording, must not exist'),
        DeclareLaunchArgument('experiment', default_value='sine'),
        DeclareLaunchArgument('duration', default_value='0.0', description='0: the experiment'),
        DeclareLaunchArgument('seed', default_value='0'),
        DeclareLaunchArgument(
            'estimator', default_value='rls_adaptive', choices=list(ESTIMATORS)),
        DeclareLaunchArgument('reference_law', default_value='eq20', choices=list(LAWS)),
        DeclareLaunchArgument(
            'params', default_value=PathJoinSubstitution([config, 'estimator_node.yaml'])
        ),
        OpaqueFunction(function=check),
        SetEnvironmentVariable('ROS_AUTOMATIC_DISCOVERY_RANGE', 'LOCALHOST'),
        *(RegisterEventHandler(OnProcessExit(target_action=node, on_exit=ended))
          for node in nodes),
        *nodes,
    ])
