# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Report of the trials on rigs: outcomes by law and family, calibration, misses."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any, Mapping, Sequence

from .family_scoring import FAILED, FamilyScore, RIGHT, SILENT, WRONG
from .reliability import calibration_text, reliability

_OUTCOMES = (RIGHT, WRONG, SILENT, FAILED)


def outcomes(scores: Sequence[FamilyScore]) -> dict[str, int]:
    """Count outcomes."""
    counts = {name: sum(s.outcome == name for s in scores) for name in _OUTCOMES}
    return {'trials': len(scores), **counts, 'surplus': sum(s.surplus for s in scores)}


def family_groups(scores: Sequence[FamilyScore]) -> dict[str, dict[str, list[FamilyScore]]]:
    """Group scores by law, by acceptable family and by kind of experiment."""
    split: dict[str, dict[str, list[FamilyScore]]] = {'law': {}, 'family': {}, 'experiment': {}}
    for score in sorted(scores, key=lambda s: (s.kind, s.law, s.concealed)):
        split['law'].setdefault(score.law or 'clean', []).append(score)
        for family in score.families or [score.kind]:
            split['family'].setdefault(family, []).append(score)
        split['experiment'].setdefault(score.stage, []).append(score)
    return split


def family_dict(scores: Sequence[FamilyScore]) -> dict[str, Any]:
    """Return the trials on rigs as JSON content."""
    return {
        'kinds': {kind: outcomes(part) for kind, part in _by_kind(scores).items()},
        'groups': {criterion: {label: outcomes(part) for label, part in parts.items()}
                   for criterion, parts in family_groups(scores).items()},
        'reliability': [row._asdict() for row in reliability(scores)],
        'trials': [{**asdict(score), 'kind': score.kind} for score in scores],
    }


def _by_kind(scores: Sequence[FamilyScore]) -> Mapping[str, list[FamilyScore]]:
    kinds: dict[str, list[FamilyScore]] = {'foreign': [], 'unknown': [], 'clean': []}
    for score in scores:
        kinds[score.kind].append(score)
    return {kind: part for kind, part in kinds.items() if part}


def family_text(scores: Sequence[FamilyScore], folder: str) -> str:
    """Format the trials on rigs as tables."""
    lines = [f'{len(scores)} trials on rigs, scored by family', '', *_summary(scores)]
    for criterion, parts in family_groups(scores).items():
        columns = ('trials', *_OUTCOMES, 'surplus')
        lines += ['', f'by {criterion}'.ljust(32) + ''.join(f'{name:>9}' for name in columns)]
        for label, part in parts.items():
            counts = outcomes(part)
            lines.append(f'  {label:<30}' + ''.join(f'{counts[name]:>9}' for name in columns))
    lines += ['', calibration_text(scores)]
    misses = [score for score in scores if score.is_miss]
    lines += ['', f'{len(misses)} misses; recordings in {folder}']
    lines += [_miss_line(score) for score in misses]
    return '\n'.join(lines)


def _summary(scores: Sequence[FamilyScore]) -> list[str]:
    kinds = _by_kind(scores)
    lines = []
    if 'foreign' in kinds:
        part, counts = kinds['foreign'], outcomes(kinds['foreign'])
        alone = sum(s.outcome == RIGHT and not s.surplus for s in part)
        numbers = {
            'right family first': counts[RIGHT], 'right family first, no surplus name': alone,
            'wrong family first': counts[WRONG], 'nothing named': counts[SILENT],
            'diagnosis failed': counts[FAILED],
        }
        lines += [_share_line(f'{name} [%]', n, len(part)) for name, n in numbers.items()]
    if 'unknown' in kinds:
        part = kinds['unknown']
        silent = [s for s in part if s.outcome == SILENT]
        located = sum(bool(s.port_right) for s in silent)
        lines += [_share_line('no family describes the law: nothing named [%]', len(silent),
                              len(part)),
                  _share_line('no family describes the law: ... and right port [%]', located,
                              len(part))]
    if 'clean' in kinds:
        counts = outcomes(kinds['clean'])
        lines.append(_share_line(
            'false alarms in clean worlds [%]', counts[WRONG], counts['trials']))
    return lines


def _share_line(name: str, count: int, total: int) -> str:
    return f'  {name:<58}{100.0 * count / total:>8.3g}  of {total}'


def _miss_line(score: FamilyScore) -> str:
    truth = f'{score.law} ({score.stage}), {score.concealed:.1f} times' if score.law else (
        f'clean ({score.stage})')
    if score.error:
        return f'  {score.trial}: {truth}; failed: {score.error}'
    names = ' + '.join(f'{n.name} {n.probability:.2f}' for n in score.names) or 'nothing'
    wanted = ' or '.join(score.families) or 'no name'
    return f'  {score.trial}: {truth}; expected {wanted}, diagnosed {names}, {score.verdict}'
