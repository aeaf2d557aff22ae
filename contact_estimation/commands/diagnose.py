# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""`diagnose`: name the physics that a simulation of recorded contacts lacks."""

from dataclasses import replace
from itertools import combinations
from pathlib import Path
from typing import Any, Sequence

from .command_line import (
    add_params_option, add_source_options, add_tare_option, as_json, check_outputs,
    chosen_parameters, command, new_file, Parser, reading_of, topics_of, write_results)
from .diagnose_arm import comparison_text, names_of, run as run_arm
from .progress import Progress
from ..diagnosis.diagnose import diagnose, diagnose_simulation, simulation_text
from ..diagnosis.fit.free_run import plant_of
from ..diagnosis.next_experiment import choose, Proposal
from ..diagnosis.observe.signals import read_recording, Recording
from ..diagnosis.report.json_report import as_dict, model_file
from ..diagnosis.report.page import as_html
from ..diagnosis.report.text_report import as_text
from ..diagnosis.result import Diagnosis
from ..exceptions import ParameterRangeError, RecordingError, UnknownNameError
from ..figures import require_matplotlib
from ..plant.engines import ENGINES
from ..plant.plant_parameters import read_model
from ..recordings.bag_folder import share_data
from ..reference.experiments import experiment_text


def make_parser() -> Parser:
    """Build the command line of `diagnose`."""
    parser = Parser(
        prog='diagnose',
        description='Compare recordings with the model that simulates them. The verdict is '
        'consistent, recalibrate, physics missing or unexplained; missing physics are named, '
        'fitted and tested on held-out data.')
    parser.add_argument('recordings', metavar='RECORDING', nargs='+',
                        help='.mcap file, rosbag2 folder or table (CSV, Parquet, MAT)')
    parser.add_argument('--nominal', metavar='MODEL.yaml',
                        help='model file of the simulation (section plant_node)')
    parser.add_argument('--nominal-robot', metavar='ARM.urdf',
                        help='URDF of an arm, which is diagnosed joint by joint from joint '
                        'states with efforts and, in contact, wrenches; --nominal is then the '
                        'model of what the arm touches (needs the extra robots)')
    parser.add_argument('--simulation', metavar='SIM',
                        help='recording of any simulator under the same commands, whose model '
                        'is identified first (from --nominal, if given) and used as the nominal '
                        'model')
    parser.add_argument('--holdout', metavar='RECORDING', nargs='+', default=[], action='extend',
                        help='recordings excluded from fitting, to test on (default: a part of '
                        'each recording is held out)')
    parser.add_argument('--json', metavar='FILE', help='write the report as JSON')
    parser.add_argument('--html', metavar='FILE',
                        help='write the report with figures as one HTML file')
    parser.add_argument('--write-model', metavar='FILE', help='write the corrected model file')
    parser.add_argument('--export', nargs=2, action='append', default=[],
                        metavar=('ENGINE', 'FILE'),
                        help='write the corrected contact for an engine: ' + ', '.join(ENGINES)
                        + '; may be repeated')
    parser.add_argument('--write-urdf', metavar='FILE',
                        help='write the corrected robot description, and FILE.mjcf with friction, '
                        'damping and armature for MuJoCo')
    parser.add_argument('--write-trajectory', metavar='FILE.csv',
                        help='write a motion within the limits of --nominal-robot that identifies '
                        'the inertia of its links, also as a JointTrajectory in FILE.yaml')
    parser.add_argument('--write-comparison', metavar='FILE',
                        help='write all compared models with their cross-validation errors as '
                        'JSON')
    parser.add_argument('--seed', type=int, default=0,
                        help='seed of the bootstraps (default: %(default)s)')
    add_params_option(
        parser, ': its arm (kinematics.*, contact.normal, tool.*, the inertia of the tool '
        'physics.tool_inertia.mass) and force_sign; default: as recorded')
    add_source_options(parser)
    add_tare_option(parser)
    return parser


def run(options: Any) -> int:
    """Diagnose, write the requested files and print the report."""
    if options.nominal_robot:
        return run_arm(options)
    _check(options)
    if options.html:
        require_matplotlib()
    nominal = read_model(options.nominal) if options.nominal else None
    refuse_same_data(options.recordings, options.holdout, options.simulation)
    progress = Progress('diagnose')
    stage = progress.stage(80)
    recordings, held_out, simulations = (
        [_read(path, options) for path in paths]
        for paths in (options.recordings, options.holdout, filter(None, [options.simulation])))
    simulated = None
    for one in simulations:
        nominal, simulated = diagnose_simulation(one, nominal, seed=options.seed, progress=stage)
    assert nominal is not None
    diagnosis = diagnose(recordings, nominal, held_out=held_out, seed=options.seed, progress=stage)
    progress.done()
    proposal = choose(diagnosis)
    if proposal is not None:
        diagnosis = replace(diagnosis, next_experiment=proposal.text)
    # Before the text: piped into `head`, it may end here.
    _write(diagnosis, proposal, options, simulated)
    for recording in filter(lambda one: one.tare, (*recordings, *held_out)):
        print(f'{recording.name}: {recording.tare}')
    if simulated is not None:
        print(f'Simulation {options.simulation}: {simulation_text(simulated, nominal)}\n')
    print(as_text(diagnosis))
    return 0


def _check(options: Any) -> None:
    """Refuse options that do not fit together, and results that cannot be written."""
    for name in ('write_urdf', 'write_trajectory'):
        if getattr(options, name):
            raise ParameterRangeError(
                f'--{name.replace("_", "-")} needs --nominal-robot ARM.urdf; give it in place of '
                '--nominal')
    if not options.nominal and not options.simulation:
        raise ParameterRangeError(
            'one of --nominal MODEL.yaml (a contact), --simulation SIM (its recording) and '
            '--nominal-robot ARM.urdf (a whole arm) must be given, got none; see diagnose --help')
    for engine, _ in options.export:
        if engine not in ENGINES:
            raise UnknownNameError.among('engine of --export', engine, ENGINES)
    check_outputs(
        (options.json, options.html, options.write_model, options.write_comparison,
         _experiment_file(options), *(file for _, file in options.export)),
        {'the nominal model file': [options.nominal], 'a parameter file': options.params,
         'a recording': [*options.recordings, *options.holdout, options.simulation]})


def _read(path: str, options: Any) -> Recording:
    return read_recording(
        path, topics=topics_of(options), axis=options.axis or 'x', joint=options.joint or '',
        parameters=chosen_parameters(options), **reading_of(options))


def refuse_same_data(
    fitted: Sequence[str], held_out: Sequence[str], simulation: str | None
) -> None:
    """Refuse to count a recording twice, to test on the data of the fit, and to simulate it."""
    for path in (*fitted, *held_out):
        if simulation and share_data(path, simulation):
            raise RecordingError(
                f'--simulation {simulation} must be the recording of a simulator, but holds the '
                f'same data as {path}')
    for one, other in combinations(fitted, 2):
        if share_data(one, other):
            raise RecordingError(
                f'every recording must be given once, but {one} holds the same data as {other}: '
                'parts that are predicted from themselves prove nothing; leave one of them out')
    for tested in held_out:
        for path in fitted:
            if share_data(tested, path):
                raise RecordingError(
                    f'--holdout {tested} must be another recording than those of the fit, but '
                    f'holds the same data as {path}: a test on the data of the fit proves '
                    'nothing; hold out another recording, or leave --holdout out')


def _write(
    diagnosis: Diagnosis, proposal: Proposal | None, options: Any, simulated: Diagnosis | None
) -> None:
    experiment = None if proposal is None else _experiment_file(options)
    if proposal is not None and experiment is not None:
        new_file(experiment).write_text(experiment_text(proposal.experiment))
    report = as_dict(diagnosis, experiment)
    if simulated is not None:
        report['simulation'] = as_dict(simulated)
    write_results(options, {
        'json': lambda: as_json(report, allow_nan=False),
        'html': lambda: as_html(diagnosis, names_of(options.recordings), experiment),
        'write_comparison': lambda: comparison_text(diagnosis.compared),
        'write_model': lambda: model_file(diagnosis)})
    for engine, file in options.export:
        new_file(file).write_text(ENGINES[engine](plant_of(diagnosis.corrected)))


def _experiment_file(options: Any) -> str | None:
    """Return the file for the next experiment, beside the report; None without a report."""
    beside = options.json or options.html
    return str(Path(beside).with_suffix('.experiment.yaml')) if beside else None


main = command(make_parser, run)
