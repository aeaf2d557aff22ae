# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""`simulate`: run a plant model off-line on a recorded command or force, or an experiment."""

from pathlib import Path
from typing import Any

import numpy as np

from .command_line import (
    add_source_options, command, different_files, new_file, Parser, require_at_least, source_of)
from .replay_summary import picture_trace, write_picture
from ..exceptions import ParameterRangeError, RecordingError
from ..pipeline.estimate_files import EstimateTrace
from ..pipeline.replay import RecordingReplay
from ..plant.driven_wall import BETWEEN
from ..plant.plant_parameters import PlantNodeParameters, PlantParameters, read_model
from ..plant.simulation import (
    simulate_command, simulate_experiment, simulate_force, Simulation, write_simulation)
from ..recordings import RecordingReader
from ..recordings.recorded_signals import read_signals, RecordedSignals
from ..recordings.source import RecordingSource
from ..reference.experiments import experiment_named, EXPERIMENTS


def make_parser() -> Parser:
    """Build the command line of `simulate`."""
    parser = Parser(
        prog='simulate',
        description='Simulate a model on the command of a recording, sampled at its stamps, or '
        'on an experiment. A permanently attached wall without a robot is driven by the recorded '
        'force.')
    parser.add_argument('--model', required=True, metavar='FILE', help='model file (YAML)')
    given = parser.add_mutually_exclusive_group(required=True)
    given.add_argument('--like', metavar='RECORDING',
                       help='.mcap file, rosbag2 folder or table whose command is repeated')
    given.add_argument(
        '--experiment', metavar='NAME|FILE.yaml',
        help='one of ' + ', '.join(EXPERIMENTS) + ', or a YAML file of segments')
    parser.add_argument('--output', required=True, metavar='FILE',
                        help='.mcap file to write; must not exist')
    parser.add_argument('--seed', type=int,
                        help='seed of all noise (default: that of the model file)')
    parser.add_argument(
        '--between', choices=tuple(BETWEEN), default='straight',
        help='interpolation of the recorded reference (straight or held) or of the force that '
        'drives an attached wall (default: straight); `diagnose` reports which the data support')
    parser.add_argument('--picture', metavar='FILE.png',
                        help='plot force, motion and what `replay` estimates from them')
    add_source_options(parser)
    return parser


def run(options: Any) -> int:
    """Simulate and write the recording."""
    output = _new_recording(options.output)
    different_files((options.output, options.picture), {
        'the model file': [options.model], 'the recording': [options.like],
        'the experiment': [options.experiment]})
    trace = picture_trace(options.picture)
    require_at_least(options, seed=0)
    model = read_model(options.model, options.seed)
    frame_id = PlantNodeParameters().frame_id
    if options.like:
        source = source_of(options)
        reader = RecordingReader(options.like, source)
        signals = read_signals(reader, source, options.axis or 'x', options.joint or '')
        simulation = _simulate_like(model, signals, options)
        frame_id = signals.frame_id
    else:
        simulation = simulate_experiment(model, experiment_named(options.experiment))
    joint = options.joint or PlantNodeParameters().joint
    write_simulation(output, simulation, options.axis or 'x', joint, frame_id)
    if trace is not None:
        _write_picture(options, model, joint, trace)
    seconds = (simulation.stamp_ns[-1] - simulation.stamp_ns[0]) * 1e-9
    print(f'{len(simulation.stamp_ns)} samples, {seconds:.1f} s, maximum pressing force '
          f'{max(0.0, -float(np.min(simulation.measured[0]))):.4g} N; wrote {output}')
    return 0


def _new_recording(path: str) -> Path:
    """Refuse an output that cannot be written, before the simulation starts."""
    file = Path(path)
    if file.exists():
        raise RecordingError(
            f'--output {path} exists, and recordings are never overwritten; choose another file')
    return new_file(path)


def _simulate_like(model: PlantParameters, signals: RecordedSignals, options: Any) -> Simulation:
    wrench, reference, recording = signals.wrench, signals.reference_trajectory, options.like
    if len(reference):
        if options.between not in ('straight', 'held'):
            raise ParameterRangeError(
                f'--between of a reference must be straight or held, got {options.between}; '
                'other courses are for the force that drives an attached wall')
        start, held = _start(signals), options.between == 'held'
        return simulate_command(
            model, wrench.stamp_ns, reference.stamp_ns, reference.values, start, held)
    if model.environment.unilateral:
        raise RecordingError(
            f'{recording} has no reference_trajectory; expected one, because only a permanently '
            'attached wall (environment.unilateral false) can be simulated without a robot; '
            'choose the topic with --topic reference_trajectory:=/name')
    if len(wrench) < 2:
        raise RecordingError(f'{recording} must have at least 2 wrenches, got {len(wrench)}')
    return simulate_force(
        model, wrench.stamp_ns, wrench.values[0], _start(signals), options.between)


def _write_picture(options: Any, model: PlantParameters, joint: str, trace: EstimateTrace) -> None:
    """Replay what was written, and plot it with the estimates beside the true values."""
    reader, source, wall = RecordingReader(options.output), RecordingSource(), model.environment
    parameters = {'axis': options.axis or 'x', 'joint': joint, 'sample_rate': model.sample_rate,
                  'environment.location': wall.location}
    replay = RecordingReplay(reader, source, parameters)
    if wall.unilateral:  # an attached wall has no contacts to estimate in
        for estimates in replay.estimates():
            trace.write(estimates)
    true = {'stiffness': wall.stiffness, 'damping': wall.damping}
    write_picture(options.picture, reader, source, replay.session.parameters, trace, true)


def _start(signals: RecordedSignals) -> tuple[float, float]:
    """Return position and velocity at the first wrench."""
    joints, first = signals.joint_states, int(signals.wrench.stamp_ns[0])
    t = (joints.stamp_ns - first) * 1e-9
    position = float(np.interp(0.0, t, joints.values[0]))
    if np.all(np.isfinite(joints.values[1])):
        return position, float(np.interp(0.0, t, joints.values[1]))
    if len(signals.reference_trajectory):
        reference = signals.reference_trajectory
        since = (reference.stamp_ns - first) * 1e-9
        return position, float(np.interp(0.0, since, reference.values[1]))
    near = np.argsort(np.abs(t), kind='stable')[:3]
    slope = np.polyfit(t[near], joints.values[0][near], 1)[0] if len(near) == 3 else 0.0
    return position, float(slope)


main = command(make_parser, run)
