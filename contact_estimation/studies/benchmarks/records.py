# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
Diagnose the records of a folder and score the names.

A record is NAME.mcap with NAME.nominal.yaml and, where something is known about it,
NAME.truth.json. A NAME with 'train' is tested on the recording with 'pulses' in its place, if
there is one.
"""

from __future__ import annotations

from concurrent.futures import as_completed, ThreadPoolExecutor
import json
import os
from pathlib import Path
import subprocess
from tempfile import TemporaryDirectory
from typing import Any, Mapping, NamedTuple, Sequence

import numpy as np

from .record_score import class_of
from .record_table import as_markdown, Row
from ..blind_trials.study import diagnose_command
from ...commands.command_line import command, new_file, Parser
from ...commands.progress import Progress
from ...diagnosis.observe.read_recording import read_recording
from ...exceptions import ParameterRangeError, RecordingError

_TRAIN, _PARTNER = 'train', 'pulses'


class Record(NamedTuple):
    """The files of a record."""

    name: str  # of its recording, without suffix
    # recording, nominal: what `diagnose` gets
    recording: Path
    nominal: Path
    holdout: Path | None  # the recording to test on; None for a part of the recording itself
    truth: Mapping[str, Any] | None  # content of the truth file


class _Outcome(NamedTuple):
    """The report (None after a failure), the error message and the processor time [s]."""

    report: Mapping[str, Any] | None
    error: str
    cpu_s: float


def make_parser() -> Parser:
    """Build the command line of the benchmark."""
    parser = Parser(
        prog='studies records',
        description='Diagnose every NAME.mcap of a folder with NAME.nominal.yaml, and print '
        'names, held-out errors and processor time as a Markdown table. NAME.truth.json, where it '
        'exists, says which names are right (acceptable_names, effects or families); a name '
        'counts by its family. A NAME with "train" is tested on the recording with "pulses" in '
        'its place, if there is one, other records on a part of their own.',
    )
    parser.add_argument('folder', metavar='FOLDER', help='folder of the records')
    parser.add_argument('--output', metavar='FILE.md', help='write the table')
    parser.add_argument('--jobs', type=int, default=1, help='number of parallel diagnoses (1)')
    return parser


def run(options: Any) -> int:
    """Diagnose the records and print the table."""
    if options.jobs < 1:
        raise ParameterRangeError(f'--jobs must be >= 1, got {options.jobs}')
    target = new_file(options.output) if options.output else None
    text = as_markdown(diagnose_records(find_records(Path(options.folder)), options.jobs))
    print(text)
    if target is not None:
        target.write_text(text + '\n')
    return 0


def find_records(folder: Path) -> list[Record]:
    """Find the records of a folder."""
    found = []
    for recording in sorted(folder.glob('*.mcap')):
        nominal = recording.with_suffix('.nominal.yaml')
        if nominal.exists():
            truth = recording.with_suffix('.truth.json')
            found.append(Record(recording.stem, recording, nominal, _partner(recording),
                                _read_truth(truth) if truth.exists() else None))
    partners = {record.holdout for record in found}
    found = [record for record in found if record.recording not in partners]
    if not found:
        raise RecordingError(
            f'{folder} must hold records, NAME.mcap with NAME.nominal.yaml, got none; name the '
            'folder that holds the files')
    return found


def _partner(recording: Path) -> Path | None:
    partner = recording.with_name(recording.name.replace(_TRAIN, _PARTNER))
    return partner if partner != recording and partner.exists() else None


def _read_truth(path: Path) -> Mapping[str, Any]:
    try:
        truth = json.loads(path.read_text())
    except ValueError as error:
        raise RecordingError(f'{path} must be JSON, got: {error}; correct the file') from error
    if not isinstance(truth, dict):
        raise RecordingError(f'{path} must be a JSON object, got {type(truth).__name__}; '
                             'write {"acceptable_names": [...]}')
    class_of(truth, None)  # refused before the first diagnosis, not after the last
    return truth


def diagnose_records(records: Sequence[Record], jobs: int) -> list[Row]:
    """Diagnose records in parallel processes."""
    progress = Progress('benchmarks.records')
    with ThreadPoolExecutor(jobs) as pool:  # each thread only waits for its process
        pending = {pool.submit(_row, record): record.name for record in records}
        try:
            for done, future in enumerate(as_completed(pending), 1):
                future.result()
                progress.show(done / len(records), pending[future])
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise
    progress.done()
    return [future.result() for future in pending]


def _row(record: Record) -> Row:
    with TemporaryDirectory() as folder:
        outcome = _diagnose(record, Path(folder))
    truth = record.truth or {}
    report = outcome.report or {}
    force = report.get('fit', {}).get('force_rmse_n', {})
    std = 1.0 if outcome.report is None else _force_std(record.holdout or record.recording)
    relative = [None if force.get(name) is None else force[name] / std
                for name in ('recalibrated', 'corrected')]
    return Row(
        name=record.name, source=str(truth.get('source') or truth.get('source_repo') or ''),
        verdict=str(report.get('verdict', '')), effects=report.get('effects', []),
        outcome=class_of(truth, outcome.report) if record.truth is not None else '',
        recalibrated=relative[0], corrected=relative[1], error=outcome.error,
        cpu_s=outcome.cpu_s)


def _force_std(path: Path) -> float:
    return float(np.nanstd(read_recording(path).signals.force))


def _diagnose(record: Record, folder: Path) -> _Outcome:
    """Diagnose in a process of its own, which is not given the truth."""
    output, errors = folder / 'report.json', folder / 'errors.txt'
    arguments = diagnose_command(record.recording, record.nominal, output)
    if record.holdout is not None:
        arguments += ['--holdout', str(record.holdout)]
    # One thread each: several diagnoses run in parallel.
    environment = {**os.environ, 'OMP_NUM_THREADS': '1', 'OPENBLAS_NUM_THREADS': '1'}
    with open(errors, 'w') as stream:
        process = subprocess.Popen(arguments, env=environment, stdin=subprocess.DEVNULL,
                                   stdout=subprocess.DEVNULL, stderr=stream)
        _, status, used = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    cpu_s = used.ru_utime + used.ru_stime
    if process.returncode == 0:
        return _Outcome(json.loads(output.read_text()), '', cpu_s)
    lines = errors.read_text().strip().splitlines()
    return _Outcome(None, (lines or [f'exit code {process.returncode}'])[-1], cpu_s)


main = command(make_parser, run)
