# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The estimator alone, on a robot whose drivers and controllers run elsewhere."""

from pathlib import Path

from launch import LaunchContext, LaunchDescription  # type: ignore[attr-defined]
from launch.actions import DeclareLaunchArgument, EmitEvent, OpaqueFunction
from launch.events import Shutdown
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

ARGUMENTS = {
    'params': ('', 'parameter file of the estimator; must be given'),
    'tool': ('', 'parameter file that calibrate_tool has written; empty: none'),
    'namespace': ('', 'namespace of the node'),
    'name': ('estimator_node', 'name of the node'),
    'wrench': ('wrench', 'topic of the force sensor'),
    'joint_states': ('joint_states', 'topic of the joint states'),
    'robot_description': ('robot_description', 'topic of the URDF'),
    'tf': ('/tf', 'topic of moving transforms'),
    'tf_static': ('/tf_static', 'topic of static transforms'),
    'desired_trajectory': ('desired_trajectory', 'topic of setpoints of a planner'),
    'reference_trajectory': ('reference_trajectory', 'topic of the reference'),
    'target_pose': ('', 'topic of the target pose; empty: ~/target_pose'),
    'compensated_wrench': ('', 'topic of the compensated wrench; empty: ~/compensated_wrench'),
}
REMAPPED = ('wrench', 'joint_states', 'robot_description', 'desired_trajectory',
            'reference_trajectory')
ABSOLUTE = ('tf', 'tf_static')
PRIVATE = ('target_pose', 'compensated_wrench')


def nodes(context: LaunchContext) -> list[Node]:
    """Check the arguments and describe the node; it ends the launch with it."""
    value = {name: LaunchConfiguration(name).perform(context) for name in ARGUMENTS}
    files = [value[name] for name in ('params', 'tool') if value[name]]
    if not value['params']:
        raise RuntimeError('params must name a parameter file, such as params:=my_robot.yaml')
    for file in files:
        if not Path(file).is_file():
            raise RuntimeError(f'parameter file {file} does not exist')
    remappings = [(name, value[name]) for name in REMAPPED]
    remappings += [(f'/{name}', value[name]) for name in ABSOLUTE]
    remappings += [(f'~/{name}', value[name]) for name in PRIVATE if value[name]]
    return [Node(
        package='contact_estimation', executable='estimator_node', name=value['name'],
        namespace=value['namespace'], output='screen', parameters=files, remappings=remappings,
        on_exit=[EmitEvent(event=Shutdown(reason='the estimator has ended'))],
    )]


def generate_launch_description() -> LaunchDescription:
    """Describe the arguments and the node."""
    return LaunchDescription([
        *(DeclareLaunchArgument(name, default_value=default, description=text)
          for name, (default, text) in ARGUMENTS.items()),
        OpaqueFunction(function=nodes),
    ])
