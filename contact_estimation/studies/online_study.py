# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
Measure on-line estimation in simulated worlds: the defaults by row, or all estimators.

The worlds are independent of `plant`: motions, walls and sensors of their own (`online_worlds`).
Their messages pass `ContactSession` as those of the node and of replay do.
"""

from collections import Counter
from functools import partial
from math import isfinite, nan
from typing import Any, Callable, Iterable, Mapping, Sequence
from zlib import crc32

import numpy as np

from . import online_contacts, online_inputs, online_matrix, online_walls
from .online_row import follow, messages, Row, Score, Trace
from .online_worlds import World
from ..commands.command_line import (
    as_json, check_outputs, command, Parser, require_at_least, write_results)
from ..commands.progress import computed
from ..estimators import ONLINE_ESTIMATORS
from ..exceptions import ParameterRangeError
from ..scheduling import Call
from ..signals.synchronisation import SynchronisationParameters, Synchroniser
from ..texts import markdown_table

_TOUCH = 6.0  # standard deviations of the force noise above which the peer updates
_START = np.array([3000.0, 50.0])
_START_STD = np.array([1e5, 1e4])
_WALK = 0.02  # of filterpy's state relative to its values [1/sqrt(s)]


def filterpy_trace(world: World) -> Trace:
    """Run filterpy's filter on paired samples, x_e as told and the true noise, as its manual."""
    from filterpy.kalman import KalmanFilter

    kalman, sensor = KalmanFilter(dim_x=2, dim_z=1), world.truth.sensor
    kalman.x, kalman.P = _START[:, None].copy(), np.diag(_START_STD**2)
    surface = world.parameters['environment.location']
    synchroniser = Synchroniser(SynchronisationParameters())
    times = dict(zip(world.wrenches.stamp_ns.tolist(), world.wrenches.t.tolist()))
    last, rows = (0.0, surface), []
    for _, kind, stamp_ns, values in messages(world.wrenches, world.motions):
        add = synchroniser.add_wrench if kind else synchroniser.add_motion
        for (sample, *_) in add(stamp_ns, tuple(values)):
            t, x, v = times[sample.stamp_ns], sample.position, sample.velocity
            if v != v:  # not measured
                v = (x - last[1]) / (t - last[0]) if t > last[0] > 0.0 else 0.0
            last = t, x
            touching = -sample.force > _TOUCH * sensor.noise and x > surface
            if touching:
                walk = _WALK * np.maximum(np.abs(kalman.x[:, 0]), _START / 10.0)
                kalman.predict(Q=np.diag(walk**2 / sensor.rate))
                kalman.update(-sample.force, R=sensor.noise**2, H=np.array([[x - surface, v]]))
            rows.append((t, *kalman.x[:, 0], *np.sqrt(np.diag(kalman.P)), touching))
    t, K, B, K_std, B_std, contact = np.array(rows).T
    return Trace(t, K, B, K_std, B_std, np.full_like(t, surface), contact == 1.0, [], [], '')


CANDIDATES: dict[str, Callable[[World], Trace]] = {
    **{name: partial(follow, more={'estimator': name}) for name in ONLINE_ESTIMATORS},
    'indirect_adaptive, normalised': partial(follow, more={
        'estimator': 'indirect_adaptive', 'tuning.indirect_adaptive.normalised': True}),
    'filterpy Kalman, bare': filterpy_trace,
}
"""By name; each makes a trace of a world."""

ROWS: dict[str, Row] = {**online_contacts.ROWS, **online_inputs.ROWS, **online_walls.ROWS,
                        **online_matrix.ROWS}
"""All items by name."""

_COLUMNS = ('worlds', 'with estimate', 'K off [%]', 'B off [%]', 'K in 2 std', 'B in 2 std',
            'more')
_COMPARED = 'end_of_contact', 'end_of_contact_as_told', 'steps', 'drift'  # by default
_DEFAULT = ''  # the candidate with default parameters


def make_parser() -> Parser:
    """Build the command line of the study."""
    parser = Parser(
        prog='studies online',
        description='Measure on-line estimation with default parameters in simulated worlds whose '
        'motions, walls and sensors share nothing with the plant of this package. Prints a '
        'Markdown table: median / 90 % of errors, and how often the truth is within 2 standard '
        'deviations.')
    parser.add_argument('--only', nargs='+', metavar='ROW', choices=tuple(ROWS),
                        help=f'any of {", ".join(ROWS)} (all)')
    parser.add_argument('--estimators', nargs='*', metavar='NAME', choices=tuple(CANDIDATES),
                        help='compare these, or all without a NAME, in a table for each row '
                        f'({", ".join(_COMPARED)}): {", ".join(CANDIDATES)}')
    parser.add_argument('--json', metavar='FILE', help='write the summary and every world as JSON')
    parser.add_argument('--quick', action='store_true', help='fewer worlds')
    parser.add_argument('--seed', type=int, default=0, help='of all worlds (0)')
    parser.add_argument('--jobs', type=int, default=1, metavar='N',
                        help='number of parallel processes (1); more need Dask (extra fleet)')
    return parser


def run(options: Any) -> int:
    """Measure, and print a table: a line for each group of worlds, or for each estimator."""
    require_at_least(options, seed=0, jobs=1)
    check_outputs([options.json], {})
    compared = options.estimators is not None
    rows = options.only or (_COMPARED if compared else ROWS)
    if compared and not set(rows).isdisjoint(online_matrix.ROWS):
        raise ParameterRangeError('--estimators compares estimates of one axis, got the row '
                                  f'{", ".join(online_matrix.ROWS)}; leave it out of --only')
    names = (options.estimators or list(CANDIDATES)) if compared else [_DEFAULT]
    scores = _scores(names, rows, options)
    if compared:
        tables = {row: [summary(name, scores[name, row]) for name in names] for row in rows}
    else:
        tables = {'row': [
            summary(f'{row}: {group}' if group else row, [
                one for one in scores[_DEFAULT, row] if one.group == group])
            for row in rows for group in dict.fromkeys(s.group for s in scores[_DEFAULT, row])]}
    print(as_markdown(tables))
    worlds = {f'{row} {name}'.strip(): [one._asdict() for one in group]
              for (name, row), group in scores.items()}
    write_results(options, {'json': lambda: as_json({'tables': tables, 'worlds': worlds})})
    return 0


def _scores(
    candidates: Sequence[str], rows: Iterable[str], options: Any
) -> dict[tuple[str, str], list[Score]]:
    """Return the scores of each candidate in each row."""
    tasks = [(candidate, row, world, options.seed) for row in rows for candidate in candidates
             for world in range(ROWS[row].quick if options.quick else ROWS[row].worlds)]
    calls = {f'{row} {world} {candidate}': Call(scored, (candidate, row, world, seed))
             for candidate, row, world, seed in tasks}
    found = computed('online_study', calls, options.jobs)
    scores: dict[tuple[str, str], list[Score]] = {}
    for (candidate, row, *_), key in zip(tasks, calls):
        scores.setdefault((candidate, row), []).append(found[key])
    return scores


def scored(candidate: str, row: str, world: int, seed: int) -> Score:
    """Return the score of a candidate in a world, given by its index."""
    draw = np.random.default_rng([seed, crc32(row.encode()), world])
    return ROWS[row].run(draw, world, CANDIDATES.get(candidate))


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


def as_markdown(tables: Mapping[str, Sequence[Mapping[str, Any]]]) -> str:
    """Format summaries as Markdown tables, each with its title in the first column."""
    return '\n\n'.join(markdown_table([title, *_COLUMNS], (
        [row['row'], row['worlds'], *(_text(row[key]) for key in _COLUMNS[1:-1]),
         '; '.join(f'{key} {_text(value)}' for key, value in row['more'].items() if value)]
        for row in rows)) for title, rows in tables.items())


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
