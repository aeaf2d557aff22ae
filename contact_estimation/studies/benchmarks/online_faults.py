# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Faults of the on-line study: what drivers, sensors and networks do to messages for a time."""

from __future__ import annotations

from typing import Callable

import numpy as np

from .online_paths import Array
from .online_worlds import Stream, World

Fault = Callable[[World, float, float, np.random.Generator], World]
"""Takes a world, begin and end [s] and a generator; returns it with the fault in between."""

_JUMP_NS = 20_000_000_000
_WILD = np.array([1e6, -1e6, 1e3, -1e3, np.nan, np.inf, -np.inf])
_WILD_SHARE = 0.5


def _changed(stream: Stream, begin: float, end: float, change: Callable[[Array], Array]) -> Stream:
    values = stream.values.copy()
    inside = (stream.t >= begin) & (stream.t < end)
    values[inside] = change(values[inside])
    return stream._replace(values=values)


def noise_burst(std: float) -> Fault:
    """Return the fault that adds white noise [N]."""
    def fault(world: World, begin: float, end: float, draw: np.random.Generator) -> World:
        return world._replace(wrenches=_changed(
            world.wrenches, begin, end, lambda f: f + std * draw.standard_normal(f.shape)))

    return fault


def flipped_sign(world: World, begin: float, end: float, draw: np.random.Generator) -> World:
    """Flip the sign of the force."""
    return world._replace(wrenches=_changed(world.wrenches, begin, end, lambda f: -f))


def frozen_force(world: World, begin: float, end: float, draw: np.random.Generator) -> World:
    """Repeat the first force."""
    return world._replace(wrenches=_changed(
        world.wrenches, begin, end, lambda f: np.repeat(f[:1], len(f), axis=0)))


def frozen_position(world: World, begin: float, end: float, draw: np.random.Generator) -> World:
    """Repeat the first position and velocity."""
    return world._replace(motions=_changed(
        world.motions, begin, end, lambda x: np.repeat(x[:1], len(x), axis=0)))


def silence(world: World, begin: float, end: float, draw: np.random.Generator) -> World:
    """Drop all messages."""
    def dropped(stream: Stream) -> Stream:
        kept = (stream.t < begin) | (stream.t >= end)
        return Stream(stream.t[kept], stream.stamp_ns[kept], stream.values[kept])

    return world._replace(wrenches=dropped(world.wrenches), motions=dropped(world.motions))


def wild_values(world: World, begin: float, end: float, draw: np.random.Generator) -> World:
    """Replace every second value by one that is huge or not finite."""
    def wild(values: Array) -> Array:
        some = draw.uniform(size=values.shape) < _WILD_SHARE
        return np.where(some, draw.choice(_WILD, values.shape), values)

    return world._replace(wrenches=_changed(world.wrenches, begin, end, wild),
                          motions=_changed(world.motions, begin, end, wild))


def clock_back(world: World, begin: float, end: float, draw: np.random.Generator) -> World:
    """Set the clock of all stamps back by 20 s from `begin` on, for good."""
    def late(stream: Stream) -> Stream:
        return stream._replace(stamp_ns=stream.stamp_ns - _JUMP_NS * (stream.t >= begin))

    return world._replace(wrenches=late(world.wrenches), motions=late(world.motions))


FAULTS: dict[str, Fault] = {
    'noise of 3 N': noise_burst(3.0), 'noise of 8 N': noise_burst(8.0),
    'sign flipped': flipped_sign, 'force frozen': frozen_force, 'silence': silence,
    'wild values': wild_values, 'position frozen': frozen_position, 'clock back': clock_back,
}
"""By name."""
