# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""`convert`: a table or a foreign recording as a recording with the usual topics, or as CSV."""

from pathlib import Path
from typing import Any

from .command_line import (
    add_reading_options, check_outputs, command, Parser, print_columns, source_of)
from ..exceptions import RecordingError
from ..recordings import RecordingReader, RecordingWriter
from ..recordings.arrays import signals_of_recording, write_csv
from ..recordings.columns import is_effort
from ..recordings.source import canonical, RecordingSource, TOPICS, TYPES


def make_parser() -> Parser:
    """Build the command line of `convert`."""
    parser = Parser(
        prog='convert',
        description='Write what the other commands read of a recording or table as an MCAP file '
        'with the usual topics and types, or as a CSV file; events are left out.',
    )
    parser.add_argument('recording', metavar='IN',
                        help='CSV, Parquet or MAT file, .mcap file or rosbag2 folder')
    parser.add_argument('output', metavar='OUT', help='new .mcap or .csv file')
    add_reading_options(parser)
    return parser


def run(options: Any) -> int:
    """Convert the recording and print what was written."""
    output = Path(options.output)
    if output.suffix.lower() not in ('.mcap', '.csv'):
        raise RecordingError(f'OUT must end in .mcap or .csv, got {output}')
    check_outputs([options.output], {'the recording': [options.recording]})
    source = source_of(options)
    reader = RecordingReader(options.recording, source)
    print_columns(reader)
    if output.suffix.lower() == '.csv':
        signals = signals_of_recording(reader, source)
        write_csv(output, signals)
        print(f'{len(signals["t_ns"])} rows of {", ".join(signals)}; wrote {output}')
    else:
        print(f'{_copy(reader, source, output)}; wrote {output}')
    return 0


def _copy(reader: RecordingReader, source: RecordingSource, output: Path) -> str:
    """Write the messages of all topics in use under their usual names; return their counts."""
    types = {canonical(topic): kind for topic, kind in reader.topics().items()}
    names = {topic: canonical(name) for name in TOPICS
             if canonical(topic := getattr(source, name)) in types}
    needed = {source.joint_states}
    if not any(map(is_effort, reader.columns)) or canonical(source.wrench) in types:
        needed.add(source.wrench)  # what is not there is an error that says what is
    messages = reader.messages(sorted(needed | set(names)))
    counts = dict.fromkeys(names.values(), 0)
    with RecordingWriter.file(output) as writer:
        for name, values in reader.metadata().items():
            writer.write_metadata(name, values)
        for topic, log_time_ns, data in messages:
            name = names[topic]
            kind = TYPES.get(name.strip('/'), types[canonical(topic)])
            writer.write(name, kind, data, log_time_ns)
            counts[name] += 1
    return ', '.join(f'{count} {name}' for name, count in counts.items())


main = command(make_parser, run)
