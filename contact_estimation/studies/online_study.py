# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
Measure on-line estimation in simulated worlds: the defaults by row, or all estimators.

The worlds are independent of `plant`: motions, walls and sensors of their own (`online_worlds`).
Their messages pass `ContactSession` as those of the node and of replay do.
"""

from __future__ import annotations

from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from importlib.util import find_spec
from math import isfinite, nan
from pathlib import Path
from typing import Any, Callable, Iterable, Mapping, NamedTuple, Sequence
from zlib import crc32

import numpy as np

from . import online_contacts, online_inputs, online_walls
from .online_row import Array, follow, messages, Row, Score, Trace
from .online_worlds import World
from ..commands.command_line import (
    as_json, check_outputs, command, new_file, Parser, require_at_least, write_results)
from ..commands.progress import Progress
from ..estimators import ONLINE_ESTIMATORS
from ..exceptions import MissingPackageError, ParameterRangeError
from ..figures import as_png, figure_style, new_figure, require_matplotlib
from ..signals.synchronisation import SynchronisationParameters, Synchroniser

Update = Callable[[float, Array], tuple[Any, Any]]
"""From a pressing force [N] and (delta, v) to (K_hat, B_hat) and their variances."""

_TOUCH = 6.0  # standard deviations of the force noise above which the peers update
_START = np.array([3000.0, 50.0])
_START_STD = np.array([1e5, 1e4])
_WALK = 0.02  # of filterpy's state relative to its values [1/sqrt(s)]
_MEMORY = 0.998  # forgetting factor of padasip: one second at 500 Hz


def _filterpy(noise: float, rate: float) -> Update:
    """Prepare filterpy's Kalman filter for (K_e, B_e) with a random walk."""
    from filterpy.kalman import KalmanFilter

    kalman = KalmanFilter(dim_x=2, dim_z=1)
    kalman.x, kalman.P = _START[:, None].copy(), np.diag(_START_STD**2)

    def update(y: float, phi: Array) -> tuple[Any, Any]:
        walk = _WALK * np.maximum(np.abs(kalman.x[:, 0]), _START / 10.0)
        kalman.predict(Q=np.diag(walk**2 / rate))
        kalman.update(y, R=noise**2, H=phi[None, :])
        return kalman.x[:, 0], np.diag(kalman.P)

    return update


def _padasip(noise: float, rate: float) -> Update:
    """Prepare padasip's recursive least squares with forgetting."""
    try:
        from padasip.filters import FilterRLS
    except ImportError as error:
        raise MissingPackageError.of('padasip', 'a peer of the estimators study') from error
    rls: Any = FilterRLS(2, mu=_MEMORY, eps=1.0 / _START_STD[0]**2, w=_START.tolist())

    def update(y: float, phi: Array) -> tuple[Any, Any]:
        rls.adapt(y, phi)
        return rls.w, noise**2 * np.diag(rls.R)

    return update


def _bare(prepare: Callable[[float, float], Update], world: World) -> Trace:
    """Run a filter on paired samples, with x_e as told and the true noise, as manuals show it."""
    update = prepare(world.truth.sensor.noise, world.truth.sensor.rate)
    surface = world.parameters['environment.location']
    synchroniser = Synchroniser(SynchronisationParameters())
    times = dict(zip(world.wrenches.stamp_ns.tolist(), world.wrenches.t.tolist()))
    theta, variances, last, rows = _START, _START_STD**2, (0.0, surface), []
    for _, kind, stamp_ns, values in messages(world.wrenches, world.motions):
        add = synchroniser.add_wrench if kind else synchroniser.add_motion
        for (sample, *_) in add(stamp_ns, tuple(values)):
            t, x, v = times[sample.stamp_ns], sample.position, sample.velocity
            if v != v:  # not measured
                v = (x - last[1]) / (t - last[0]) if t > last[0] > 0.0 else 0.0
            last = t, x
            touching = -sample.force > _TOUCH * world.truth.sensor.noise and x > surface
            if touching:
                theta, variances = update(-sample.force, np.array([x - surface, v]))
            rows.append((t, *theta, *np.sqrt(np.maximum(variances, 0.0)), touching))
    t, K, B, K_std, B_std, contact = np.array(rows).T
    return Trace(t, K, B, K_std, B_std, np.full_like(t, surface), contact == 1.0, [], [], '')


CANDIDATES: dict[str, Callable[[World], Trace]] = {
    **{name: partial(follow, more={'estimator': name}) for name in ONLINE_ESTIMATORS},
    'indirect_adaptive, normalised': partial(follow, more={
        'estimator': 'indirect_adaptive', 'tuning.indirect_adaptive.normalised': True}),
    'filterpy Kalman, bare': partial(_bare, _filterpy),
    'padasip RLS, bare': partial(_bare, _padasip),
}
"""By name; each makes a trace of a world."""


ROWS: dict[str, Row] = {**online_contacts.ROWS, **online_inputs.ROWS, **online_walls.ROWS}
"""All items by name."""

_COLUMNS = ('worlds', 'with estimate', 'K off [%]', 'B off [%]', 'K in 2 std', 'B in 2 std',
            'more')
_COMPARED = 'end_of_contact', 'end_of_contact_as_told', 'steps', 'drift'  # by default
_DEFAULT = ''  # the candidate with default parameters
_FIGURES = {'study_errors.png': 'K off, median [%]', 'study_coverage.png': 'K in 2 std [%]',
            'study_convergence.png': 'to 10 % of K, median [s]'}


class Task(NamedTuple):
    """A world that a candidate follows."""

    candidate: str
    row: str
    world: int  # its index
    seed: int


def make_parser() -> Parser:
    """Build the command line of `studies online`."""
    parser = Parser(
        prog='studies online',
        description='Measure on-line estimation with default parameters in simulated worlds whose '
        'motions, walls and sensors share nothing with the plant of this package. Prints a '
        'Markdown table: median / 90 % of errors, and how often the truth is within 2 standard '
        'deviations.',
    )
    parser.add_argument('--only', nargs='+', metavar='ROW', help=f'any of {", ".join(ROWS)} (all)')
    parser.add_argument('--json', metavar='FILE', help='write the summary and every world as JSON')
    return _with_common_options(parser)


def make_estimators_parser() -> Parser:
    """Build the command line of `studies estimators`."""
    parser = Parser(
        prog='studies estimators',
        description='Compare all estimators with their defaults, and filterpy and padasip where '
        'installed, in rows of `studies online`. Prints a Markdown table for each row: median / '
        '90 % of errors, and how often the truth is within 2 standard deviations.',
    )
    parser.add_argument('--only', nargs='+', metavar='NAME',
                        help=f'any of {", ".join(CANDIDATES)} (all)')
    parser.add_argument('--scenario', nargs='+', metavar='ROW', choices=tuple(ROWS),
                        help=f'rows of `studies online` ({", ".join(_COMPARED)})')
    parser.add_argument('--output', metavar='FOLDER',
                        help='write estimators_study.md and three pictures')
    return _with_common_options(parser)


def _with_common_options(parser: Parser) -> Parser:
    parser.add_argument('--quick', action='store_true', help='fewer worlds')
    parser.add_argument('--seed', type=int, default=0, help='of all worlds (0)')
    parser.add_argument('--jobs', type=int, default=1, help='number of parallel processes (1)')
    return parser


def run(options: Any) -> int:
    """Measure the defaults, and print a table with a line for each group of worlds."""
    names = _chosen(options, ROWS)
    check_outputs([options.json], {})
    scores = _scores([_DEFAULT], names, options)
    table = {'row': [summary(f'{name}: {group[0].group}' if group[0].group else name, group)
                     for name in names for group in _grouped(scores[_DEFAULT, name])]}
    print(as_markdown(table))
    worlds = {name: [one._asdict() for one in scores[_DEFAULT, name]] for name in names}
    write_results(options, {'json': lambda: as_json({'rows': table['row'], 'worlds': worlds})})
    return 0


def run_estimators(options: Any) -> int:
    """Compare the candidates, and print a table for each row of worlds."""
    without = [] if find_spec('padasip') or options.only else ['padasip RLS, bare']
    names = [name for name in _chosen(options, CANDIDATES) if name not in without]
    rows = options.scenario or _COMPARED
    files = _new_files(Path(options.output)) if options.output else {}
    scores = _scores(names, rows, options)
    tables = {row: [summary(name, scores[name, row]) for name in names] for row in rows}
    text = as_markdown(tables)
    print(text)
    for name, file in files.items():
        if name in _FIGURES:
            file.write_bytes(as_png(_plot(_FIGURES[name], tables)))
        else:
            file.write_text(text + '\n')
    return 0


def _chosen(options: Any, known: Iterable[str]) -> list[str]:
    for name in options.only or ():
        if name not in known:
            raise ParameterRangeError(f'--only must be among {", ".join(known)}, got {name!r}')
    require_at_least(options, seed=0, jobs=1)
    return list(options.only or known)


def _new_files(folder: Path) -> dict[str, Path]:
    require_matplotlib()  # refused before the study, not after it
    folder.mkdir(parents=True, exist_ok=True)
    return {name: new_file(str(folder / name)) for name in ('estimators_study.md', *_FIGURES)}


def _scores(
    candidates: Sequence[str], rows: Sequence[str], options: Any
) -> dict[tuple[str, str], list[Score]]:
    """Return the scores of each candidate in each row."""
    tasks = [Task(candidate, row, world, options.seed) for candidate in candidates for row in rows
             for world in range(ROWS[row].quick if options.quick else ROWS[row].worlds)]
    scores: dict[tuple[str, str], list[Score]] = {}
    progress = Progress('online_study')
    with ProcessPoolExecutor(options.jobs) as pool:
        for done, (task, score) in enumerate(zip(tasks, pool.map(scored, tasks)), start=1):
            scores.setdefault((task.candidate, task.row), []).append(score)
            progress.show(done / len(tasks), f'{task.row} {task.candidate}')
    progress.done()
    return scores


def scored(task: Task) -> Score:
    """Return the score of a candidate in a world."""
    draw = np.random.default_rng([task.seed, crc32(task.row.encode()), task.world])
    trace = CANDIDATES[task.candidate] if task.candidate else follow
    return ROWS[task.row].run(draw, task.world, trace)


def _grouped(scores: Iterable[Score]) -> list[list[Score]]:
    groups: dict[str, list[Score]] = {}
    for score in scores:
        groups.setdefault(score.group, []).append(score)
    return list(groups.values())


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
    return '\n\n'.join('\n'.join(_lines(title, rows)) for title, rows in tables.items())


def _lines(title: str, rows: Sequence[Mapping[str, Any]]) -> list[str]:
    lines = ['| ' + ' | '.join([title, *_COLUMNS]) + ' |', '|---' * (1 + len(_COLUMNS)) + '|']
    for row in rows:
        more = '; '.join(f'{key} {_text(value)}' for key, value in row['more'].items() if value)
        cells = [row['row'], str(row['worlds']), *(_text(row[key]) for key in _COLUMNS[1:-1])]
        lines.append('| ' + ' | '.join([*cells, more]) + ' |')
    return lines


def _text(value: Any) -> str:
    if isinstance(value, dict):
        return ', '.join(f'{name} {count}' for name, count in value.items())
    if isinstance(value[0], float):
        return ' / '.join('-' if number != number else f'{number:.3g}' for number in value)
    count, total = value
    if not total:
        return '-'
    return f'{count} of {total}' if total < 100 else f'{100.0 * count / total:.3g} %'


@figure_style()
def _plot(quantity: str, tables: Mapping[str, Sequence[Mapping[str, Any]]]) -> Any:
    """Plot a quantity of each candidate, one colour a row."""
    figure, axis = new_figure((7.0, 3.6))
    names = [one['row'] for one in next(iter(tables.values()))]
    for row, summaries in tables.items():
        axis.plot([_value(quantity, one) for one in summaries], range(len(names)), 'o', label=row)
    if '2 std' not in quantity:
        axis.set_xscale('log')
    axis.set_yticks(range(len(names)), names)
    axis.invert_yaxis()
    axis.set_xlabel(quantity)
    figure.legend(loc='outside upper right', ncols=len(tables))
    return figure


def _value(quantity: str, row: Mapping[str, Any]) -> float:
    if quantity.startswith('K off'):
        return float(row['K off [%]'][0])
    if quantity.startswith('to 10 %'):
        return float(row['more'].get('to 10 % [s]', (nan,))[0])
    count, total = row['K in 2 std']
    return 100.0 * count / total if total else nan


main = command(make_parser, run)
main_estimators = command(make_estimators_parser, run_estimators)
