# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""What the estimators study measures on a world: errors, coverage, time to converge again."""

from __future__ import annotations

from math import inf, nan
import time
from typing import Any, Callable, Mapping, NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray

from .study_peers import PEERS, Trace
from .study_worlds import Array, RATE, World
from ...estimators import ONLINE_ESTIMATORS
from ...exceptions import MissingPackageError
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
