# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""`loop`: run plant, estimator and recorder on this machine and summarise the run."""

from contextlib import contextmanager
import json
import os
from pathlib import Path
import subprocess
import sys
from typing import Any, Iterator, Mapping

from .command_line import command, new_folder, Parser
from .progress import Progress
from .watch import rerun_file
from ..estimators import ONLINE_ESTIMATORS
from ..exceptions import RecordingError
from ..figures import as_png, require_matplotlib
from ..recordings.encoding import jazzy_typestore
from ..reference.experiments import EXPERIMENTS
from ..ros.loop_processes import (
    configure, LoopConfiguration, LoopProcesses, require_rclpy, write_parameters)
from ..ros.loop_run import (
    gap_explained, missing_estimates, plot_run, read_run, RecordedRun, summarise)
from ..watch.view import require_rerun, WEB, WINDOW

_NICENESS, _VIEW_TIMEOUT_S = 10, 60.0  # of the view, which is slow on a busy machine
_EQ20_NOTE = 'eq. (20) alone: {law:.1f} N; see reference_law series or force tracking'


def make_parser() -> Parser:
    """Build the command line of `loop`."""
    parser = Parser(
        prog='loop',
        description='Run plant, estimator and recorder as separate ROS 2 processes on this '
        'machine, play an experiment, and write a recording and a summary.')
    parser.add_argument('--duration', type=float,
                        help='length of the run in seconds (default: one experiment)')
    parser.add_argument('--output', required=True, metavar='DIR', help='new folder for results')
    parser.add_argument('--estimator', help='one of ' + ', '.join(ONLINE_ESTIMATORS))
    parser.add_argument(
        '--experiment', default='sine', metavar='NAME|FILE.yaml',
        help='one of ' + ', '.join(EXPERIMENTS) + ', or a YAML file of segments '
        '(default: %(default)s)')
    parser.add_argument(
        '--params', metavar='FILE',
        help='ROS 2 parameter file with sections estimator_node and plant_node')
    parser.add_argument('--seed', type=int, help='seed of all noise (default: that of --params)')
    parser.add_argument(
        '--lockstep', action='store_true',
        help='let the plant wait for the answer to each sample; the run is then the same on a '
        'slow or busy machine, but may take longer')
    parser.add_argument(
        '--watch', nargs='?', const=WINDOW, metavar='web|FILE.rrd',
        help='show the run live in Rerun: in a window, on a web page, or in a file')
    return parser


def run(options: Any) -> int:
    """Run the loop."""
    require_matplotlib()
    jazzy_typestore()
    require_rclpy('loop')
    watch = _watch_words(options.watch)
    configuration = configure(options.experiment, options.params, options.estimator,
                              options.duration, options.seed, lockstep=options.lockstep)
    output = new_folder(options.output)
    recording, plant_summary = output / 'recording', output / 'plant_summary.json'
    write_parameters(output / 'parameters.yaml', configuration, recording, plant_summary)
    progress = Progress('loop')
    with _watched(recording, watch):
        processes = LoopProcesses(output / 'parameters.yaml')
        failure = processes.run(configuration.duration, progress.show)
    progress.done()
    try:
        data = read_run(recording, plant_summary)
    except RecordingError:
        if not failure:
            raise
    else:
        _write_summary(data, configuration, output)
        failure = failure or missing_estimates(data)
    if failure:
        print(f'loop: {failure}', file=sys.stderr)
    return 1 if failure else 0


def _watch_words(given: str | None) -> list[str] | None:
    """Return the options of `watch`; None for no view."""
    if given is None:
        return None
    require_rerun()
    if given in (WINDOW, WEB):
        return ['--web'] if given == WEB else []
    return ['--save', rerun_file(given)]


@contextmanager
def _watched(recording: Path, words: list[str] | None) -> Iterator[None]:
    """Show the recording while it is written, in a low-priority process without subscriptions."""
    if words is None:
        yield
        return
    watcher = subprocess.Popen(
        [sys.executable, '-m', 'contact_estimation', 'watch', str(recording), '--follow', *words],
        start_new_session=True, preexec_fn=lambda: os.nice(_NICENESS))
    try:
        yield
        watcher.wait(_VIEW_TIMEOUT_S)  # until it has shown the end
    except subprocess.TimeoutExpired:
        print('loop: the view did not end and was stopped', file=sys.stderr)
    finally:
        watcher.terminate()
        watcher.wait()


def _write_summary(data: RecordedRun, configuration: LoopConfiguration, output: Path) -> None:
    """Write and print the summary of what was recorded."""
    summary = summarise(data, configuration)
    (output / 'summary.json').write_text(json.dumps(summary, indent=1) + '\n')
    figure = plot_run(data, _title(summary), configuration.plant.environment,
                      _gap_note(summary), _warning(summary))
    (output / 'summary.png').write_bytes(as_png(figure))
    print(_as_text(summary))
    print(f'wrote summary.png, summary.json and recording/ in {output}')


def _title(summary: Mapping[str, Any]) -> str:
    return (
        f'{summary["estimator"]}, law {summary["law"]}: K_e {_number(summary["stiffness"])} N/m '
        f'({_number(summary["stiffness_error_percent"], "+.2f")} %), B_e '
        f'{_number(summary["damping"])} N s/m '
        f'({_number(summary["damping_error_percent"], "+.2f")} %)')


def _as_text(summary: Mapping[str, Any]) -> str:
    latency = ', '.join(f'{name} {_number(value, ".2f")}'
                        for name, value in (summary['latency_ms'] or {}).items())
    note = _gap_note(summary)
    lines = [
        _title(summary),
        f'mean force {_number(summary["mean_force_n"], ".2f")} N over the hold, desired '
        f'{_number(summary["desired_force_n"], ".2f")} N{note and f" ({note})"}',
        f'{summary["samples_sent"]} samples at {_number(summary["rate_hz"], ".1f")} Hz, '
        f'{summary["samples_lost"]} dropped, latency [ms]: {latency or "none"}']
    if summary['disturbed']:
        lines.append(_warning(summary))
    return '\n'.join(lines)


def _gap_note(summary: Mapping[str, Any]) -> str:
    """Return why the force is not the desired one, where the law explains it."""
    return _EQ20_NOTE.format(law=summary['eq20_force_n']) if gap_explained(summary) else ''


def _warning(summary: Mapping[str, Any]) -> str:
    reasons = '; '.join(summary['disturbed'])
    return f'disturbed run: {reasons}' if reasons else ''


def _number(value: float | None, form: str = '.1f') -> str:
    return 'none' if value is None else format(value, form)


main = command(make_parser, run)
