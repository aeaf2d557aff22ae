# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Rows of the on-line study: walls of other laws, and walls that change in contact."""

from itertools import product
from math import inf, nan
from typing import Any

import numpy as np

from .online_row import (
    AS_TOLD, drawn_location, drawn_sensor, drawn_wall, law_families, presses, Row, Score, score,
    settled_instants, spread, Trace, WITHIN)
from .online_worlds import simulate, World
from .paths import Array, ramp
from ..physics.prior import log_uniform

_LAW_AFTER_S = 3.0
_PRESS = 40.0  # [N]
_STIFFNESSES = 1e3, 5e3, 2e4  # [N/m]
_LAWS: dict[str, tuple[str, dict[str, Any]]] = {
    'spring and damper': ('spring_damper', {}),
    'Hunt-Crossley, n = 1': ('hunt_crossley', {'exponent': 1.0}),
    'Hunt-Crossley, n = 1.5': ('hunt_crossley', {'exponent': 1.5}),
    'mass of 2 kg': ('mass', {'mass': 2.0}),
    'friction of 1 N': ('friction', {'friction': 1.0}),
    'friction of 5 N': ('friction', {'friction': 5.0}),
    'moving by 1 mm': ('moving', {}),
}
_MOTIONS = 'excited', 'still'
_CASES = list(product(_LAWS, _MOTIONS))
_MOVED, _MOVE_BEGIN_S, _MOVE_S = 1e-3, 0.5, 2.0  # [m], after the touch

_CHANGE_S, _CLOSE = 2.0, 0.1  # of the wall, after the touch; an error that counts as found
_STEPS: dict[str, tuple[tuple[float, float], float]] = {
    'x 2': ((1e3, 1e4), 2.0), 'x 0.1': ((3e3, 3e4), 0.1), 'x 10': ((3e2, 3e3), 10.0),
    '300 to 30000': ((3e2, 3e2), 100.0), '30000 to 300': ((3e4, 3e4), 0.01),
}
_STEP_CASES = list(product(_STEPS, _MOTIONS))
_STIFF_FORCE = 150.0  # of the stiffer of both walls [N]


def _laws(draw: np.random.Generator, index: int) -> World:
    law, motion = _CASES[index % len(_CASES)]
    repeat = index // len(_CASES)
    parameters, x_e = drawn_location(draw, (AS_TOLD, WITHIN)[repeat % 2])
    stiffness = _STIFFNESSES[repeat % 3]
    depth = min(_PRESS / stiffness, 0.03)
    wall = drawn_wall(draw, stiffness, x_e, depth=depth, **_LAWS[law][1])
    # A stronger damper would hide what the law adds to the spring.
    wall = wall._replace(damping=stiffness * log_uniform(draw, 2e-3, 2e-2))
    if _LAWS[law][0] == 'moving':
        # The touch is about 0.3 s after the approach has begun at 1 s. By more than a third of
        # the depth the contact would end.
        wall = wall._replace(shift=ramp(1.3 + _MOVE_BEGIN_S, _MOVE_S, min(_MOVED, depth / 3.0)))
    pieces, seconds = presses(draw, depth, contacts=1, excited=motion == 'excited')
    return simulate(f'{law}, {motion}', parameters, pieces, seconds, wall, drawn_sensor(draw),
                    draw)


def _score_laws(world: World, trace: Trace) -> Score:
    at = world.truth.contacts[0][0] + _LAW_AFTER_S
    more: dict[str, Any] = {}
    laws = law_families(trace, at)
    if laws:
        probability = laws.get(_LAWS[world.group.rpartition(', ')[0]][0], 0.0)
        more = {'right law first': probability == max(laws.values()),
                'probability of the right law': probability}
    return score(world, trace, at, [at], more)


def _steps(draw: np.random.Generator, index: int) -> World:
    step, motion = _STEP_CASES[index % len(_STEP_CASES)]
    (low, high), factor = _STEPS[step]
    parameters, x_e = drawn_location(draw, (AS_TOLD, WITHIN)[index // len(_STEP_CASES) % 2])
    wall = drawn_wall(draw, log_uniform(draw, low, high), x_e)
    # Of the softer wall, too, the spring presses more than the damper.
    wall = wall._replace(damping=min(wall.damping, 0.02 * wall.stiffness * factor))
    depth = min(_STIFF_FORCE / (wall.stiffness * max(1.0, factor)), 0.03)
    pieces, seconds = presses(draw, depth, contacts=1, hold_s=5.0, excited=motion == 'excited')
    change = 1.0 + 0.3 + _CHANGE_S

    def share(t: Array) -> Array:
        return np.where(t < change, 1.0, factor)

    return simulate(f'{step}, {motion}', parameters, pieces, seconds, wall._replace(factor=share),
                    drawn_sensor(draw), draw, {'change': change})


def _score_steps(world: World, trace: Trace) -> Score:
    change, (begin, end) = world.marks['change'], world.truth.contacts[0]
    return score(world, trace, instants=settled_instants(world, change - begin + 0.5), more={
        'to 10 % [s]': _settled_after(world, trace, change, end - 0.1)})


def _settled_after(world: World, trace: Trace, change: float, end: float) -> float:
    """Return the time from a change until K_hat stays within 10 % [s]; inf: never."""
    inside = (trace.t >= change) & (trace.t < end)
    if not inside.any():
        return nan
    t = trace.t[inside]
    truth = np.interp(t, world.truth.t, world.truth.stiffness)
    away = np.flatnonzero(np.abs(trace.K[inside] / truth - 1.0) > _CLOSE)
    if len(away) == 0:
        return 0.0
    return float(t[away[-1] + 1] - change) if away[-1] + 1 < len(t) else inf


def _drift(draw: np.random.Generator, index: int) -> World:
    """Stiffen by half within 10 s of a press."""
    parameters, x_e = drawn_location(draw, (AS_TOLD, WITHIN)[index % 2])
    wall = drawn_wall(draw, spread(index), x_e)
    depth = min(_STIFF_FORCE / (1.5 * wall.stiffness), 0.03)
    pieces, seconds = presses(draw, depth, contacts=1, hold_s=11.0)

    def factor(t: Array) -> Array:
        return 1.0 + 0.5 * np.clip((t - 2.3) / 10.0, 0.0, 1.0)

    return simulate('', parameters, pieces, seconds, wall._replace(factor=factor),
                    drawn_sensor(draw), draw)


ROWS = {
    'laws': Row('3 s after the touch of walls of other laws', 84, 28, _laws, _score_laws),
    'steps': Row('stiffness that changes in contact', 40, 10, _steps, _score_steps),
    'drift': Row('stiffness that grows by half in 10 s', 12, 4, _drift, score),
}
"""By name."""
