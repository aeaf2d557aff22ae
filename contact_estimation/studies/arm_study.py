# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
The library on two arms simulated in MuJoCo: tool, stiffness, damping, node and diagnosis.

Needs the extras `robots`, `arms` and `tools`, and for the node `ros`.
"""

from __future__ import annotations

from functools import partial
import json
from pathlib import Path
import re
import shutil
import time
from typing import Any

from .arm_concealed_laws import ENGINE
from .arm_evaluation import (
    calibrated, Case, CONCEALED, concealed_case, diagnosed, diagnosis_of, errors, Estimated,
    estimated, kinematics_cost)
from .arm_files import ArmFiles, tool_parameters, world_of
from .arm_models import ARMS
from .arm_report import as_markdown, plot_contact, plot_frames
from .blind_trials.arm_trials import arm_text, run_arm_trials
from .speed_nodes import end_node, start_node
from ..commands.command_line import command, Parser
from ..exceptions import EstimationError, ParameterRangeError, UnknownNameError
from ..recordings import RecordingReader
from ..recordings.plain_decoding import decode_diagnostics, Vector3StampedDecoder

_START_S = 3.0
_LONGEST_S = 120.0
_TOPICS = {'stiffness': 'stiffness', 'stiffness_std': 'stiffness_std', 'damping': 'damping',
           'damping_std': 'damping_std', 'location': 'location'}


def live_run(files: ArmFiles, case: Case) -> tuple[dict[str, Any], Path]:
    """Play a run to the node in real time and record what it publishes."""
    recorded = files.path(f'live_{case.name}')
    shutil.rmtree(recorded, ignore_errors=True)  # of an interrupted study
    parameters = [f'{name}:={_yaml(value)}' for name, value in case.parameters.items()]
    nodes = [
        start_node('contact_estimation.ros.recorder_node', [f'output:={recorded}']),
        # The arm follows the reference that is played, not that of the node.
        start_node('contact_estimation.ros.estimator_node', parameters,
                   ['reference_trajectory:=unused_reference']),
    ]
    try:
        time.sleep(_START_S)
        nodes.append(
            start_node(f'{__package__}.arm_player_node', [f'recording:={case.recording}']))
        if nodes[-1].wait(_LONGEST_S) or any(node.poll() is not None for node in nodes[:2]):
            raise EstimationError(f'a node ended early: {[node.poll() for node in nodes]}')
    finally:
        for node in reversed(nodes):
            end_node(node)
    return errors(_last(recorded), case.run, case.world), recorded


def _yaml(value: Any) -> str:
    return json.dumps(list(value) if isinstance(value, tuple) else value)


def _last(recorded: Path) -> Estimated:
    """Return the last estimates that the node published."""
    reader, decoder = RecordingReader(recorded), Vector3StampedDecoder()
    topics = {f'/estimator_node/{topic}': name for name, topic in _TOPICS.items()}
    values = dict.fromkeys(_TOPICS, float('nan'))
    for message in reader.messages(list(topics)):
        value = decoder.decode(message.data)[1]
        if value == value:
            values[topics[message.topic]] = value
    return Estimated(
        'kalman', 'load and inertia, on line', values['stiffness'], values['stiffness_std'],
        values['damping'], values['damping_std'], values['location'],
        warnings=tuple(warned(reader)))


def warned(reader: RecordingReader) -> list[str]:
    """Return what a node has warned of, without remedies and numbers that change."""
    kinds: dict[str, str] = {}
    for message in reader.messages(['/diagnostics']):
        for status in decode_diagnostics(message.data):
            for key, text in status.values.items():
                if re.fullmatch(r'warning_\d+', key):
                    kinds.setdefault(re.sub(r'[-+.\d]+', '#', text), text.split(';')[0])
    return list(kinds.values())


_POSE_SEEDS = 3


def make_parser() -> Parser:
    """Build the command line of the study."""
    parser = Parser(
        prog='studies arms',
        description='Simulate arms in MuJoCo, with a wrist sensor, a tool of 1.2 kg and a tilted '
        'wall, record them, and compare what the library finds with the truth.',
    )
    parser.add_argument('arms', nargs='*', metavar='ARM',
                        help=f'any of {", ".join(ARMS)} (all)')
    parser.add_argument('--output', required=True, metavar='DIR',
                        help='folder for recordings, arms.md, arms.json and pictures; an '
                        'interrupted study continues where it stopped')
    parser.add_argument('--seeds', type=int, default=5,
                        help='diagnoses of each concealed effect on each arm (5); 0: none')
    parser.add_argument('--live', action='store_true',
                        help='also run the node over DDS on each arm, in real time, and diagnose '
                        'what its recorder has written')
    parser.add_argument('--concealed', type=int, default=0, metavar='N',
                        help='instead, diagnose N worlds on a planar arm, panda and ur5, in '
                        'which a law of a joint, a link or a sensor of torque is concealed from '
                        'diagnose --nominal-robot (0)')
    parser.add_argument('--seed', type=int, default=0, help='of --concealed (0)')
    return parser


def run(options: Any) -> int:
    """Run the study, print its tables and write them."""
    for name in options.arms:
        if name not in ARMS:
            raise UnknownNameError.among('arm', name, ARMS)
    if not 0 <= options.seeds <= 1000:
        raise ParameterRangeError(f'--seeds must be 0 to 1000, got {options.seeds}')
    if options.concealed < 0 or options.seed < 0:
        raise ParameterRangeError('--concealed and --seed must be >= 0, got '
                                  f'{options.concealed} and {options.seed}')
    folder = Path(options.output)
    folder.mkdir(parents=True, exist_ok=True)
    if options.concealed:
        table = arm_text(run_arm_trials(folder, options.concealed, options.seed, engine=ENGINE))
        (folder / 'concealed.txt').write_text(table + '\n')
        print(table)
        return 0
    results: dict[str, Any] = {'tool': [], 'contact': [], 'cost': [], 'diagnosis': []}
    for name in options.arms or ARMS:
        first = not results['tool']
        _study(ArmFiles(ARMS[name], folder), options, first, results)
    (folder / 'arms.json').write_text(json.dumps(results, indent=1) + '\n')
    (folder / 'arms.md').write_text(as_markdown(results))
    print(as_markdown(results))
    return 0


def _study(files: ArmFiles, options: Any, first: bool, results: dict[str, Any]) -> None:
    arm = {'arm': files.arm.name}
    for seed in range(_POSE_SEEDS):
        found = files.kept(f'tool_{seed}', partial(calibrated, files, seed))
        results['tool'].append({**arm, 'seed': seed, **found})
    tool = files.path('tool_0.yaml')
    for row in files.kept('contact', partial(_contact, files, tool, first)):
        results['contact'].append({**arm, **row})
    results['cost'].append({**arm, **files.kept('cost', partial(_cost, files, tool))})
    if options.live:
        for concealed in CONCEALED:
            kept = files.kept(f'live {concealed}'.replace(' ', '_'),
                              partial(_live, files, tool, concealed))
            if concealed == 'nothing':
                results['contact'].append({**arm, **kept['estimated']})
            results['diagnosis'].append({
                **arm, 'concealed': f'{concealed}, recorded by the node', 'seed': 0,
                **kept['diagnosed']})
    for concealed in CONCEALED:
        for seed in range(options.seeds):
            name = f'{concealed.replace(" ", "_")}_{seed}'
            results['diagnosis'].append(
                files.kept(name, partial(diagnosed, files, concealed, seed, tool)))


def _contact(files: ArmFiles, tool: Path, first: bool) -> list[dict[str, Any]]:
    world = world_of(0)
    simulated, recording = files.touch(world, 0, 'touch')
    if first:
        folder = recording.parent
        plot_contact(folder / 'arm_contact.png', files, simulated, recording, tool, world)
        plot_frames(folder / 'arm_frames.png', files, simulated)
    return [errors(row, simulated, world)
            for row in estimated(files, simulated, recording, tool)]


def _cost(files: ArmFiles, tool: Path) -> dict[str, Any]:
    simulated, _ = files.touch(world_of(0), 0, 'cost')
    return kinematics_cost(files, simulated, tool_parameters(tool))


def _live(files: ArmFiles, tool: Path, concealed: str) -> dict[str, Any]:
    """Play a run to the node, and diagnose what its recorder has written, as it is."""
    from .arm_study import live_run

    case = concealed_case(files, concealed, 0, tool)
    estimated, recorded = live_run(files, case)
    return {'estimated': estimated, 'diagnosed': diagnosis_of(files, case, recorded, concealed)}


main = command(make_parser, run)
