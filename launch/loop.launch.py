# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Plant, estimator and recorder with one experiment; everything ends with the plant."""

from pathlib import Path
from tempfile import NamedTemporaryFile
from typing import Any

from contact_estimation.estimators import ONLINE_ESTIMATORS
from contact_estimation.exceptions import ContactEstimationError
from contact_estimation.reference.reference_generator import LAWS
from contact_estimation.ros.loop_processes import configure, LoopConfiguration, write_parameters
from launch import LaunchContext, LaunchDescription  # type: ignore[attr-defined]
from launch.actions import (
    DeclareLaunchArgument, EmitEvent, OpaqueFunction, RegisterEventHandler, SetEnvironmentVariable)
from launch.event_handlers import OnProcessExit
from launch.events import Shutdown
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

ARGUMENTS: dict[str, dict[str, Any]] = {
    'output': {'description': 'folder for the recording, must not exist'},
    'experiment': {'default_value': 'sine', 'description': 'name of an experiment or its file'},
    'duration': {'default_value': '0.0', 'description': '0: the experiment [s]'},
    'params': {'default_value': '', 'description': 'parameter file with sections estimator_node '
               'and plant_node; empty: defaults'},
    'seed': {'default_value': '', 'description': 'of all noise; empty: that of params'},
    'estimator': {'default_value': '', 'choices': ['', *ONLINE_ESTIMATORS],
                  'description': 'empty: that of params'},
    'reference_law': {'default_value': '', 'choices': ['', *LAWS],
                      'description': 'empty: that of params'},
}


def nodes(context: LaunchContext) -> list[Any]:
    """Check the arguments and describe the nodes, which read one file of checked parameters."""
    given = {name: LaunchConfiguration(name).perform(context) for name in ARGUMENTS}
    if Path(given['output']).exists():
        raise RuntimeError(f'output must name a folder to be made, {given["output"]} exists')
    try:
        configuration = _configured(given)
    except ContactEstimationError as error:
        raise RuntimeError(str(error)) from error
    with NamedTemporaryFile(prefix='loop_', suffix='.yaml', delete=False) as file:
        write_parameters(Path(file.name), configuration, Path(given['output']))
    described = [
        Node(package='contact_estimation', executable=name, name=name, output='screen',
             parameters=[file.name])
        for name in ('recorder_node', 'estimator_node', 'plant_node')
    ]
    return [*(RegisterEventHandler(OnProcessExit(target_action=node, on_exit=ended))
              for node in described), *described]


def _configured(given: dict[str, str]) -> LoopConfiguration:
    """Combine the parameter file with those arguments that are given."""
    return configure(
        given['experiment'], given['params'], given['estimator'] or None,
        _number('duration', given, float) or None,
        _number('seed', given, int) if given['seed'] else None, given['reference_law'] or None)


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
    """Describe the arguments and the three nodes."""
    return LaunchDescription([
        *(DeclareLaunchArgument(name, **facts) for name, facts in ARGUMENTS.items()),
        SetEnvironmentVariable('ROS_AUTOMATIC_DISCOVERY_RANGE', 'LOCALHOST'),
        OpaqueFunction(function=nodes),
    ])
