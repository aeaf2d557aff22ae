# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
Measure on-line estimation with default parameters in simulated worlds, one table row per item.

The worlds are independent of `plant`: motions, walls and sensors of their own (`online_worlds`).
Their messages pass `ContactSession` as those of the node and of replay do.
"""

from __future__ import annotations

from collections import Counter
from concurrent.futures import ProcessPoolExecutor
import json
from math import isfinite, nan
from typing import Any, Iterable, Iterator, Mapping, Sequence
from zlib import crc32

import numpy as np

from . import online_contacts, online_inputs, online_walls
from .online_row import Row, Score
from ...commands.command_line import command, new_file, Parser
from ...commands.progress import Progress
from ...exceptions import ParameterRangeError

ROWS: dict[str, Row] = {**online_contacts.ROWS, **online_inputs.ROWS, **online_walls.ROWS}
"""All items by name."""

_Task = tuple[str, int, int]  # row, index of the world, seed
_COLUMNS = ('row', 'worlds', 'with estimate', 'K off [%]', 'B off [%]', 'K in 2 std', 'B in 2 std',
            'more')


def make_parser() -> Parser:
    """Build the command line of the study."""
    parser = Parser(
        prog='studies online',
        description='Measure on-line estimation with default parameters in simulated worlds whose '
        'motions, walls and sensors share nothing with the plant of this package. Prints a '
        'Markdown table: median / 90 % of errors, and how often the truth is within 2 standard '
        'deviations.',
    )
    parser.add_argument('--only', nargs='+', metavar='ROW',
                        help=f'any of {", ".join(ROWS)} (all)')
    parser.add_argument('--quick', action='store_true', help='fewer worlds')
    parser.add_argument('--seed', type=int, default=0, help='of all worlds (0)')
    parser.add_argument('--json', metavar='FILE', help='write the summary and every world as JSON')
    parser.add_argument('--jobs', type=int, default=1, help='number of parallel processes (1)')
    return parser


def run(options: Any) -> int:
    """Run the study and print its table."""
    names = _chosen(options)
    file = new_file(options.json) if options.json else None
    tasks = [(name, index, options.seed) for name in names
             for index in range(ROWS[name].quick if options.quick else ROWS[name].worlds)]
    scores: dict[str, list[Score]] = {name: [] for name in names}
    progress = Progress('online_study')
    for done, (name, score) in enumerate(_scored(tasks, options.jobs), start=1):
        scores[name].append(score)
        progress.show(done / len(tasks), name)
    progress.done()
    table = [summary(name, group) for name in names for group in _grouped(scores[name])]
    print(as_markdown(table))
    if file:
        worlds = {name: [one._asdict() for one in some] for name, some in scores.items()}
        file.write_text(json.dumps({'rows': table, 'worlds': worlds}, indent=1) + '\n')
    return 0


def _chosen(options: Any) -> list[str]:
    for name in options.only or ():
        if name not in ROWS:
            raise ParameterRangeError(f'--only must name rows ({", ".join(ROWS)}), got {name!r}')
    for option, least in (('seed', 0), ('jobs', 1)):
        if getattr(options, option) < least:
            raise ParameterRangeError(
                f'--{option} must be >= {least}, got {getattr(options, option)}')
    return list(options.only or ROWS)


def _scored(tasks: Sequence[_Task], jobs: int) -> Iterator[tuple[str, Score]]:
    if jobs == 1:
        yield from map(scored, tasks)
        return
    with ProcessPoolExecutor(jobs) as pool:
        yield from pool.map(scored, tasks)


def scored(task: tuple[str, int, int]) -> tuple[str, Score]:
    """Return the row and the score of a world, given row, index and seed."""
    name, index, seed = task
    draw = np.random.default_rng([seed, crc32(name.encode()), index])
    return name, ROWS[name].run(draw, index)


def _grouped(scores: Iterable[Score]) -> list[list[Score]]:
    groups: dict[str, list[Score]] = {}
    for score in scores:
        groups.setdefault(score.group, []).append(score)
    return list(groups.values())


def summary(name: str, scores: Sequence[Score]) -> dict[str, Any]:
    """Summarise the worlds of one group."""
    errors = [[100.0 * abs(error) for error in column if isfinite(error)]
              for column in zip(*((one.K_error, one.B_error) for one in scores))]
    group = scores[0].group
    return {
        'row': f'{name}: {group}' if group else name, 'worlds': len(scores),
        'with estimate': (len(errors[0]), len(scores)),
        'K off [%]': _quantiles(errors[0], 0.5, 0.9), 'B off [%]': _quantiles(errors[1], 0.5, 0.9),
        'K in 2 std': _total([one.K_held for one in scores]),
        'B in 2 std': _total([one.B_held for one in scores]),
        'more': _more([one.more for one in scores])}


def _total(counts: Sequence[tuple[int, int]]) -> tuple[int, int]:
    return sum(one[0] for one in counts), sum(one[1] for one in counts)


def _quantiles(values: Sequence[float], *shares: float) -> tuple[float, ...]:
    if not values:
        return (nan,) * len(shares)
    return tuple(np.quantile(values, shares, method='inverted_cdf').tolist())


def _more(found: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    summaries: dict[str, Any] = {}
    for key in dict.fromkeys(key for one in found for key in one):
        values = [one[key] for one in found if key in one]
        if isinstance(values[0], bool):
            summaries[key] = (sum(values), len(found) if key == 'raised' else len(values))
        elif isinstance(values[0], tuple):
            summaries[key] = _total(values)
        elif isinstance(values[0], list):
            summaries[key] = dict(Counter(name for names in values for name in names))
        else:
            known = [value for value in values if value == value]
            summaries[key] = _quantiles(known, 0.5, 0.9, 1.0)
    return summaries


def as_markdown(table: Sequence[Mapping[str, Any]]) -> str:
    """Format summaries as one Markdown table."""
    lines = ['| ' + ' | '.join(_COLUMNS) + ' |', '|---' * len(_COLUMNS) + '|']
    for row in table:
        more = '; '.join(f'{key} {_text(value)}' for key, value in row['more'].items() if value)
        cells = [row['row'], str(row['worlds']), *(_text(row[key]) for key in _COLUMNS[2:-1])]
        lines.append('| ' + ' | '.join([*cells, more]) + ' |')
    return '\n'.join(lines)


def _text(value: Any) -> str:
    if isinstance(value, dict):
        return ', '.join(f'{name} {count}' for name, count in value.items())
    if isinstance(value[0], float):
        return ' / '.join('-' if number != number else f'{number:.3g}' for number in value)
    count, total = value
    if not total:
        return '-'
    return f'{count} of {total}' if total < 100 else f'{100.0 * count / total:.3g} %'


main = command(make_parser, run)
