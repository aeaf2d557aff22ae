# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Shared by all commands: options, checks of outputs, one line on stderr per error."""

import argparse
import json
import os
from pathlib import Path
import sys
from typing import Any, Callable, Iterable, Mapping, NoReturn, Sequence

from ..estimators import ONLINE_ESTIMATORS
from ..exceptions import (
    ContactEstimationError, ParameterRangeError, RecordingError, UnknownNameError)
from ..kinematics.parameters import TRACKED
from ..parameter_files import read_parameter_file
from ..parameters import without
from ..recordings import RecordingReader
from ..recordings.adaptation import STAMPS
from ..recordings.bag_folder import is_bag_folder, is_recording
from ..recordings.columns import KEYS
from ..recordings.recorded_signals import FIRST
from ..recordings.source import RecordingSource, TOPICS
from ..recordings.table_file import require_a_table
from ..ros.estimator_node_parameters import EstimatorNodeParameters
from ..texts import print_help, printable, writing


class Parser(argparse.ArgumentParser):
    """Argument parser that exits with 1 and one line on a usage error."""

    def print_help(self, file: Any = None) -> None:
        """Print the help, or its beginning where the reader wants no more."""
        print_help(self.format_help().rstrip())

    def error(self, message: str) -> NoReturn:
        """Print the message on one line and exit."""
        self.exit(1, f'{self.prog}: {printable(message)}; see {self.prog} --help\n')


def command(make_parser: Callable[[], Parser], run: Callable[[Any], int]) -> Callable[..., int]:
    """Return the `main` function of a command."""
    def main(args: Sequence[str] | None = None) -> int:
        parser = make_parser()
        options = parser.parse_args(args)
        try:
            return run(options)
        except ContactEstimationError as error:
            print(f'{parser.prog}: {error}', file=sys.stderr)
        except BrokenPipeError:
            sys.stderr.close()
        except KeyboardInterrupt:
            print(f'{parser.prog}: interrupted', file=sys.stderr)
        except OSError as error:
            where = f': {error.filename}' if error.filename else ''
            print(f'{parser.prog}: {printable(f"{error.strerror}{where}")}', file=sys.stderr)
        return 1

    return main


def require_at_least(options: Any, **least: float) -> None:
    """Refuse options below their least values; one that is not given is not checked."""
    for name, bound in least.items():
        value = getattr(options, name)
        if value is not None and value < bound:
            raise ParameterRangeError(
                f'--{name.replace("_", "-")} must be >= {bound:g}, got {value:g}')


def add_reading_options(parser: argparse.ArgumentParser) -> None:
    """Add the options that say how a recording is read."""
    parser.add_argument(
        '--topic', action='append', default=[], metavar='NAME:=TOPIC',
        help='read NAME (' + ', '.join(TOPICS) + ') from TOPIC; may be repeated',
    )
    parser.add_argument(
        '--columns', nargs='+', action='extend', default=[], metavar='SIGNAL=COLUMN',
        help='column of each signal in a CSV, Parquet or MAT file (' + ', '.join(KEYS) + '; y and '
        'z like x); -COLUMN reverses the sign, t=500Hz gives a rate (default: found by name)',
    )
    parser.add_argument(
        '--units', default='', metavar='UNIT,...',
        help='units of the columns whose names hold none, such as mm,N,ms (default: SI)',
    )
    parser.add_argument(
        '--stamps', choices=STAMPS, default='header',
        help='take the time of a message from its header, or from its reception by the recorder '
        'if headers have no stamps or those of another clock (default: header)',
    )
    parser.add_argument(
        '--wrench-field', default='', metavar='FIELD',
        help='field with force and torque in messages other than WrenchStamped, such as '
        'data[0:6]',
    )


def add_tare_option(parser: argparse.ArgumentParser) -> None:
    """Add the option that chooses the zero of the force."""
    parser.add_argument(
        '--tare', default='', metavar=f'{FIRST}|A:B|{TRACKED}',
        help='subtract the median force of the first free flight, or from A to B s after the '
        'first wrench, or the zero tracked over all free flights (default: nothing)',
    )


def print_columns(reader: RecordingReader) -> None:
    """Print which columns of a table are read; nothing for other recordings."""
    if reader.columns:
        print('columns: ' + printable(' '.join(f'{k}={v}' for k, v in reader.columns.items())))


def reading_of(options: Any) -> dict[str, Any]:
    """Return how a recording is read, as chosen with the options of `add_reading_options`."""
    columns = {}
    for text in options.columns:
        signal, found, column = text.partition('=')
        if not found or not column:
            raise RecordingError(
                f'--columns must be SIGNAL=COLUMN, got {text!r}; example: wrench.force.z=Fz')
        columns[signal] = column
    units = tuple(filter(None, options.units.split(',')))
    require_a_table(_recordings_of(options), columns, units)
    return {'columns': columns, 'units': units,
            'stamps': options.stamps, 'wrench_field': options.wrench_field,
            'tare': tare if (tare := getattr(options, 'tare', '')) != TRACKED else ''}


def _recordings_of(options: Any) -> list[str]:
    """Return the recordings that a command is given, by the names of its options."""
    given: list[str] = []
    for name in ('recording', 'recordings', 'holdout', 'simulation', 'like', 'paths'):
        paths = getattr(options, name, None) or []
        given += [paths] if isinstance(paths, str) else paths
    return given


def add_source_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of all commands that read recordings."""
    add_reading_options(parser)
    parser.add_argument('--axis', choices=('x', 'y', 'z'),
                        help='contact axis of the wrench (default: x)')
    parser.add_argument('--joint', help='joint of the contact axis (default: the only one)')


def topics_of(options: Any) -> dict[str, str]:
    """Return the topics chosen with --topic."""
    topics: dict[str, str] = {}
    for remap in options.topic:
        name, found, topic = remap.partition(':=')
        if not found or not topic:
            raise RecordingError(
                f'--topic must be NAME:=TOPIC, got {remap!r}; example: wrench:=/fts/wrench')
        topics[name] = topic
    return topics


def source_of(options: Any) -> RecordingSource:
    """Return where and how a recording is read; see `topics_of` and `reading_of`."""
    return RecordingSource.of_topics(topics_of(options), **reading_of(options))


def add_params_option(parser: argparse.ArgumentParser, meaning: str) -> None:
    """Add the option --params of commands that estimate or need the parameters of an arm."""
    parser.add_argument(
        '--params', action='append', default=[], metavar='FILE',
        help=f'ROS 2 parameter file of estimator_node{meaning}; if given several times, later '
        'files override earlier ones',
    )


def chosen_parameters(options: Any) -> dict[str, Any]:
    """Return the parameters of estimator_node in the files of --params."""
    chosen: dict[str, Any] = {}
    for path in options.params:
        chosen.update(read_parameter_file(path, 'estimator_node'))
    if getattr(options, 'tare', '') == TRACKED:
        chosen['force_sensor.zero'] = TRACKED
    return chosen


def replayed_parameters(options: Any) -> dict[str, Any]:
    """Return the parameters chosen with --params, --estimator, --axis and --joint."""
    chosen = without(EstimatorNodeParameters, chosen_parameters(options))
    if options.estimator:
        if options.estimator not in ONLINE_ESTIMATORS:
            raise UnknownNameError.among('estimator', options.estimator, ONLINE_ESTIMATORS)
        chosen['estimator'] = options.estimator
    for name in ('axis', 'joint'):
        if getattr(options, name) is not None:
            chosen[name] = getattr(options, name)
    return chosen


def new_file(path: str) -> Path:
    """Check that a result can be written without overwriting a recording."""
    file = Path(path)
    if not file.absolute().parent.is_dir():
        raise RecordingError(
            f'cannot write {path}: folder {file.parent} does not exist; make it first')
    if file.is_dir():
        raise RecordingError(f'cannot write {path}: it is a folder; choose a file in it')
    if file.is_file() and is_recording(file):
        raise RecordingError(
            f'cannot write {path}: it is a recording, and recordings are never overwritten; '
            'choose another file')
    if is_bag_folder(file.resolve().parent):
        raise RecordingError(
            f'cannot write {path}: its folder is a rosbag2 recording, and recordings are never '
            'changed; choose another folder')
    return file


def new_folder(path: str) -> Path:
    """Create a folder for results."""
    folder = Path(path)
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise RecordingError(
            f'--output {path} exists already and is not empty, and recordings are never '
            'overwritten; choose another folder')
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def different_files(
    paths: Iterable[str | None], inputs: Mapping[str, Iterable[str | None]] | None = None
) -> None:
    """Check that results overwrite neither each other nor what they are made from."""
    taken: list[str] = []
    for path in filter(None, paths):
        for meaning, files in (inputs or {}).items():
            if any(_same_file(path, file) for file in files if file):
                raise RecordingError(
                    f'cannot write {path}: it is {meaning}, which would be lost; choose another '
                    'file')
        if any(_same_file(path, other) for other in taken):
            raise RecordingError(f'two results cannot both be written to {path}; choose two files')
        taken.append(path)


def _same_file(first: str, second: str) -> bool:
    if os.path.exists(first) and os.path.exists(second):
        return os.path.samefile(first, second)
    return os.path.realpath(first) == os.path.realpath(second)


def check_outputs(paths: Iterable[str | None], inputs: Mapping[str, Iterable[str | None]]) -> None:
    """Check, before the work, that all results can be written; see `different_files`."""
    given = [path for path in paths if path]
    for path in given:
        new_file(path)
    different_files(given, inputs)


def as_json(content: Any, allow_nan: bool = True) -> str:
    """Return a result as JSON."""
    return json.dumps(content, indent=1, allow_nan=allow_nan) + '\n'


def write_results(options: Any, results: Mapping[str, Callable[[], str]]) -> None:
    """Write the texts that the options of these names ask for."""
    for name, make in results.items():
        if path := getattr(options, name):
            file = new_file(path)
            with writing(file):
                file.write_text(make(), encoding='utf-8')
