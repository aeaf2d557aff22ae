# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The benchmark on records: which files belong together, classes of reports, and the table."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from contact_estimation.benchmarks.record_score import class_of
from contact_estimation.benchmarks.record_table import as_markdown, Row
from contact_estimation.benchmarks.records import find_records, main
from contact_estimation.exceptions import RecordingError
import pytest

FRICTION = {'acceptable_names': ['coulomb_friction']}
CLEAN: dict[str, Any] = {'effects': []}


def report(*names: str) -> dict[str, Any]:
    """Return a report with names; a name may carry a rival: name:rival."""
    effects = []
    for words in names:
        name, *rivals = words.split(':')
        effects.append({'name': name, 'probability': 0.9, 'indistinguishable_from': rivals})
    return {'effects': effects}


def test_the_family_of_the_first_name_decides() -> None:
    for truth, names, expected in [
        (FRICTION, ['coulomb_friction'], 'right alone'),
        (FRICTION, ['presliding_friction', 'robot_friction'], 'right alone'),
        (FRICTION, ['bouc_wen_hysteresis'], 'right alone'),
        (FRICTION, ['force_lag:stribeck_friction'], 'right alone'),
        (FRICTION, ['coulomb_friction', 'force_lag'], 'right with surplus'),
        (FRICTION, ['force_lag', 'coulomb_friction'], 'wrong first'),
        (FRICTION, ['force_bias', 'coulomb_friction', 'contact_offset'], 'right alone'),
        (FRICTION, ['force_bias'], 'silent'),
        ({'acceptable_names': ['force_bias']}, ['force_bias'], 'right alone'),
        ({'acceptable_names': ['force_bias']}, ['force_drift'], 'wrong first'),
        ({'acceptable_names': ['dead_zone']}, ['contact_offset'], 'silent'),
        ({'effects': [{'name': 'force_lag', 'also': ['force_bias']}]}, ['force_bias'],
         'right alone'),
        ({'families': ['relaxation']}, ['fractional_relaxation'], 'right alone'),
        (CLEAN, [], 'rightly silent'),
        (CLEAN, ['force_lag'], 'wrong first'),
        (CLEAN, ['contact_offset'], 'rightly silent'),
    ]:
        assert class_of(truth, report(*names)) == expected, (truth, names, expected)


@pytest.mark.parametrize(('content', 'message'), [
    ('{', 'must be JSON'), ('[]', 'must be a JSON object, got list'),
    ('{"notes": ""}', 'must have acceptable_names, effects or families, got notes'),
])
def test_wrong_truth_is_refused_before_any_diagnosis(
    tmp_path: Path, content: str, message: str
) -> None:
    for suffix in ('mcap', 'nominal.yaml'):
        (tmp_path / f'a.{suffix}').touch()
    (tmp_path / 'a.truth.json').write_text(content)
    with pytest.raises(RecordingError, match=message):
        find_records(tmp_path)


def test_bad_arguments_are_errors_on_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for arguments, message in (([], 'must hold records'), (['--jobs', '0'], '--jobs must be')):
        assert main([str(tmp_path), *arguments]) == 1
        error = capsys.readouterr().err
        assert error.startswith('benchmarks.records: ') and error.count('\n') == 1
        assert message in error


def test_table_has_a_row_for_each_record_and_counts_classes() -> None:
    effect = {'name': 'coulomb_friction', 'share': 0.81, 'share_interval': [0.74, 0.86]}
    alone = {**effect, 'share_interval': [None, None], 'share_beside_zeros': 0.64}
    text = as_markdown([
        Row('a', 'x|y', 'physics_missing', [effect], 'right alone', 0.2, 0.05, '', 12.3),
        Row('b', '', 'unexplained', [alone], '', None, None, '', 1.0),
        Row('c', '', '', [], 'failed', None, None, 'no contact', 1.0),
    ])
    lines = text.splitlines()
    assert len({line.replace('\\|', '').count('|') for line in lines[:5]}) == 1
    assert lines[2] == ('| a | x\\|y | physics missing | `coulomb_friction` 81 % (74 to 86 %) | '
                        'right alone | 20 → 5 % | 12 |')
    assert lines[3] == ('| b |  | unexplained | `coulomb_friction` 81 %, 64 % of what the zeros '
                        'leave | - | - | 1 |')
    assert '| no contact | failed |' in lines[4]
    assert lines[6:] == ['3 records, 2 with a known truth: right alone 1 (50 %), failed 1 (50 %).',
                         'Processor time: 14 s.']
