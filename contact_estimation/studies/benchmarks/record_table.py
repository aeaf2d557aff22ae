# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Diagnosed records as a Markdown table."""

from __future__ import annotations

from typing import Any, Mapping, NamedTuple, Sequence

from .record_score import CLASSES

_COLUMNS = ('record', 'source', 'verdict', 'names with share (95 % interval)', 'class',
            'held-out force error / std of the force', 'CPU [s]')


class Row(NamedTuple):
    """One diagnosed record."""

    # name, source: of the record; '' without a known source
    name: str
    source: str
    verdict: str  # '' after a failure
    effects: Sequence[Mapping[str, Any]]  # as in the report
    outcome: str  # one of CLASSES; '' where no truth is known
    # recalibrated, corrected: held-out force errors, relative to the standard deviation of the
    # force
    recalibrated: float | None
    corrected: float | None
    error: str  # message of a failed diagnosis
    cpu_s: float  # processor time of the diagnosis [s]


def as_markdown(rows: Sequence[Row]) -> str:
    """Format the table and its totals."""
    lines = [_line(_COLUMNS), '|' + '---|' * len(_COLUMNS), *(_line(_cells(row)) for row in rows)]
    return '\n'.join([*lines, '', *_totals(rows)])


def _line(cells: Sequence[str]) -> str:
    return '| ' + ' | '.join(' '.join(cell.split()).replace('|', '\\|') for cell in cells) + ' |'


def _cells(row: Row) -> list[str]:
    return [row.name, row.source, row.verdict.replace('_', ' ') or '-', _names(row),
            row.outcome or '-', _errors(row), f'{row.cpu_s:.0f}']


def _names(row: Row) -> str:
    if row.error:
        return row.error
    return '; '.join(_name(effect) for effect in row.effects) or 'none'


def _name(effect: Mapping[str, Any]) -> str:
    share, ends = 100.0 * effect['share'], effect['share_interval']
    digits = 0 if share >= 10.0 else 1
    interval = '' if None in ends else (
        f' ({100.0 * ends[0]:.{digits}f} to {100.0 * ends[1]:.{digits}f} %)')
    of_rest = effect.get('share_beside_zeros')
    beside = '' if of_rest is None else f', {100.0 * of_rest:.0f} % of what the zeros leave'
    return f'`{effect["name"]}` {share:.{digits}f} %{interval}{beside}'


def _errors(row: Row) -> str:
    if row.recalibrated is None or row.corrected is None:
        return '-'
    return f'{100.0 * row.recalibrated:.3g} → {100.0 * row.corrected:.3g} %'


def _totals(rows: Sequence[Row]) -> list[str]:
    """Count the classes, and sum up the processor time."""
    scored = [row.outcome for row in rows if row.outcome]
    counts = [f'{name} {scored.count(name)} ({100.0 * scored.count(name) / len(scored):.0f} %)'
              for name in CLASSES if name in scored]
    text = f'{len(rows)} records, {len(scored)} with a known truth'
    return [f'{text}: {", ".join(counts)}.' if counts else f'{text}.',
            f'Processor time: {sum(row.cpu_s for row in rows):.0f} s.']
