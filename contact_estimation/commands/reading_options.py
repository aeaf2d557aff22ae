# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0


"""Options that say how a recording or a table is read."""

from __future__ import annotations

import argparse
from typing import Any

from ..exceptions import RecordingError
from ..kinematics.parameters import TRACKED
from ..recordings import RecordingReader
from ..recordings.adaptation import STAMPS
from ..recordings.columns import KEYS
from ..recordings.free_flight import FIRST
from ..recordings.source import TOPICS
from ..texts import printable


def add_reading_options(parser: argparse.ArgumentParser) -> None:
    """Add the options that say how a recording is read; the parser is extended in place."""
    parser.add_argument(
        '--topic', action='append', default=[], metavar='NAME:=TOPIC',
        help='read NAME (' + ', '.join(TOPICS) + ') from TOPIC; may be repeated',
    )
    parser.add_argument(
        '--columns', nargs='+', action='extend', default=[], metavar='SIGNAL=COLUMN',
        help='of a CSV, Parquet or MAT file: column of a signal (' + ', '.join(KEYS) + '; x '
        'likewise y, z), -COLUMN with the opposite sign; t=500Hz is a rate; default: by name',
    )
    parser.add_argument(
        '--units', default='', metavar='UNIT,...',
        help='of its columns, such as mm,N,ms (default: as in their names, else SI)',
    )
    parser.add_argument(
        '--stamps', choices=STAMPS, default='header',
        help='time of a message: its header, or its reception by the recorder, where headers have '
        'none or that of another clock (header)',
    )
    parser.add_argument(
        '--wrench-field', default='', metavar='FIELD',
        help='force and torque in messages that are no WrenchStamped, such as data[0:6]',
    )


def add_tare_option(parser: argparse.ArgumentParser) -> None:
    """Add the option that chooses the zero of the force; the parser is extended in place."""
    parser.add_argument(
        '--tare', default='', metavar=f'{FIRST}|A:B|{TRACKED}',
        help='zero of the force: its median in the first free flight, or from A to B s after the '
        'first wrench, or tracked in each free flight (default: as recorded)',
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
    return {'columns': columns, 'units': tuple(filter(None, options.units.split(','))),
            'stamps': options.stamps, 'wrench_field': options.wrench_field,
            'tare': tare if (tare := getattr(options, 'tare', '')) != TRACKED else ''}
