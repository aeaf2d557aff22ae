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

"""Plant, estimator and recorder on this machine, an experiment, and a summary of it."""

from __future__ import annotations

import importlib.util
import json
from pathlib import Path
import sys
from typing import Any, Mapping

import yaml

from .command_line import command, Parser
from .loop_picture import draw_picture
from .loop_processes import LoopProcesses
from .loop_run import read_run
from .loop_summary import summarise
from ..estimation.parameters import EstimationParameters
from ..estimators import ESTIMATORS
from ..exceptions import MissingPackageError, ParameterRangeError, RecordingError
from ..optional_packages import require_matplotlib
from ..parameters.file import read_parameter_file
from ..parameters.values import build, without
from ..plant.plant_parameters import PAPER_NOISE, PlantParameters
from ..recordings.definitions import jazzy_typestore
from ..reference.experiment import Experiment
from ..reference.experiments import experiment_named, EXPERIMENTS
from ..reference.reference_generator import refuse_double_tracking
from ..ros.estimator_node_parameters import EstimatorNodeParameters
from ..ros.plant_node_parameters import PlantNodeParameters


def make_parser() -> Parser:
    """Build the command line of `loop`."""
    parser = Parser(
        prog='loop',
        description='Run plant, estimator and recorder as separate ROS 2 processes on this '
        'machine, play an experiment, and sum it up.',
    )
    parser.add_argument('--duration', type=float, help='seconds; default: one experiment')
    parser.add_argument('--output', required=True, metavar='DIR', help='new folder for results')
    parser.add_argument('--estimator', help='one of ' + ', '.join(ESTIMATORS))
    parser.add_argument(
        '--experiment', default='sine', metavar='NAME|FILE.yaml',
        help='one of ' + ', '.join(EXPERIMENTS) + ', or a YAML file of segments',
    )
    parser.add_argument(
        '--params', metavar='FILE',
        help='ROS 2 parameter file with sections estimator_node and plant_node',
    )
    parser.add_argument('--seed', type=int, help='seed of all noise')
    return parser


def run(options: Any) -> int:
    """
    Run the loop as the options say.

    Parameters
    ----------
    options : argparse.Namespace
        Of `make_parser`.

    Returns
    -------
    code : int
        0, or 1 where a process failed; the recording is kept.

    """
    require_matplotlib()
    jazzy_typestore()
    _require_ros()
    experiment = experiment_named(options.experiment)
    sections = _sections(options, experiment)
    estimation, plant = _validated(sections)
    duration = sections['plant_node']['duration']
    output = _new_folder(options.output)
    parameters, told = output / 'parameters.yaml', output / 'plant_summary.json'
    sections['plant_node']['summary_file'] = str(told)
    sections['recorder_node'] = {'output': str(output / 'recording')}
    _write_parameters(parameters, sections)
    failure = LoopProcesses(parameters).run(duration)
    if failure:
        print(f'loop: {failure}', file=sys.stderr)
    try:
        data = read_run(output / 'recording', told)
    except RecordingError:
        if failure:
            return 1
        raise
    summary = summarise(
        data, plant, experiment, estimation.estimator, _law_text(estimation, plant)
    )
    (output / 'summary.json').write_text(json.dumps(summary, indent=1) + '\n')
    wall = plant.environment
    draw_picture(data, _title(summary), wall.stiffness, wall.damping, output / 'summary.png')
    _print(summary, output)
    if not failure and summary['samples_lost'] == summary['samples_sent']:
        failure = (
            'the estimator used no sample; expected one answer for each, see the rejected ones '
            'in /diagnostics of the recording, and check joint and frame_id in --params'
        )
        print(f'loop: {failure}', file=sys.stderr)
    return 1 if failure else 0


def _require_ros() -> None:
    if importlib.util.find_spec('rclpy') is None:
        raise MissingPackageError(
            'loop needs ROS 2 (rclpy), which this Python does not have; source your ROS '
            "installation, or install its wheels, in this project's folder: pip install '.[ros]'"
        )


def _sections(options: Any, experiment: Experiment) -> dict[str, dict[str, Any]]:
    """Put together what the parameter file and the options say."""
    estimator: dict[str, Any] = {}
    plant: dict[str, Any] = dict(PAPER_NOISE)
    if options.params:
        estimator.update(read_parameter_file(options.params, 'estimator_node'))
        plant.update(read_parameter_file(options.params, 'plant_node'))
    if options.estimator is not None:
        estimator['estimator'] = options.estimator
    if options.seed is not None:
        plant['seed'] = options.seed
    plant['experiment'] = _absolute(options.experiment)
    plant['duration'] = _duration(options.duration, experiment)
    plant['repeat'] = plant['duration'] > experiment.duration
    plant['subscribers'] = 2  # estimator and recorder
    return {'estimator_node': estimator, 'plant_node': plant}


def _duration(given: float | None, experiment: Experiment) -> float:
    if given is None:
        return experiment.duration
    if not 0.0 < given <= _LONGEST_S:
        raise ParameterRangeError(
            f'--duration must be > 0 and <= {_LONGEST_S:g} s, got {given:g}'
        )
    return given


def _absolute(experiment: str) -> str:
    return experiment if experiment in EXPERIMENTS else str(Path(experiment).absolute())


def _validated(
    sections: dict[str, dict[str, Any]]
) -> tuple[EstimationParameters, PlantParameters]:
    """Check before anything starts what the nodes would find wrong, and what only both know."""
    plant_values, estimator_values = sections['plant_node'], sections['estimator_node']
    plant = build(PlantParameters, without(PlantNodeParameters, plant_values))
    # The robot's side of the bargain belongs to the estimator's laws too.
    estimator_values.setdefault(
        'reference.robot_force_tracking', plant.robot.force_tracking
    )
    estimator_values.setdefault('reference.robot_stiffness', plant.robot.stiffness)
    estimator_values.setdefault('sample_rate', plant.sample_rate)
    estimation = build(
        EstimationParameters, without(EstimatorNodeParameters, estimator_values)
    )
    refuse_double_tracking(estimation.reference_law, plant.robot.force_tracking)
    return estimation, plant


def _new_folder(path: str) -> Path:
    folder = Path(path)
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise RecordingError(
            f'--output {path} exists already and is not empty; nothing recorded is ever '
            'overwritten: name another folder'
        )
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def _write_parameters(path: Path, sections: Mapping[str, Mapping[str, Any]]) -> None:
    nested = {node: {'ros__parameters': dict(values)} for node, values in sections.items()}
    path.write_text(yaml.safe_dump(nested, sort_keys=False))


def _law_text(estimation: EstimationParameters, plant: PlantParameters) -> str:
    tracking = ' with force tracking' if plant.robot.force_tracking else ''
    return estimation.reference_law + tracking


def _title(summary: Mapping[str, Any]) -> str:
    return (
        f'{summary["estimator"]}, law {summary["law"]}: K_e {_text(summary["stiffness"])} N/m '
        f'({_text(summary["stiffness_error_percent"], "+.2f")} %), B_e '
        f'{_text(summary["damping"])} N s/m ({_text(summary["damping_error_percent"], "+.2f")} %)'
    )


def _print(summary: Mapping[str, Any], output: Path) -> None:
    latency = summary['latency_ms'] or {}
    delays = ', '.join(f'{name} {_text(value, ".2f")}' for name, value in latency.items())
    print(_title(summary))
    print(
        f'mean force {_text(summary["mean_force_n"], ".2f")} N over the hold, '
        f'{_text(summary["desired_force_n"], ".2f")} N wanted'
        + (_EQ20_NOTE if summary['law'] == 'eq20' and summary['mean_force_n'] else '')
    )
    print(
        f'{summary["samples_sent"]} samples at {_text(summary["rate_hz"], ".1f")} Hz, '
        f'{summary["samples_lost"]} lost, answered after [ms]: {delays}'
    )
    print(f'see {output}/summary.png, summary.json and recording/')


_LONGEST_S = 1e6
_EQ20_NOTE = ' (eq. 20 alone reaches about half; see reference_law series or force tracking)'


def _text(value: float | None, form: str = '.1f') -> str:
    return 'none' if value is None else format(value, form)


main = command(make_parser, run)


if __name__ == '__main__':
    raise SystemExit(main())
