# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The parameters and processes of the loop: checked, started together, stopped in order."""

import importlib.util
import os
from pathlib import Path
import signal
import subprocess
import sys
import time
from typing import Any, Callable, Mapping, NamedTuple

from .estimator_node_parameters import EstimatorNodeParameters
from ..exceptions import MissingPackageError, ParameterRangeError
from ..parameter_files import ANY_NODE, parameter_sections, read_parameter_file
from ..parameters import build, ParameterGroup, specifications, without
from ..pipeline.parameters import EstimationParameters
from ..plant.plant_parameters import PAPER_NOISE, PlantNodeParameters, PlantParameters
from ..reference.experiment import Experiment
from ..reference.experiments import experiment_named, EXPERIMENTS
from ..reference.parameters import refuse_double_tracking

_LONGEST_S = 1e6
_RELIABLY = {f'qos_overrides./{topic}.subscription.reliability': 'reliable'
             for topic in ('wrench', 'joint_states', 'desired_trajectory')}
"""What the plant offers; best effort, as of any robot, may lose samples of a busy machine."""


def _names(*groups: type[ParameterGroup]) -> set[str]:
    return {spec.name for group in groups for spec in specifications(group)}


_OF_ESTIMATOR = _names(EstimationParameters, EstimatorNodeParameters)
_OF_PLANT = _names(PlantParameters, PlantNodeParameters)


class LoopConfiguration(NamedTuple):
    """Everything that a run of the loop depends on."""

    experiment: Experiment  # what the plant's planner plays
    duration: float  # length of the run [s]
    estimation: EstimationParameters  # as the estimator node will read them
    plant: PlantParameters  # as the plant node will read them
    sections: Mapping[str, Mapping[str, Any]]  # parameters of each node by full name

    @property
    def law(self) -> str:
        """Return the reference law, and whether the robot tracks force itself."""
        tracking = ' with force tracking' if self.plant.robot.force_tracking else ''
        return self.estimation.reference_law + tracking


def configure(
    experiment: str, parameter_file: str | None = None, estimator: str | None = None,
    duration: float | None = None, seed: int | None = None, reference_law: str | None = None,
    lockstep: bool = False,
) -> LoopConfiguration:
    """Combine a parameter file with options, which take precedence, and check the result."""
    played = experiment_named(experiment)
    seconds = _duration(duration, played)
    plant_values: dict[str, Any] = {
        **PAPER_NOISE, **_values_in(parameter_file, 'plant_node', _OF_PLANT, _OF_ESTIMATOR),
        'experiment': (experiment if experiment in EXPERIMENTS
                       else str(Path(experiment).absolute())),
        'duration': seconds, 'repeat': seconds > played.duration,
        'subscribers': 2,  # estimator and recorder
    }
    if seed is not None:
        plant_values['seed'] = seed
    if lockstep:
        plant_values['lockstep'] = True
    plant = build(PlantParameters, without(PlantNodeParameters, plant_values))
    # The estimator's reference law depends on the robot and must assume the same one.
    estimator_values: dict[str, Any] = {
        'reference.robot_force_tracking': plant.robot.force_tracking,
        'reference.robot_stiffness': plant.robot.stiffness,
        'sample_rate': plant.sample_rate,
        **_values_in(parameter_file, 'estimator_node', _OF_ESTIMATOR, _OF_PLANT),
    }
    if estimator is not None:
        estimator_values['estimator'] = estimator
    if reference_law is not None:
        estimator_values['reference_law'] = reference_law
    estimation = build(EstimationParameters, without(EstimatorNodeParameters, estimator_values))
    refuse_double_tracking(estimation.reference_law, plant.robot.force_tracking)
    sections = {'estimator_node': estimator_values, 'plant_node': plant_values}
    return LoopConfiguration(played, seconds, estimation, plant, sections)


def _values_in(
    parameter_file: str | None, node: str, own: set[str], others: set[str]
) -> dict[str, Any]:
    """Read the parameters of a node; in the section of any node, those of the other are left."""
    if not parameter_file:
        return {}
    shared = read_parameter_file(parameter_file, ANY_NODE)
    return {name: value for name, value in read_parameter_file(parameter_file, node).items()
            if name in own or name not in shared or name not in others}


def _duration(given: float | None, experiment: Experiment) -> float:
    if given is None:
        return experiment.duration
    if not 0.0 < given <= _LONGEST_S:
        raise ParameterRangeError(f'--duration must be > 0 and <= {_LONGEST_S:g} s, got {given:g}')
    return given


def write_parameters(
    path: Path, configuration: LoopConfiguration, recording: Path,
    plant_summary: Path | None = None,
) -> None:
    """Write the parameter file of all nodes."""
    estimator, plant = (configuration.sections[f'{name}_node'] for name in ('estimator', 'plant'))
    patience_s = 0.5 * plant.get('patience_s', PlantNodeParameters.patience_s)
    nodes = {
        'estimator_node': {**(_RELIABLY if plant.get('lockstep') else {}), **estimator},
        'plant_node': {**plant, 'summary_file': str(plant_summary or '')},
        'recorder_node': {'output': str(recording), 'patience_s': patience_s},
    }
    path.write_text(parameter_sections(**nodes))


_POLL_S = 0.05
_TIMEOUT_S = 10.0


class LoopProcesses:
    """
    Plant, estimator and recorder, each in its own process.

    Each process has its own session, so that Ctrl-C reaches only the loop, which then stops them
    in order: the recorder last, when no more messages arrive.
    """

    def __init__(self, parameters: Path) -> None:
        # Their matrices are small: a second thread of the linear algebra would only wait.
        environment = {'OMP_NUM_THREADS': '1', **os.environ,
                       'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST'}
        self._processes = {
            name: subprocess.Popen(
                [sys.executable, '-m', 'contact_estimation', name, '--ros-args', '--log-level',
                 'error', '--params-file', str(parameters)],
                env=environment, start_new_session=True, stdout=subprocess.DEVNULL)
            for name in ('recorder_node', 'estimator_node', 'plant_node')
        }

    def run(self, duration: float, report_progress: Callable[[float], None]) -> str:
        """Wait until the plant has finished, in about a duration [s], then stop the others."""
        signal.signal(signal.SIGTERM, signal.default_int_handler)
        try:
            failure = self._wait(duration, report_progress)
        except KeyboardInterrupt:
            failure = 'interrupted; the recording ends at the interruption'
        finally:
            # A second Ctrl-C must not orphan the nodes, which would interfere with the next run.
            for number in (signal.SIGINT, signal.SIGTERM):
                signal.signal(number, signal.SIG_IGN)
            killed = [name for name in ('plant_node', 'estimator_node', 'recorder_node')
                      if not end_process(self._processes[name], _TIMEOUT_S)]
        if killed and not failure:
            failure = f'{", ".join(killed)} did not end when interrupted and had to be killed'
        return failure

    def _wait(self, duration: float, report_progress: Callable[[float], None]) -> str:
        begin = time.monotonic()
        while True:
            for name, process in self._processes.items():
                code = process.poll()
                if name == 'plant_node' and code == 0:
                    return ''
                if code is not None:
                    return f'{name} ended with {_code_text(code)} before the experiment did'
            time.sleep(_POLL_S)
            report_progress(min((time.monotonic() - begin) / (duration + 2.0), 1.0))


def end_process(process: subprocess.Popen[bytes], timeout_s: float) -> bool:
    """Interrupt a process and wait for its end; kill it after a time-out [s]."""
    if process.poll() is None:
        process.send_signal(signal.SIGINT)
    try:
        process.wait(timeout_s)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
        return False
    return True


def require_rclpy(command: str) -> None:
    """Check that rclpy is installed."""
    if importlib.util.find_spec('rclpy') is None:
        raise MissingPackageError(
            f'{command} needs ROS 2 (rclpy), which this Python does not have; source your ROS '
            "installation, or install its wheels, in this project's folder: pip install '.[ros]'")


def _code_text(code: int) -> str:
    return f'signal {signal.Signals(-code).name}' if code < 0 else f'exit code {code}'
