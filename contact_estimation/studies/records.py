# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Diagnose the records of a folder and score the names."""

import json
from pathlib import Path
from typing import Any, Mapping, NamedTuple, Sequence

import numpy as np

from .blind_trials.running import diagnosed
from .blind_trials.scoring import (
    acceptable_names, FAILED, judged, NEUTRAL, of_families, RIGHT, SILENT)
from ..commands.command_line import check_outputs, command, Parser, require_at_least, write_results
from ..commands.progress import computed
from ..diagnosis.observe.signals import read_recording
from ..exceptions import RecordingError
from ..physics import EFFECTS
from ..scheduling import Call
from ..texts import markdown_table

CLASSES = ('right alone', 'right with surplus', 'wrong first', 'silent', 'rightly silent',
           'failed')
"""Classes of a record of which the truth is known."""

_ALIKE = (
    {'coulomb_friction', 'stribeck_friction', 'presliding_friction', 'robot_friction',
     'bouc_wen_hysteresis'},
    {'bouc_wen_hysteresis', 'plastic_set', 'unloading_hysteresis', 'presliding_friction'},
    {'dead_zone', 'backlash', 'contact_offset'},
)
# These are of one kind as acceptable names, but each of them says less than its family.
_ALONE = {'bouc_wen_hysteresis', *NEUTRAL}
_MIXED = ('wall_motion', 'limits', 'robot')  # families whose members are different things


def with_relatives(names: set[str]) -> set[str]:
    """
    Add to acceptable names those of their families.

    Real friction rests, slides and hystereses at once: pre-sliding and Bouc-Wen laws, and friction
    of the robot or of the contact, count as one kind here.
    """
    telling = names - _ALONE
    families = {EFFECTS[name].family for name in telling if name in EFFECTS}.difference(_MIXED)
    found = names | (of_families(list(families)) - set(NEUTRAL))
    return found.union(*(alike for alike in _ALIKE if alike & telling))


def class_of(truth: Mapping[str, Any], report: Mapping[str, Any] | None) -> str:
    """Return the class of a report."""
    asked = acceptable_names(truth)
    names, outcome = judged(report, with_relatives(asked), set(NEUTRAL) - asked)
    if outcome == RIGHT:
        return 'right alone' if all(name.right for name in names) else 'right with surplus'
    if outcome == SILENT:
        return 'silent' if asked else 'rightly silent'
    return 'failed' if outcome == FAILED else 'wrong first'


_COLUMNS = ('record', 'source', 'verdict', 'names with share (95 % interval)', 'class',
            'held-out force error / std of the force', 'CPU [s]')


class Row(NamedTuple):
    """One diagnosed record."""

    cells: list[str]  # under `_COLUMNS`
    cpu_s: float  # processor time of the diagnosis [s]


def as_markdown(rows: Sequence[Row]) -> str:
    """Format the table and its totals."""
    return '\n'.join([markdown_table(_COLUMNS, [row.cells for row in rows]), '', *_totals(rows)])


def _name(effect: Mapping[str, Any]) -> str:
    share, ends = 100.0 * effect['share'], effect['share_interval']
    digits = 0 if share >= 10.0 else 1
    interval = '' if None in ends else (
        f' ({100.0 * ends[0]:.{digits}f} to {100.0 * ends[1]:.{digits}f} %)')
    of_rest = effect.get('share_beside_zeros')
    beside = '' if of_rest is None else f', {100.0 * of_rest:.0f} % of what the zeros leave'
    return f'`{effect["name"]}` {share:.{digits}f} %{interval}{beside}'


def _totals(rows: Sequence[Row]) -> list[str]:
    """Count the classes, and sum up the processor time."""
    outcomes = [row.cells[_COLUMNS.index('class')] for row in rows]
    scored = len(outcomes) - outcomes.count('-')
    counts = [f'{name} {outcomes.count(name)} ({100.0 * outcomes.count(name) / scored:.0f} %)'
              for name in CLASSES if name in outcomes]
    text = f'{len(rows)} records, {scored} with a known truth'
    return [f'{text}: {", ".join(counts)}.' if counts else f'{text}.',
            f'Processor time: {sum(row.cpu_s for row in rows):.0f} s.']


_TRAIN, _PARTNER = 'train', 'pulses'


class Record(NamedTuple):
    """The files of a record."""

    name: str  # of its recording, without suffix
    # recording, nominal: what `diagnose` gets
    recording: Path
    nominal: Path
    holdout: Path | None  # the recording to test on; None for a part of the recording itself
    truth: Mapping[str, Any] | None  # content of the truth file


def make_parser() -> Parser:
    """Build the command line of the benchmark."""
    parser = Parser(
        prog='studies records',
        description='Diagnose every NAME.mcap of a folder with NAME.nominal.yaml, and print '
        'names, held-out errors and processor time as a Markdown table. NAME.truth.json, where it '
        'exists, says which names are right (acceptable_names, effects or families); a name '
        'counts by its family. A NAME with "train" is tested on the recording with "pulses" in '
        'its place, if there is one, other records on a part of their own.')
    parser.add_argument('folder', metavar='FOLDER', help='folder of the records')
    parser.add_argument('--output', metavar='FILE.md', help='write the table')
    parser.add_argument('--jobs', type=int, default=1,
                        help='number of parallel diagnoses (default: %(default)s); more need Dask '
                        '(extra fleet)')
    return parser


def run(options: Any) -> int:
    """Diagnose the records and print the table."""
    require_at_least(options, jobs=1)
    check_outputs([options.output], {})
    records = find_records(Path(options.folder))
    rows = computed('records', {one.name: Call(row_of, (one,)) for one in records}, options.jobs)
    text = as_markdown([rows[one.name] for one in records])
    print(text)
    write_results(options, {'output': lambda: text + '\n'})
    return 0


def find_records(folder: Path) -> list[Record]:
    """Find the records of a folder."""
    found = []
    for recording in sorted(folder.glob('*.mcap')):
        nominal = recording.with_suffix('.nominal.yaml')
        if nominal.exists():
            truth = recording.with_suffix('.truth.json')
            partner = recording.with_name(recording.name.replace(_TRAIN, _PARTNER))
            found.append(Record(
                recording.stem, recording, nominal,
                partner if partner != recording and partner.exists() else None,
                _read_truth(truth) if truth.exists() else None))
    partners = {record.holdout for record in found}
    found = [record for record in found if record.recording not in partners]
    if not found:
        raise RecordingError(
            f'{folder} must hold records, NAME.mcap with NAME.nominal.yaml, got none; name the '
            'folder that holds the files')
    return found


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


def row_of(record: Record) -> Row:
    """Diagnose without the truth, and compare with it."""
    holdout = [] if record.holdout is None else ['--holdout', str(record.holdout)]
    answer = diagnosed(record.recording, '--nominal', str(record.nominal), *holdout)
    truth, found = record.truth or {}, answer.report or {}
    force = found.get('fit', {}).get('force_rmse_n', {})
    before, after = (force.get(name) for name in ('recalibrated', 'corrected'))
    errors = '-'
    if before is not None and after is not None:
        std = float(np.nanstd(read_recording(record.holdout or record.recording).signals.force))
        errors = f'{100.0 * (before / std):.3g} → {100.0 * (after / std):.3g} %'
    return Row([
        record.name, str(truth.get('source') or truth.get('source_repo') or ''),
        str(found.get('verdict', '')).replace('_', ' ') or '-',
        answer.error or '; '.join(map(_name, found.get('effects', []))) or 'none',
        '-' if record.truth is None else class_of(truth, answer.report), errors,
        f'{answer.cpu_s:.0f}'], answer.cpu_s)


main = command(make_parser, run)
