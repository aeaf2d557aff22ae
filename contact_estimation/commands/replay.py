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

"""Estimate stiffness and damping from a recording, off-line and faster than real time."""

from __future__ import annotations

from contextlib import ExitStack
import gc
import json
from math import isfinite
import sys
import time
from typing import Any, Protocol, Sequence

import numpy as np

from .command_line import add_source_options, command, different_files, new_file, Parser, source_of
from .picture import picture_trace, write_picture
from .progress import Progress
from ..estimation.estimate_files import CsvEstimates, McapEstimates, stamp_text
from ..estimation.model_fit import ModelFitMonitor
from ..estimation.replay import RecordingReplay
from ..estimation.result import AxesEstimates
from ..estimators import ESTIMATORS
from ..estimators.estimator import Estimate, EstimateStatus
from ..estimators.stiffness_matrix import MatrixEstimate
from ..exceptions import ParameterRangeError, RecordingError, UnknownNameError
from ..parameters.file import read_parameter_file
from ..parameters.values import without
from ..recordings import RecordingReader
from ..ros.estimator_node_parameters import EstimatorNodeParameters


_SAID_OTHERWISE = ('model_fit', 'sample_rate')  # warnings that the summary states anyway


class EstimateFile(Protocol):
    """A file of estimates."""

    def write(self, estimates: Sequence[AxesEstimates]) -> None:
        """Append the estimates of consecutive samples."""

    def write_matrices(self, estimates: Sequence[MatrixEstimate]) -> None:
        """Append estimates of three coupled axes."""


def make_parser() -> Parser:
    """Build the command line of `replay`."""
    parser = Parser(
        prog='replay',
        description='Estimate contact stiffness and damping from a recording. Parameters and '
        'their changes at run time are taken from the recording where it has them.',
    )
    parser.add_argument('recording', metavar='RECORDING', help='an .mcap file or rosbag2 folder')
    parser.add_argument('--estimator', help='one of ' + ', '.join(ESTIMATORS))
    parser.add_argument('--params', help='ROS 2 parameter file of estimator_node')
    parser.add_argument('--output', help='write the estimates as MCAP')
    parser.add_argument('--csv', help='write the estimates as CSV')
    parser.add_argument('--json', help='write a summary as JSON')
    parser.add_argument('--picture', metavar='FILE.png',
                        help='plot force, motion and the estimates with their bands')
    add_source_options(parser)
    parser.add_argument(
        '--further', action='append', default=[], metavar='AXIS:=JOINT',
        help='also estimate this axis; may be given twice',
    )
    return parser


def run(options: Any) -> int:
    """
    Replay the recording, write the requested files and print a summary.

    Parameters
    ----------
    options : argparse.Namespace
        Options of `make_parser`.

    Returns
    -------
    code : int
        0.

    """
    # Millions of small tuples and no cycles: garbage collection would take a fifth of the time.
    gc.disable()
    begin = time.perf_counter()
    different_files((options.csv, options.json, options.output, options.picture))
    if options.json:
        new_file(options.json)
    trace = picture_trace(options.picture)
    reader = RecordingReader(options.recording)
    replay = RecordingReplay(reader, source_of(options), _chosen(options))
    progress = Progress('replay')
    axes = ''.join(replay.session.pipelines)
    first: Estimate | None = None
    last: AxesEstimates = ()
    samples = 0
    seen: set[EstimateStatus] = set()
    with ExitStack() as stack:
        files = [*_open_files(options, axes, stack), *filter(None, (trace,))]
        for estimates in replay.estimates():
            if not estimates:
                continue
            matrices = replay.session.matrix.take()
            for file in files:
                file.write(estimates)
                file.write_matrices(matrices)
            first, last = first or estimates[0][0], estimates[-1]
            samples += len(estimates)
            seen.update([own.status for axes in estimates for own in axes])
            progress.show(reader.progress, f'{samples} samples')
    progress.done()
    if first is None:
        raise RecordingError(_no_sample(options.recording, replay))
    if EstimateStatus.ESTIMATING not in seen:
        raise RecordingError(_nothing_estimated(options.recording, replay, last[0], seen))
    _warn_about_rate(replay)
    recorded_s = (last[0].stamp_ns - first.stamp_ns) * 1e-9
    summary: dict[str, Any] = {
        'estimator': replay.session.parameters.estimator,
        'samples': samples,
        **_finite(last[0]),
        'status': last[0].status.value,
        'model_fit': _fit_of(replay.session.pipeline.model_fit),
        'warnings': _warnings_of(replay),
        'recorded_s': recorded_s,
        'wall_s': time.perf_counter() - begin,
        'rejected': dict(replay.session.rejected),
        'missing': replay.session.pipeline.missing,
        'truncated': reader.truncated,
        'damaged_chunks': reader.damaged_chunks,
    }
    if len(axes) > 1:
        summary['axes'] = {
            axis: {**_finite(e), 'status': e.status.value, 'model_fit': _fit_of(own.model_fit)}
            for (axis, own), e in zip(replay.session.pipelines.items(), last)
        }
    if replay.session.matrix.last:
        summary['stiffness_matrix'] = {
            name: np.asarray(value).tolist()
            for name, value in replay.session.matrix.last._asdict().items()
        }
    if options.json:
        new_file(options.json).write_text(json.dumps(summary, indent=1) + '\n')
    if trace is not None:
        write_picture(options.picture, reader, source_of(options), replay.session.parameters,
                      trace)
    _print(summary)
    return 0


def _chosen(options: Any) -> dict[str, Any]:
    chosen = read_parameter_file(options.params, 'estimator_node') if options.params else {}
    chosen = without(EstimatorNodeParameters, chosen)
    if options.estimator:
        if options.estimator not in ESTIMATORS:
            raise UnknownNameError.among('estimator', options.estimator, ESTIMATORS)
        chosen['estimator'] = options.estimator
    for name in ('axis', 'joint'):
        if getattr(options, name) is not None:
            chosen[name] = getattr(options, name)
    return {**chosen, **_further(options.further)}


def _further(given: Sequence[str]) -> dict[str, str]:
    """Convert --further to parameters."""
    chosen = {}
    for text in given:
        axis, found, joint = text.partition(':=')
        if not found or not joint:
            raise ParameterRangeError(
                f'--further must be AXIS:=JOINT, got {text!r}; such as y:=contact_y'
            )
        if axis not in ('x', 'y', 'z'):
            raise UnknownNameError.among('axis of --further', axis, ('x', 'y', 'z'))
        chosen[f'further_axes.{axis}.joint'] = joint
    return chosen


def _open_files(options: Any, axes: str, stack: ExitStack) -> list[EstimateFile]:
    files: list[EstimateFile] = []
    if options.csv:
        files.append(stack.enter_context(CsvEstimates(new_file(options.csv), axes)))
    if options.output:
        files.append(stack.enter_context(McapEstimates(new_file(options.output), axes)))
    return files


def _warn_about_rate(replay: RecordingReplay) -> None:
    rate, period = replay.session.parameters.sample_rate, replay.session.pipeline.sample_period_s
    if period > 0.0 and not 0.9 < period * rate < 1.1:
        print(f'  samples arrive at {1.0 / period:.4g} Hz, but sample_rate is {rate:g}; set it '
              'with --params, since filters and rls depend on it', file=sys.stderr)


def _no_sample(recording: str, replay: RecordingReplay) -> str:
    reasons = ', '.join(f'{count} {reason}' for reason, count in replay.session.rejected.items())
    return (
        f'no usable sample in {recording}: expected wrenches with joint states at or around '
        f'their stamps, got {reasons or "none"}; check topics, joint and stamps'
    )


def _nothing_estimated(
    recording: str, replay: RecordingReplay, last: Estimate, seen: set[EstimateStatus]
) -> str:
    """Say why there is nothing but the first guess."""
    axis = next(iter(replay.session.pipelines))
    causes = [found.warned.text for found in replay.session.checks.found_in_order()]
    cause = causes[0] if causes else ''
    if seen == {EstimateStatus.FREE}:
        return (f'no contact seen in {recording}: '
                f'{cause or replay.session.checks.why_no_contact(axis)}')
    return f'nothing could be estimated in {recording}: {cause or last.reason}'


def _warnings_of(replay: RecordingReplay) -> list[dict[str, str]]:
    """Return every warning of the recording, the most important first."""
    return [
        {'name': found.warned.name, 'axis': found.warned.axis, 'text': found.warned.text,
         'first_stamp': stamp_text(found.first_ns), 'last_stamp': stamp_text(found.last_ns)}
        for found in replay.session.checks.found_in_order()
    ]


def _finite(estimate: Estimate) -> dict[str, float | None]:
    names = ('stiffness', 'damping', 'stiffness_std', 'damping_std', 'location', 'inertia')
    values = {name: getattr(estimate, name) for name in names}
    return {name: value if isfinite(value) else None for name, value in values.items()}


def _fit_of(monitor: ModelFitMonitor) -> dict[str, Any]:
    """Return how the model fits the last contact, and the worst mismatch of the recording."""
    now, worst = monitor.now.ratio, monitor.worst
    return {
        'ratio': now if isfinite(now) else None,
        'mismatches': monitor.count,
        'worst_ratio': worst.ratio if worst.text else None,
        'worst_stamp': stamp_text(worst.stamp_ns) if worst.text else None,
        'text': worst.text,
    }


def _print(summary: dict[str, Any]) -> None:
    speed = summary['recorded_s'] / max(summary['wall_s'], 1e-9)
    print(f'{summary["estimator"]}: {summary["samples"]} samples, {summary["recorded_s"]:.1f} s '
          f'recorded, replayed in {summary["wall_s"]:.1f} s ({speed:.0f} times real time)')
    for name, unit in (('stiffness', 'N/m'), ('damping', 'N s/m'), ('location', 'm'),
                       ('inertia', 'kg')):
        value, std = summary[name], summary.get(f'{name}_std')
        if value is not None:
            band = f' +- {std:.3g}' if std is not None else ''
            print(f'  {name:<10}{value:12.6g}{band} {unit}')
    print(f'  status    {summary["status"]:>12}')
    if summary['model_fit']['text']:
        print(f'  model     {summary["model_fit"]["text"]} '
              f'(until {summary["model_fit"]["worst_stamp"]} s)')
    for found in summary['warnings']:
        if found['name'] not in _SAID_OTHERWISE:
            print(f'  warning: {found["text"]} (until {found["last_stamp"]} s)', file=sys.stderr)
    if 'stiffness_matrix' in summary:
        _print_matrix(summary['stiffness_matrix'])
    for axis, own in list(summary.get('axes', {}).items())[1:]:
        print(f'  axis {axis}: stiffness {own["stiffness"]:.6g} N/m, damping {own["damping"]:.6g} '
              f'N s/m, {own["status"]}')
    for name, count in {**summary['rejected'], 'missing': summary['missing']}.items():
        if count:
            print(f'  {count} samples {name}', file=sys.stderr)
    if summary['truncated'] or summary['damaged_chunks']:
        print(f'  the recording is cut short or damaged ({summary["damaged_chunks"]} damaged '
              'chunks); all intact data were used', file=sys.stderr)


def _print_matrix(found: dict[str, Any]) -> None:
    for value, std, direction in zip(
        found['principal'], found['principal_std'], found['directions']
    ):
        along = ', '.join(f'{part:.3f}' for part in direction)
        print(f'  principal stiffness {value:.6g} +- {std:.3g} N/m along ({along})')
    normal = ', '.join(f'{part:.3f}' for part in found['normal'])
    print(f'  normal into the wall ({normal}) +- {found["normal_std"]:.2g} rad')


main = command(make_parser, run)


if __name__ == '__main__':
    raise SystemExit(main())
