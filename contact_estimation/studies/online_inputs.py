# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Rows of the on-line study: slow touches, noise, faults of the inputs, and glitches."""

from math import inf, nan
from typing import Any, Callable

import numpy as np

from .online_row import (
    BAND, drawn_location, drawn_sensor, drawn_wall, GAP, in_contact, presses, Row, sample_at,
    Score, score, spread, Trace, UNKNOWN, WITHIN)
from .online_worlds import simulate, Stream, World
from .paths import Array, cruise, start
from ..physics.prior import log_uniform

Fault = Callable[[Stream, float, float, np.random.Generator], Stream]
"""Takes messages, begin and end [s] and a generator; returns them with the fault in between."""

_JUMP_NS = 20_000_000_000
_WILD = np.array([1e6, -1e6, 1e3, -1e3, np.nan, np.inf, -np.inf])
_WILD_SHARE = 0.5


def _changed(change: Callable[[Array, np.random.Generator], Array]) -> Fault:
    def fault(stream: Stream, begin: float, end: float, draw: np.random.Generator) -> Stream:
        values = stream.values.copy()
        inside = (stream.t >= begin) & (stream.t < end)
        values[inside] = change(values[inside], draw)
        return stream._replace(values=values)

    return fault


def _silent(stream: Stream, begin: float, end: float, draw: np.random.Generator) -> Stream:
    kept = (stream.t < begin) | (stream.t >= end)
    return Stream(stream.t[kept], stream.stamp_ns[kept], stream.values[kept])


def _back(stream: Stream, begin: float, end: float, draw: np.random.Generator) -> Stream:
    """Set the clock of all stamps back from `begin` on, for good."""
    return stream._replace(stamp_ns=stream.stamp_ns - _JUMP_NS * (stream.t >= begin))


def _wild(values: Array, draw: np.random.Generator) -> Array:
    """Replace every second value by one that is huge or not finite."""
    some = draw.uniform(size=values.shape) < _WILD_SHARE
    return np.where(some, draw.choice(_WILD, values.shape), values)


def _repeated(values: Array, draw: np.random.Generator) -> Array:
    return np.repeat(values[:1], len(values), axis=0)


_FORCE, _MOTION, _BOTH = ('wrenches',), ('motions',), ('wrenches', 'motions')
FAULTS: dict[str, tuple[tuple[str, ...], Fault]] = {
    'noise of 3 N': (_FORCE, _changed(lambda f, draw: f + 3.0 * draw.standard_normal(f.shape))),
    'noise of 8 N': (_FORCE, _changed(lambda f, draw: f + 8.0 * draw.standard_normal(f.shape))),
    'sign flipped': (_FORCE, _changed(lambda f, draw: -f)),
    'force frozen': (_FORCE, _changed(_repeated)),
    'silence': (_BOTH, _silent),
    'wild values': (_BOTH, _changed(_wild)),
    'position frozen': (_MOTION, _changed(_repeated)),
    'clock back': (_BOTH, _back),
}
"""By name: which messages of a world it changes, and how."""

_SLOW_FORCE, _SIGMAS = 20.0, 8.0  # [N], of the noise: what a slow touch must reach
_SLOWEST = 1.0  # rise of the force, or a world lasts for minutes [N/s]
_EARLY_ENOUGH_S = 0.01
_FADE_S = 0.05
_HOLD_S = 3.0
_NOISES = 0.1, 0.5, 1.0, 2.0, 3.0, 5.0  # [N]
_FIRM = 60.0  # [N]
_FAULT_S, _CLEAN_S = 5.5, 10.0
_CYCLE_S, _CYCLE_HOLD_S = 5.0, 3.0  # of presses one after the other
_GLITCH, _FORCE_OUTLIER = 5e-3, 50.0  # [m], [N]
_GLITCHES, _OUTLIERS = 5, 0.01


def _slow_touch(draw: np.random.Generator, index: int) -> World:
    """Touch at a constant speed, the force rising by at least 1 N/s."""
    how = (WITHIN, UNKNOWN)[index % 2]
    parameters, x_e = drawn_location(draw, how)
    wall = drawn_wall(draw, spread(index // 2), x_e)
    noise = log_uniform(draw, 0.1, 3.0)
    speed = log_uniform(draw, max(2e-4, _SLOWEST / wall.stiffness), 5e-2)
    depth = max(_SLOW_FORCE, _SIGMAS * noise) / wall.stiffness
    gap = min(GAP, 2.0 * speed) + _FADE_S * speed
    end = 1.0 + (gap + depth) / speed
    pieces = [start(-gap), cruise(1.0, end, speed, _FADE_S)]
    sensor = drawn_sensor(draw, noise=noise)
    return simulate(how, parameters, pieces, end + _HOLD_S, wall, sensor, draw,
                    {'end': end + _HOLD_S - 0.1})


def _score_slow_touch(world: World, trace: Trace) -> Score:
    touch, noise = world.truth.contacts[0][0], world.truth.sensor.noise
    found = trace.t[trace.contact]
    early = bool(len(found)) and bool(found[0] < touch)
    later = found[found >= touch]
    at, sigmas = (float(later[0]), nan) if len(later) else (inf, inf)
    if len(later):
        sigmas = float(np.interp(at, world.truth.t, world.truth.pressing)) / noise
    in_time = not early and (sigmas < _SIGMAS or at < touch + _EARLY_ENOUGH_S)
    end = world.marks['end']
    return score(world, trace, end, [end], {
        'detected': len(later) > 0, 'early': early, 'in time': in_time,
        'force when detected [sigma]': sigmas, 'after the touch [s]': at - touch,
        'K within 3 % or 2 std': _close_or_covered(world, trace, end)})


def _close_or_covered(world: World, trace: Trace, at: float) -> bool:
    k, K = sample_at(trace, at), world.truth.wall.stiffness
    off = abs(float(trace.K[k]) - K)
    return k >= 0 and bool(np.isfinite(trace.K_std[k])) and off < max(
        0.03 * K, BAND * float(trace.K_std[k]))


def _constant_noise(draw: np.random.Generator, index: int) -> World:
    noise, how = _NOISES[index % 6], (WITHIN, UNKNOWN)[index // 6 % 2]
    parameters, x_e = drawn_location(draw, how)
    wall = drawn_wall(draw, spread(index // 12, 2e3), x_e)
    pieces, seconds = presses(draw, _FIRM / wall.stiffness, excited=index // 12 % 2 == 0)
    return simulate(f'{how}, {noise:g} N', parameters, pieces, seconds, wall,
                    drawn_sensor(draw, noise=noise), draw)


def _score_noise(world: World, trace: Trace) -> Score:
    inside = in_contact(world, trace)
    return score(world, trace, more={
        'seen in contact': (int(trace.contact[inside].sum()), int(inside.sum()))})


def _bursts(draw: np.random.Generator, index: int) -> World:
    """One fault, or in every second world two of them one after the other, then clean presses."""
    names = list(FAULTS)
    chosen = draw.choice(names, 2).tolist() if index % 2 else [names[index // 2 % len(names)]]
    parameters, x_e = drawn_location(draw, WITHIN)
    wall = drawn_wall(draw, spread(index, 1e3), x_e)
    begin = draw.uniform(6.0, 6.0 + _CYCLE_S)
    clean = begin + _FAULT_S * len(chosen)
    pieces, seconds = presses(draw, 0.5 * _FIRM / wall.stiffness, hold_s=_CYCLE_HOLD_S,
                              contacts=int((clean + _CLEAN_S) / _CYCLE_S) + 2)
    world = simulate(', then '.join(chosen), parameters, pieces,
                     seconds, wall, drawn_sensor(draw), draw, {'clean': clean})
    for k, name in enumerate(chosen):
        streams, fault = FAULTS[name]
        at = begin + _FAULT_S * k
        changed: dict[str, Any] = {stream: fault(getattr(world, stream), at, at + _FAULT_S, draw)
                                   for stream in streams}
        world = world._replace(**changed)
    return world


def _score_bursts(world: World, trace: Trace) -> Score:
    """Score in the contact that lasts, or has ended last, 10 s after the fault."""
    until = world.marks['clean'] + _CLEAN_S
    begin, end = [contact for contact in world.truth.contacts if contact[0] + 1.0 < until][-1]
    at = min(until, end - 0.05)
    detected = trace.contact[(trace.t > begin + 0.5) & (trace.t < at)]
    seen = bool(len(detected)) and bool(detected.mean() > 0.5)
    found = score(world, trace, at, [at], {'contact seen': seen})
    wrong = not seen or found.K_held != (1, 1)
    pair = ', then ' in world.group
    return found._replace(group='two of them' if pair else world.group, more={
        **found.more, 'wrong after': [world.group] if wrong and pair else []})


def _glitch(draw: np.random.Generator, index: int) -> World:
    parameters, x_e = drawn_location(draw, WITHIN)
    wall = drawn_wall(draw, spread(index // 2, 1e3), x_e)
    pieces, seconds = presses(draw, 0.5 * _FIRM / wall.stiffness, excited=index // 2 % 2 == 0)
    kind = ('position off by 5 mm, 5 times', 'force off by 50 N, 1 %')[index % 2]
    world = simulate(kind, parameters, pieces, seconds, wall, drawn_sensor(draw), draw)
    stream = world.wrenches if index % 2 else world.motions
    begin, end = world.truth.contacts[-1]
    candidates = np.flatnonzero((stream.t > begin + 0.5) & (stream.t < end - 0.5))
    count = round(_OUTLIERS * len(candidates)) if index % 2 else _GLITCHES
    hit = draw.choice(candidates, count, replace=False)
    size = _FORCE_OUTLIER if index % 2 else _GLITCH
    stream.values[hit, 0] += size * draw.choice((-1.0, 1.0), count)
    return world._replace(marks={'first': float(stream.t[hit.min()])})


def _score_glitch(world: World, trace: Trace) -> Score:
    inside = (trace.t >= world.marks['first']) & (trace.t < world.truth.contacts[-1][1] - 0.05)
    off = np.abs(trace.K[inside] / world.truth.wall.stiffness - 1.0)
    return score(world, trace, more={'K off at most [%]': 100.0 * float(np.max(off, initial=0.0))})


ROWS = {
    'slow_touch': Row('touch at 0.2 to 50 mm/s, noise 0.1 to 3 N, to 20 N', 60, 12, _slow_touch,
                      _score_slow_touch),
    'constant_noise': Row('presses of 60 N', 48, 12, _constant_noise,
                          _score_noise),
    'bursts': Row('10 s after 5.5 s of a fault', 48, 16, _bursts, _score_bursts),
    'glitch': Row('single wrong samples in contact', 24, 6, _glitch, _score_glitch),
}
"""By name."""
