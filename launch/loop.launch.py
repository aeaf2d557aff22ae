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

from launch import LaunchDescription
from launch.actions import (
    DeclareLaunchArgument,
    EmitEvent,
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
    finished = OnProcessExit(target_action=plant, on_exit=[EmitEvent(event=Shutdown())])
    return LaunchDescription([
        DeclareLaunchArgument('output', description='folder for the recording, must not exist'),
        DeclareLaunchArgument('experiment', default_value='sine'),
        DeclareLaunchArgument('duration', default_value='0.0', description='0: the experiment'),
        DeclareLaunchArgument('seed', default_value='0'),
        DeclareLaunchArgument('estimator', default_value='rls_adaptive'),
        DeclareLaunchArgument('reference_law', default_value='eq20'),
        DeclareLaunchArgument(
            'params', default_value=PathJoinSubstitution([config, 'estimator_node.yaml'])
        ),
        SetEnvironmentVariable('ROS_AUTOMATIC_DISCOVERY_RANGE', 'LOCALHOST'),
        recorder, estimator, plant, RegisterEventHandler(finished),
    ])
