# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Scores, tables and pictures of the estimators study."""

from __future__ import annotations

from math import inf, isfinite, nan
import time
from typing import Any, Callable, Mapping, NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray

from .study_worlds import Array, PEERS, RATE, SCENARIOS, SOFTEST, STEADY, STIFFEST, Trace, World
from ...estimators import ONLINE_ESTIMATORS
from ...exceptions import MissingPackageError
from ...figures import figure_style, GREY, GRID, MUTED, new_figure
from ...parameters.values import changed
from ...pipeline.axis_pipeline import EstimationPipeline
from ...pipeline.parameters import EstimationParameters


Flags = NDArray[np.bool_]

_SETTLED_S = 1.0  # after a touch-down, from which the band must hold
_AFTER_CHANGE_S = 2.0  # after a change of the wall, likewise
_BEFORE_END_S = 0.05  # of a contact: the wall is being left
_EVERY_S = 0.1  # between instants at which the band is checked
_CLOSE = 0.1  # relative error below which an estimate has converged

_EXACT = {'environment.location_std': 0.0}

NORMALISED = 'indirect_adaptive, normalised'


class Score(NamedTuple):
    """One candidate on one world."""

    stiffness: float  # of the wall at the end [N/m]
    # stiffness_error, damping_error: at the end of the last contact, relative
    stiffness_error: float
    damping_error: float
    # stiffness_held, damping_held: whether the truth is within 2 standard deviations, at the
    # instants at which one is given
    stiffness_held: Flags
    damping_held: Flags
    # median standard deviation of K and B relative to the truth, NaN where none is given
    widths: tuple[float, float]
    # share of the instants at which a standard deviation is given, of K and B
    given: tuple[float, float]
    # time after the change from which K_hat stays within 10 %; inf: never, NaN: no change
    converged_s: float
    us: float  # processor time a sample [us]


def candidates() -> dict[str, Callable[[World], Trace]]:
    """Return all that the study compares."""
    variants: dict[str, Mapping[str, Any]] = {
        name: {'estimator': name} for name in ONLINE_ESTIMATORS}
    variants[NORMALISED] = {'estimator': 'indirect_adaptive',
                            'tuning.indirect_adaptive.normalised': True}
    ours = {name: _traced_by(changes) for name, changes in variants.items()}
    return {**ours, **PEERS}


def _traced_by(changes: Mapping[str, Any]) -> Callable[[World], Trace]:
    def trace(world: World) -> Trace:
        parameters = changed(EstimationParameters(), {
            'sample_rate': RATE, **(_EXACT if world.scenario.exact_location else {}), **changes})
        pipeline = EstimationPipeline(parameters)
        values = [(e.stiffness, e.damping, e.stiffness_std, e.damping_std)
                  for e in pipeline.process(world.samples)]
        columns = np.array(values).T
        return columns[0], columns[1], columns[2], columns[3]

    return trace


def scores(candidate: Callable[[World], Trace], worlds: Sequence[World]) -> list[Score]:
    """Score a candidate on worlds."""
    found = []
    for world in worlds:
        begin = time.process_time()
        try:
            trace = candidate(world)
        except MissingPackageError:
            return []
        us = (time.process_time() - begin) * 1e6 / len(world.samples)
        found.append(score(world, trace, us))
    return found


def score(world: World, trace: Trace, us: float = nan) -> Score:
    """
    Score a trace.

    us: processor time a sample [us]
    """
    K, B, K_std, B_std = trace
    last = int(np.searchsorted(world.t, world.contacts[-1][1] - _BEFORE_END_S)) - 1
    at = _instants(world)
    K_held, K_given = _held(K[at], K_std[at], world.stiffness[at])
    B_held, B_given = _held(B[at], B_std[at], world.damping[at])
    return Score(
        float(world.stiffness[last]),
        float(K[last] / world.stiffness[last] - 1.0), float(B[last] / world.damping[last] - 1.0),
        K_held, B_held,
        (_width(K_std[at], world.stiffness[at]), _width(B_std[at], world.damping[at])),
        (K_given, B_given), _converged(world, K, last), us,
    )


def _instants(world: World) -> Array:
    """Return the samples at which the band is checked."""
    times = []
    for begin, end in world.contacts:
        start = begin + _SETTLED_S
        if world.scenario.change_s:
            start = begin + world.scenario.change_s + _AFTER_CHANGE_S
        times.append(np.arange(start, end - _BEFORE_END_S, _EVERY_S))
    return np.asarray(np.searchsorted(world.t, np.concatenate(times)))


def _held(value: Array, std: Array, truth: Array) -> tuple[Flags, float]:
    given = np.isfinite(std)
    held = np.abs(value - truth)[given] <= 2.0 * std[given]
    return held, float(np.mean(given))


def _width(std: Array, truth: Array) -> float:
    given = np.isfinite(std)
    return float(np.median(std[given] / truth[given])) if given.any() else nan


def _converged(world: World, K: Array, last: int) -> float:
    if not world.scenario.abrupt:
        return nan
    begin = world.contacts[-1][0] + world.scenario.change_s
    inside = slice(int(np.searchsorted(world.t, begin)), last + 1)
    away = np.abs(K[inside] / world.stiffness[inside] - 1.0) > _CLOSE
    if away[-1]:
        return inf
    since = int(np.flatnonzero(away)[-1]) + 1 if away.any() else 0
    return float(world.t[inside][since] - begin)


Results = Mapping[str, Mapping[str, Sequence[Score]]]
"""Scores by candidate and scenario."""

_WANTED = 0.90, 0.99  # share of the truth within two standard deviations
_NEVER_S = 10.0  # where the picture has its 'never'
_BINS = 5  # of the stiffness, on a log scale
_QUANTITIES = ('stiffness', 'K'), ('damping', 'B')


def as_markdown(results: Results) -> str:
    """Format all tables."""
    scenarios = list(next(iter(results.values())))
    steady = [name for name in scenarios if name in STEADY]
    abrupt = [name for name in scenarios if SCENARIOS[name].abrupt]
    tables = [
        _table('Errors at the end of contact, median / 90 %', results, steady, _errors),
        _table('Median standard deviation, K / B', results, steady, _widths),
        _table('Truth within 2 standard deviations, K / B', results, scenarios, _coverages),
        _table('Time until K is within 10 % for good, median / longest', results, abrupt,
               _times),
    ]
    return '\n\n'.join(table for table in tables if table)


def _table(title: str, results: Results, scenarios: Sequence[str], cell: Any) -> str:
    if not scenarios:
        return ''
    lines = [f'| {title} | ' + ' | '.join(scenarios) + ' |', '|---' * (len(scenarios) + 1) + '|']
    for name, by_scenario in results.items():
        cells = ' | '.join(cell(by_scenario[scenario]) for scenario in scenarios)
        lines.append(f'| {name} | {cells} |')
    return '\n'.join(lines)


def _errors(scores: Sequence[Score]) -> str:
    texts = []
    for quantity, symbol in _QUANTITIES:
        errors = [100.0 * abs(getattr(score, f'{quantity}_error')) for score in scores]
        median, high = np.quantile(errors, (0.5, 0.9))
        texts.append(f'{symbol} {_number(median)} / {_number(high)} %')
    return ', '.join(texts)


def _widths(scores: Sequence[Score]) -> str:
    widths = np.nanmedian([score.widths for score in scores], axis=0)
    return ' / '.join(_number(100.0 * width) for width in widths) + ' %'


def _number(value: float) -> str:
    return f'{value:.0f}' if value >= 10.0 else f'{value:.2g}'


def _coverages(scores: Sequence[Score]) -> str:
    return ' / '.join(_coverage_text(scores, quantity) for quantity, _ in _QUANTITIES) + ' %'


def _coverage_text(scores: Sequence[Score], quantity: str) -> str:
    share, given = coverage(scores, quantity)
    if given == 0.0:
        return 'none given'
    partly = '' if given > 0.99 else f' (of {100.0 * given:.0f} %)'
    return f'{100.0 * share:.0f}{partly}'


def coverage(scores: Sequence[Score], quantity: str) -> tuple[float, float]:
    """Return how often the truth is within 2 standard deviations."""
    held = np.concatenate([getattr(score, f'{quantity}_held') for score in scores])
    index = [name for name, _ in _QUANTITIES].index(quantity)
    given = float(np.mean([score.given[index] for score in scores]))
    return float(np.mean(held)) if len(held) else 0.0, given


def _times(scores: Sequence[Score]) -> str:
    times = [score.converged_s for score in scores]
    texts = [f'{value:.2g} s' if isfinite(value) else 'never'
             for value in (_median(times), max(times))]
    return ' / '.join(texts)


def _median(times: Sequence[float]) -> float:
    return sorted(times)[len(times) // 2]


@figure_style()
def error_figure(results: Results, scenario: str, emphasised: str) -> Any:
    """Plot the errors of K and B against stiffness."""
    figure, axes = new_figure((8.0, 3.6), 1, 2, sharey=True)
    edges = np.geomspace(SOFTEST, STIFFEST, _BINS + 1)
    for place, (quantity, symbol) in zip(axes, _QUANTITIES):
        for index, (name, by_scenario) in enumerate(results.items()):
            scores = by_scenario[scenario]
            K = np.array([score.stiffness for score in scores])
            error = np.array([100.0 * abs(getattr(score, f'{quantity}_error'))
                              for score in scores])
            classes = np.clip(np.searchsorted(edges, K) - 1, 0, _BINS - 1)
            present = np.unique(classes)
            place.loglog([np.median(K[classes == k]) for k in present],
                         [max(np.median(error[classes == k]), 1e-3) for k in present],
                         **_style(index, name == emphasised), label=name)
        place.set(title=f'error of {symbol} [%], median', xlabel='stiffness of the wall [N/m]')
    figure.legend(*axes[0].get_legend_handles_labels(), loc='outside right center')
    return figure


@figure_style()
def coverage_figure(results: Results, scenarios: Sequence[str]) -> Any:
    """Plot how often the truth is within 2 standard deviations."""
    figure, axes = new_figure((8.0, 3.6), 1, 2, sharey=True)
    names = list(results)
    for place, (quantity, symbol) in zip(axes, _QUANTITIES):
        place.axvspan(*(100.0 * limit for limit in _WANTED), color=GRID)
        for index, scenario in enumerate(scenarios):
            shares = [coverage(results[name][scenario], quantity) for name in names]
            rows = [row for row, (_, given) in enumerate(shares) if given]
            place.plot([100.0 * shares[row][0] for row in rows], rows, 'osD^vPX'[index % 7],
                       color=f'C{index}', markersize=4, alpha=0.8, label=scenario)
        place.set(title=f'{symbol} within 2 standard deviations [% of instants]', xlim=(-2, 102))
    axes[0].set_yticks(range(len(names)), names)
    axes[0].invert_yaxis()
    figure.legend(*axes[0].get_legend_handles_labels(), loc='outside lower center',
                  ncols=(len(scenarios) + 1) // 2)
    return figure


@figure_style()
def convergence_figure(results: Results, scenarios: Sequence[str]) -> Any:
    """Plot the time to converge after a change of the wall."""
    figure, axes = new_figure((8.0, 3.4), 1, len(scenarios), sharey=True, squeeze=False)
    names = list(results)
    for place, scenario in zip(axes[0], scenarios):
        for row, name in enumerate(names):
            times = [score.converged_s for score in results[name][scenario]]
            shown = [max(value, 2e-3) if value < inf else _NEVER_S for value in times]
            place.semilogx(shown, [row] * len(shown), 'o', color='C0', markersize=4, alpha=0.6)
        place.axvline(0.5, color=MUTED, linewidth=0.8)
        place.set(title=scenario, xlabel='time [s]', xlim=(1e-3, 2.0 * _NEVER_S))
        place.set_xticks([0.01, 0.1, 1.0, _NEVER_S], ['0.01', '0.1', '1', 'never'])
        place.minorticks_off()
    axes[0, 0].set_yticks(range(len(names)), names)
    axes[0, 0].invert_yaxis()
    return figure


def _style(index: int, emphasised: bool) -> dict[str, Any]:
    colour = f'C{index % 10}' if index % 10 != 7 else GREY
    return {'color': colour, 'marker': 'o', 'markersize': 3,
            'linewidth': 2.5 if emphasised else 1.0}
