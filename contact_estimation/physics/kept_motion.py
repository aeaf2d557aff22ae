# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The motion of the wall along a recorded motion, kept while the law stays the same."""

from collections import OrderedDict
from typing import Any, Callable, Hashable, NamedTuple

import numpy as np

from .numeric import Array

_MOST, _MOST_BYTES = 12, 1 << 26  # a model and those that differ from it in one value


class StatesAlong:
    """What `ContactEffect.states_along` gives for each effect, by its place in the state."""

    def __init__(self) -> None:
        self._of: dict[tuple[int, int], Array] = {}

    def __setitem__(self, place: slice, along: Array) -> None:
        """Keep the states of an effect, read-only."""
        along.flags.writeable = False
        self._of[place.start, place.stop] = along

    def __getitem__(self, place: slice) -> Array | None:
        """Return the states of an effect; None if it has none."""
        return self._of.get((place.start, place.stop))

    @property
    def nbytes(self) -> int:
        """Size of all."""
        return sum(along.nbytes for along in self._of.values())


class WallMotion(NamedTuple):
    """Internal states and penetration along a recorded motion."""

    states: StatesAlong  # of the effects
    # d, v (N,): penetration [m] and its rate [m/s]
    d: Array
    v: Array
    engaged: Any  # (N,) whether a force can be transmitted


class KeptMotion:
    """
    The wall's motions of the latest laws along the latest recorded motions.

    Most derivatives of a fit are for parameters that neither a state nor the penetration depends
    on, such as K_e. Only a motion whose arrays are read-only is known not to have changed.
    """

    def __init__(self) -> None:
        self._kept: OrderedDict[Hashable, tuple[Array, Array, WallMotion]] = OrderedDict()
        self._bytes = 0

    def along(
        self, law: Hashable, x: Array, v: Array, compute: Callable[[], WallMotion]
    ) -> WallMotion:
        """Return the wall's motion; law is all it depends on beside x and v."""
        if x.flags.writeable or v.flags.writeable:
            return compute()
        key = (id(x), id(v), law)
        if key in self._kept:  # the entry holds the arrays: no other ones have their identity
            self._kept.move_to_end(key)
            return self._kept[key][2]
        motion = compute()
        for array in motion:
            if isinstance(array, np.ndarray):
                array.flags.writeable = False
        self._kept[key] = (x, v, motion)
        self._bytes += _bytes_of(motion)
        while len(self._kept) > _MOST or self._bytes > _MOST_BYTES and len(self._kept) > 1:
            _, (_, _, oldest) = self._kept.popitem(last=False)
            self._bytes -= _bytes_of(oldest)
        return motion


def _bytes_of(motion: WallMotion) -> int:
    return sum(getattr(part, 'nbytes', 0) for part in motion)
