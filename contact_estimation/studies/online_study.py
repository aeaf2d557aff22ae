# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
Measure on-line estimation in simulated worlds, by row.

The worlds are independent of `plant`: motions, walls and sensors of their own (`online_worlds`).
Their messages pass `ContactSession` as those of the node and of replay do.
"""

from collections import Counter
from math import isfinite, nan
from typing import Any, Mapping, Sequence
from zlib import crc32

import numpy as np

from . import online_contacts, online_inputs, online_walls
from .online_row import Row, Score
from ..commands.command_line import (
    as_json, check_outputs, command, Parser, require_at_least, write_results)
from ..commands.progress import computed
from ..estimators import MULTIPLE_MODEL, ONLINE_ESTIMATORS
from ..scheduling import Call
from ..texts import markdown_table

ROWS: dict[str, Row] = {**online_contacts.ROWS, **online_inputs.ROWS, **online_walls.ROWS}
"""All items by name."""

_COLUMNS = ('worlds', 'with estimate', 'K off [%]', 'B off [%]', 'K in 2 std', 'B in 2 std',
            'more')


def make_parser() -> Parser:
    """Build the command line of the study."""
    parser = Parser(
        prog='studies online',
        description='Measure on-line estimation with default parameters in simulated worlds whose '
        'motions, walls and sensors share nothing with the plant of this package. Prints a '
        'Markdown table: median / 90 % of errors, and how often the truth is within 2 standard '
        'deviations.')
    parser.add_argument('--only', nargs='+', metavar='ROW', choices=tuple(ROWS),
                        help=f'any of {", ".join(ROWS)} (default: all)')
    parser.add_argument('--estimator', choices=tuple(ONLINE_ESTIMATORS), default=MULTIPLE_MODEL,
                        help='whose estimates are measured, with defaults (default: %(default)s)')
    parser.add_argument('--json', metavar='FILE', help='write the summary and every world as JSON')
    parser.add_argument('--quick', action='store_true', help='fewer worlds')
    parser.add_argument('--seed', type=int, default=0, help='of all worlds (default: %(default)s)')
    parser.add_argument('--jobs', type=int, default=1, metavar='N',
                        help='number of parallel processes (default: %(default)s); more need Dask '
                        '(extra fleet)')
    return parser


def run(options: Any) -> int:
    """Measure, and print a table: a line for each group of worlds."""
    require_at_least(options, seed=0, jobs=1)
    check_outputs([options.json], {})
    worlds = [(row, world) for row in options.only or ROWS
              for world in range(ROWS[row].quick if options.quick else ROWS[row].worlds)]
    found = computed('online_study', {
        f'{row} {world}': Call(scored, (options.estimator, row, world, options.seed))
        for row, world in worlds}, options.jobs)
    scores: dict[str, list[Score]] = {}
    for row, world in worlds:
        scores.setdefault(row, []).append(found[f'{row} {world}'])
    rows = [summary(f'{row}: {group}' if group else row, [
        one for one in own if one.group == group])
        for row, own in scores.items() for group in dict.fromkeys(s.group for s in own)]
    print(as_markdown(rows))
    write_results(options, {'json': lambda: as_json({'rows': rows, 'worlds': {
        row: [one._asdict() for one in own] for row, own in scores.items()}})})
    return 0


def scored(estimator: str, row: str, world: int, seed: int) -> Score:
    """Return the score of an estimator in a world, given by its index."""
    draw = np.random.default_rng([seed, crc32(row.encode()), world])
    return ROWS[row].run(draw, world, estimator)


def summary(name: str, scores: Sequence[Score]) -> dict[str, Any]:
    """Summarise worlds: counts, and median, 90 % quantile and, of `more`, maximum of sizes."""
    errors = [[100.0 * abs(error) for error in column if isfinite(error)]
              for column in zip(*((one.K_error, one.B_error) for one in scores))]
    return {
        'row': name, 'worlds': len(scores), 'with estimate': (len(errors[0]), len(scores)),
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


def as_markdown(rows: Sequence[Mapping[str, Any]]) -> str:
    """Format summaries as a Markdown table."""
    return markdown_table(('row', *_COLUMNS), (
        [row['row'], row['worlds'], *(_text(row[key]) for key in _COLUMNS[1:-1]),
         '; '.join(f'{key} {_text(value)}' for key, value in row['more'].items() if value)]
        for row in rows))


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
