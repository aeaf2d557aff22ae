# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Estimate stiffness and damping from a recording, off-line and faster than real time."""

from contextlib import ExitStack
from functools import partial
import gc
import time
from typing import Any, Sequence

from .command_line import (
    add_params_option, add_source_options, add_tare_option, as_json, check_outputs,
    chosen_parameters, command, new_file, Parser, print_columns, reading_of, replayed_parameters,
    source_of, topics_of, write_results)
from .progress import Progress
from .replay_summary import (
    picture_trace, print_summary, refuse_empty, Replayed, summary_of, write_picture)
from ..estimators import ONLINE_ESTIMATORS
from ..exceptions import ContactEstimationError, ParameterRangeError, UnknownNameError
from ..pipeline.estimate_files import CsvEstimates, EstimateTrace, McapEstimates
from ..pipeline.replay import RecordingReplay
from ..plant.plant_parameters import PlantParameters
from ..recordings import RecordingReader

_EXPLAINING = ('stamp_order', 'stamp_bursts', 'clock_offset', 'force_sign', 'position_sign')


def make_parser() -> Parser:
    """Build the command line of `replay`."""
    parser = Parser(
        prog='replay',
        description='Estimate contact stiffness and damping from a recording. Parameters and '
        'their changes at run time are taken from the recording where it has them.')
    parser.add_argument('recording', metavar='RECORDING',
                        help='an .mcap file, a rosbag2 folder or a table (CSV, Parquet, MAT)')
    parser.add_argument('--estimator', help='one of ' + ', '.join(ONLINE_ESTIMATORS))
    add_params_option(parser, '')
    parser.add_argument('--output', help='write the estimates as MCAP')
    parser.add_argument('--csv', help='write the estimates as CSV')
    parser.add_argument('--json', help='write a summary as JSON')
    parser.add_argument('--picture', metavar='FILE.png',
                        help='plot force, motion and the estimates with their bands')
    add_source_options(parser)
    add_tare_option(parser)
    parser.add_argument(
        '--further', action='append', default=[], metavar='AXIS:=JOINT',
        help='also estimate this axis; may be given twice')
    return parser


def run(options: Any) -> int:
    """Replay the recording, write the requested files and print a summary."""
    # Millions of small tuples and no cycles: garbage collection would take a fifth of the time.
    gc.disable()
    begin = time.perf_counter()
    check_outputs((options.csv, options.json, options.output, options.picture), {
        'the recording': [options.recording], 'a parameter file': options.params})
    trace = picture_trace(options.picture)
    source = source_of(options)
    reader = RecordingReader(options.recording, source)
    print_columns(reader)
    chosen = {**replayed_parameters(options), **_further(options.further)}
    replay = RecordingReplay(reader, source, chosen)
    with ExitStack() as stack:
        files = [*_open_files(options, ''.join(replay.session.pipelines), stack),
                 *filter(None, (trace,))]
        replayed = _replay(replay, reader, files)
    refuse_empty(reader, replay, replayed, partial(_cause, options))
    summary = summary_of(replay, reader, replayed, time.perf_counter() - begin)
    write_results(options, {'json': lambda: as_json(summary)})
    print_summary(summary)
    if trace is not None:
        write_picture(options.picture, reader, source, replay.session.parameters, trace)
    return 0


def _cause(options: Any) -> str:
    """Return what `diagnose` would say of a recording that gives no estimate."""
    from ..diagnosis.checks import check  # slow to import, and seldom needed
    from ..diagnosis.observe.signals import read_recording
    try:
        recording = read_recording(
            options.recording, topics=topics_of(options), axis=options.axis or 'x',
            joint=options.joint or '', parameters=chosen_parameters(options),
            **reading_of(options))
        checks, _ = check(recording, PlantParameters())
    except ContactEstimationError as error:
        return str(error)
    return '; '.join(f'{one.name}: {one.text}' for one in checks if one.name in _EXPLAINING
                     and one.fatal)


def _replay(
    replay: RecordingReplay, reader: RecordingReader,
    files: Sequence[CsvEstimates | McapEstimates | EstimateTrace],
) -> Replayed:
    """Write all estimates and return what the summary needs of them."""
    progress, replayed = Progress('replay'), Replayed()
    for estimates in filter(None, replay.estimates()):
        matrices = replay.session.matrix.take()
        for file in files:
            file.write(estimates)
            file.write_matrices(matrices)
        replayed.add(estimates)
        progress.show(reader.progress, f'{replayed.samples} samples')
    progress.done()
    return replayed


def _further(given: Sequence[str]) -> dict[str, str]:
    """Convert --further to parameters."""
    chosen = {}
    for text in given:
        axis, found, joint = text.partition(':=')
        if not found or not joint:
            raise ParameterRangeError(
                f'--further must be AXIS:=JOINT, got {text!r}; such as y:=contact_y')
        if axis not in ('x', 'y', 'z'):
            raise UnknownNameError.among('axis of --further', axis, ('x', 'y', 'z'))
        chosen[f'further_axes.{axis}.joint'] = joint
    return chosen


def _open_files(options: Any, axes: str, stack: ExitStack) -> list[CsvEstimates | McapEstimates]:
    files: list[CsvEstimates | McapEstimates] = []
    if options.csv:
        files.append(stack.enter_context(CsvEstimates(new_file(options.csv), axes)))
    if options.output:
        files.append(stack.enter_context(McapEstimates(new_file(options.output), axes)))
    return files


main = command(make_parser, run)
