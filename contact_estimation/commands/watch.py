# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""`watch`: a running estimator, or a recording, in Rerun."""

from pathlib import Path
import signal
import sys
from threading import Event
from typing import Any, Sequence

from .command_line import (
    add_params_option, add_source_options, command, different_files, new_file, Parser,
    replayed_parameters, source_of)
from .progress import Progress
from ..estimators import ONLINE_ESTIMATORS
from ..exceptions import ParameterRangeError, RecordingError
from ..pipeline.replay import RecordingReplay
from ..recordings import RecordingReader
from ..ros.loop_processes import require_rclpy
from ..watch.view import (
    ContactView, follow_recording, require_rerun, show, show_recording, WEB, WINDOW)

_OF_RECORDINGS = ('follow', 'topic', 'columns', 'units', 'wrench_field', 'axis', 'joint', 'params',
                  'estimator')
_FOLLOWED_S = 20.0  # shown of a recording that is being written


def make_parser() -> Parser:
    """Build the command line of `watch`."""
    parser = Parser(
        prog='watch',
        description='Show force, motion, stiffness and damping with their bands, status and '
        'checks in Rerun: of a running estimator, or of a recording, which is replayed.',
        epilog='Words after --ros-args go to ROS 2, such as -r wrench:=/fts/wrench.')
    parser.add_argument('recording', metavar='RECORDING', nargs='?',
                        help='an .mcap file, a rosbag2 folder or a table (CSV, Parquet, MAT) '
                        '(default: the running estimator)')
    where = parser.add_mutually_exclusive_group()
    where.add_argument('--web', action='store_true',
                       help='serve a web page instead of opening a window')
    where.add_argument('--save', metavar='FILE.rrd', help='write a file for Rerun instead')
    parser.add_argument('--follow', action='store_true',
                        help='show the RECORDING while it is written, with its own estimates')
    parser.add_argument('--node', default='estimator_node', metavar='NAME',
                        help='name of the running or recorded estimator (default: %(default)s)')
    parser.add_argument(
        '--estimator', help='for a recording: one of ' + ', '.join(ONLINE_ESTIMATORS))
    add_params_option(parser, ', for a recording')
    add_source_options(parser)
    return parser


def rerun_file(path: str) -> str:
    """Check the file of a view."""
    if new_file(path).suffix.lower() != '.rrd':
        raise RecordingError(
            f'a view is written to a file of Rerun, got {path}; let its name end in .rrd')
    return str(Path(path).absolute())


def run(options: Any) -> int:
    """Show a recording, or a running estimator until interrupted."""
    require_rerun()
    target = WEB if options.web else WINDOW
    if options.save:
        different_files([options.save], {'the recording': [options.recording]})
        target = rerun_file(options.save)
    if options.recording is None:
        return _watch_live(options, target)
    if options.follow:
        _follow(options, target)
    else:
        _replay(options, target)
    return 0


def _watch_live(options: Any, target: str) -> int:
    given = [name for name in _OF_RECORDINGS if getattr(options, name)]
    if given:
        raise ParameterRangeError(
            f'--{given[0].replace("_", "-")} needs a RECORDING, got none; remap the topics of a '
            'running estimator with --ros-args -r wrench:=TOPIC')
    require_rclpy('watch')
    from ..ros.watch_node import main as watch_node  # imports rclpy

    return watch_node(['--ros-args', '-p', f'show:={target}', '-p', f'estimator:={options.node}',
                       *options.ros_args])


def _replay(options: Any, target: str) -> None:
    source = source_of(options)
    reader = RecordingReader(options.recording, source)
    replay = RecordingReplay(reader, source, replayed_parameters(options))
    progress = Progress('watch')
    whole = False
    try:
        view, shown = _opened(options, target)
        if not options.save:
            print(shown, flush=True)
        samples = show_recording(view, reader, source, replay, progress.show)
        if samples < 2:
            raise RecordingError(
                f'{options.recording} must have samples at several times, got {samples}; `replay` '
                'says why')
        if not view.serves:
            view.close()
        whole = True
    finally:
        if options.save and not whole:  # not a view of anything
            Path(target).unlink(missing_ok=True)
    progress.done()
    print(f'{samples} samples', flush=True)
    if options.save:
        print(shown)
    if view.serves:
        view.stream.flush()
        print('Ctrl-C ends', flush=True)
        _interrupted().wait()
        view.close()


def _follow(options: Any, target: str) -> None:
    interrupted = _interrupted()
    view, shown = _opened(options, target, _FOLLOWED_S)
    print(shown, flush=True)
    follow_recording(view, Path(options.recording), options.node, interrupted)
    view.close()


def _opened(
    options: Any, target: str, follow_s: float | None = None
) -> tuple[ContactView, str]:
    view = ContactView(Path(options.recording).name)
    return view, f'watch: {show(view, target, follow_s)}'


def _interrupted() -> Event:
    event = Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: event.set())
    return event


def main(args: Sequence[str] | None = None) -> int:
    """Run the command."""
    words = list(sys.argv[1:] if args is None else args)
    at = words.index('--ros-args') if '--ros-args' in words else len(words)

    def parser() -> Parser:
        made = make_parser()
        made.set_defaults(ros_args=words[at + 1:])
        return made

    return command(parser, run)(words[:at])
