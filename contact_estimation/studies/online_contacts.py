# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Rows of the on-line study: contacts with a spring and damper, and healthy sensors."""

from functools import partial
from typing import Any

import numpy as np

from .online_row import (
    AS_TOLD, drawn_depth, drawn_location, drawn_sensor, drawn_wall, end_of_contact, EXACT,
    in_contact, law_families, presses, Row, sample_at, Score, score, spread, Trace, UNKNOWN,
    WITHIN)
from .online_worlds import simulate, World
from .paths import bump, start
from ..physics.prior import log_uniform

_ADVICE = {'surface_unchecked'}  # checks that advise where nothing is wrong
_MEMORIES = 'no effect told', 'force_lag told', 'tool_inertia told'
_TOOL_MASS = 0.5  # [kg]
_VELOCITY_NOISES = 0.0, 1e-3, 3e-3  # [m/s]
_LAGS = 0.5e-3, 1e-3, 1.5e-3, 2e-3  # [s]
_RATES = 100.0, 125.0, 250.0, 500.0, 1000.0  # [Hz]
_TAPS = 10
_TAP_GAP, _TAP_PERIOD_S = 1e-3, 0.5


def _contacts(
    draw: np.random.Generator, index: int, how: str, group: str = '', sensor: Any = (), **path: Any
) -> World:
    """Press twice on one wall, excited in every second world."""
    parameters, x_e = drawn_location(draw, how)
    stiffness = spread(index)
    path = {'excited': index % 2 == 0, **path}
    pieces, seconds = presses(draw, drawn_depth(draw, stiffness), **path)
    return simulate(group, parameters, pieces, seconds, drawn_wall(draw, stiffness, x_e),
                    drawn_sensor(draw, **dict(sensor)), draw)


def _first_touch(draw: np.random.Generator, index: int) -> World:
    memory = _MEMORIES[index % 3]
    sensor = {'tool_mass': _TOOL_MASS} if memory == _MEMORIES[2] else {'poles': 1}
    world = _contacts(draw, index // 3, UNKNOWN, memory, sensor, contacts=1, hold_s=2.0)
    told_effect = {
        'force_lag told': {'physics.force_lag.tau': world.truth.sensor.lag_s},
        'tool_inertia told': {'physics.tool_inertia.mass': _TOOL_MASS}}.get(memory, {})
    return world._replace(parameters={**world.parameters, **told_effect})


def _score_first_touch(world: World, trace: Trace) -> Score:
    at = world.truth.contacts[0][0] + 1.0
    return score(world, trace, at, [at])


def _healthy(draw: np.random.Generator, index: int) -> World:
    how, noise = (WITHIN, UNKNOWN)[index % 2], _VELOCITY_NOISES[index // 2 % 3]
    return _contacts(draw, index // 6, how, f'{how}, velocity noise {1e3 * noise:g} mm/s',
                     {'velocity_noise': noise})


def _score_healthy(world: World, trace: Trace) -> Score:
    inside = in_contact(world, trace)
    warned: list[str] = []
    contacts, count = world.truth.contacts, 0
    # Where x_e is told with an error, it is right to say where the surface is.
    right = _ADVICE | ({'surface_shifted'} if world.group.startswith(WITHIN) else set())
    for k, (begin, end) in enumerate(contacts):
        following = contacts[k + 1][0] if k + 1 < len(contacts) else np.inf
        names = {name for t, name, _ in trace.warnings if begin <= t < following}
        warned += sorted(names - right)
        count += bool(names - right)
    laws = law_families(trace, end_of_contact(world))
    false = {'false law': laws.get('spring_damper', 0.0) < max(laws.values())} if laws else {}
    return score(world, trace, more={
        'warned': warned,
        'withheld': (int(np.isnan(trace.K_std[inside]).sum()), int(inside.sum())),
        'contacts with a warning': (count, len(contacts)), **false})


def _hold(draw: np.random.Generator, index: int) -> World:
    how, motion = ((WITHIN, 'excited'), (EXACT, 'still'), (WITHIN, 'still'))[index % 3]
    return _contacts(draw, index // 3, how, f'{motion}, {how}', contacts=1, hold_s=5.0,
                     excited=motion == 'excited')


def _score_width(world: World, trace: Trace) -> Score:
    k = sample_at(trace, end_of_contact(world))
    width = 100.0 * float(trace.K_std[k]) / world.truth.wall.stiffness
    return score(world, trace, more={'stated std of K [%]': width})


def _stiff(draw: np.random.Generator, index: int) -> World:
    how = (WITHIN, AS_TOLD, UNKNOWN)[index % 3]
    parameters, x_e = drawn_location(draw, how)
    wall = drawn_wall(draw, 1e5, x_e)
    depth = drawn_depth(draw, wall.stiffness)
    still, first_s = presses(draw, depth, contacts=1, hold_s=2.0, excited=False)
    moved, second_s = presses(draw, depth, contacts=1, hold_s=3.0, free_s=1.0 + first_s)
    pieces = [*still, *moved[1:]]
    return simulate(how, parameters, pieces, second_s, wall, drawn_sensor(draw), draw)


def _score_stiff(world: World, trace: Trace) -> Score:
    k = sample_at(trace, world.truth.contacts[0][1] + 0.3)
    kept = 100.0 * abs(float(trace.K[k]) / world.truth.wall.stiffness - 1.0)
    return score(world, trace, more={'K kept after release off [%]': kept})


def _sensor_lag(draw: np.random.Generator, index: int) -> World:
    lag_s = _LAGS[index % 4]
    return _contacts(draw, index // 4, WITHIN, f'{1e3 * lag_s:g} ms', {'lag_s': lag_s},
                     contacts=3, excited=True, hold_s=3.0)


def _score_known_wall(world: World, trace: Trace) -> Score:
    touch = world.truth.contacts[1][0]
    early = trace.K[(trace.t >= touch) & (trace.t < touch + 0.1)]
    off = 100.0 * float(np.max(np.abs(early / world.truth.wall.stiffness - 1.0), initial=0.0))
    return score(world, trace, more={'K off within 0.1 s [%]': off})


def _known_wall(draw: np.random.Generator, index: int) -> World:
    how = (AS_TOLD, WITHIN)[index % 2]
    return _contacts(draw, index // 2, how, how, excited=True)


def _taps(draw: np.random.Generator, index: int) -> World:
    tap_s, how = (0.02, 0.04)[index % 2], (AS_TOLD, WITHIN)[index // 2 % 2]
    parameters, x_e = drawn_location(draw, how)
    wall = drawn_wall(draw, spread(index // 4, 3e3), x_e)
    wall = wall._replace(damping=wall.stiffness * log_uniform(draw, 2e-3, 1e-2))
    depth = min(30.0 / wall.stiffness, 0.05 * tap_s)
    height = _TAP_GAP + depth
    half_s = 0.5 * tap_s / np.sqrt(1.0 - np.cbrt(_TAP_GAP / height))
    pieces = [start(-_TAP_GAP), *(bump(1.0 + _TAP_PERIOD_S * k, half_s, height)
                                  for k in range(_TAPS))]
    return simulate(f'{1e3 * tap_s:g} ms, {how}', parameters, pieces,
                    1.0 + _TAP_PERIOD_S * _TAPS, wall, drawn_sensor(draw), draw)


def _score_taps(world: World, trace: Trace) -> Score:
    after = world.truth.contacts[-1][1] + 0.1
    k = sample_at(trace, after)
    width = 100.0 * float(trace.K_std[k]) / world.truth.wall.stiffness
    detected = [bool(trace.contact[(trace.t > begin) & (trace.t < end + 0.05)].any())
                for begin, end in world.truth.contacts]
    return score(world, trace, after, [after], {
        'stated std of K [%]': width, 'contacts detected': (sum(detected), len(detected))})


def _rates(draw: np.random.Generator, index: int) -> World:
    rate = _RATES[index % 5]
    return _contacts(draw, index // 5, WITHIN, f'{rate:g} Hz', {'rate': rate})


ROWS = {
    'first_touch': Row('x_e unknown, 1 s after the first touch', 36, 9, _first_touch,
                       _score_first_touch),
    'healthy': Row('withheld estimates and false warnings', 60, 12, _healthy, _score_healthy),
    'end_of_contact': Row('x_e told with an error of 2 mm, end of the second contact', 60, 8,
                          partial(_contacts, how=WITHIN), score),
    'end_of_contact_as_told': Row('the same, x_e told without an error', 60, 8,
                                  partial(_contacts, how=AS_TOLD), score),
    'end_of_contact_unknown': Row('the same, x_e unknown', 60, 8,
                                  partial(_contacts, how=UNKNOWN), score),
    'hold_std': Row('a hold of 5 s', 36, 9, _hold, _score_width),
    'stiff': Row('1e5 N/m: pressed at rest, released; pressed in motion', 18, 6, _stiff,
                 _score_stiff),
    'sensor_lag': Row('three contacts, by the lag of the force sensor', 24, 8, _sensor_lag,
                      score),
    'known_wall_touch': Row('second touch of a wall', 24, 6, _known_wall, _score_known_wall),
    'taps': Row('after ten taps', 32, 8, _taps, _score_taps),
    'rates': Row('default parameters at any rate', 30, 10, _rates, score),
}
"""By name."""
