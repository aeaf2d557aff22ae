# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""What a row of the on-line study is, and what its worlds are drawn from."""

from __future__ import annotations

from math import nan
from typing import Any, Callable, NamedTuple

import numpy as np

from .online_paths import Piece, ramp, sines, start
from .online_trace import follow, Score, Trace
from .online_worlds import Sensor, Wall, World
from ...physics.random_strength import log_uniform

GAP = 5e-3
"""Of the tool from the wall in free flight [m]."""

AS_TOLD, WITHIN, EXACT, UNKNOWN = 'x_e as told', 'x_e within 2 mm', 'x_e exact', 'x_e unknown'
MOVE_S = 0.5
"""Duration of an approach and of a withdrawal [s]."""

_DEEPEST = 0.03  # [m]
_LOCATION, _LOCATION_STD, _FARTHEST = 0.3, 2e-3, 3.0  # [m], [m], of them
_GOLDEN = 0.6180339887


class Row(NamedTuple):
    """One item that is measured."""

    meaning: str  # what is measured
    # worlds, quick: number of worlds, and with --quick
    worlds: int
    quick: int
    # makes a world from a generator and its index
    make: Callable[[np.random.Generator, int], World]
    score: Callable[[World, Trace], Score]  # scores a trace of a world

    def run(self, draw: np.random.Generator, index: int) -> Score:
        """Make, follow and score one world."""
        world = self.make(draw, index)
        return self.score(world, follow(world))


def spread(index: int, low: float = 300.0, high: float = 3e4) -> float:
    """Return a stiffness [N/m], evenly spread in its logarithm over consecutive indices."""
    share: float = (0.5 + index * _GOLDEN) % 1.0
    return low * (high / low)**share


def drawn_wall(draw: np.random.Generator, stiffness: float, location: float, **law: Any) -> Wall:
    """Return a wall with B_e / K_e of 2 to 50 ms."""
    return Wall(stiffness, stiffness * log_uniform(draw, 2e-3, 5e-2), location, **law)


def drawn_sensor(draw: np.random.Generator, **known: Any) -> Sensor:
    """Return a sensor as real ones are, the velocity measured by every second."""
    drawn = Sensor(
        draw.uniform(0.5e-3, 1.6e-3), int(draw.integers(1, 3)), log_uniform(draw, 0.1, 0.5),
        0.05 * draw.standard_normal(), log_uniform(draw, 2e-7, 2e-6),
        1e-4 if draw.uniform() < 0.5 else nan)
    return drawn._replace(**known)


def told(draw: np.random.Generator, how: str) -> tuple[dict[str, Any], float]:
    """Return the parameters that tell x_e, and the true x_e [m]."""
    off = float(np.clip(draw.standard_normal(), -_FARTHEST, _FARTHEST)) * _LOCATION_STD
    parameters: dict[str, Any] = {'environment.location': _LOCATION}
    if how == EXACT:
        parameters['environment.location_std'] = 0.0
    elif how == UNKNOWN:
        parameters['environment.location'] = nan
    return parameters, _LOCATION + (off if how in (WITHIN, UNKNOWN) else 0.0)


def drawn_depth(draw: np.random.Generator, stiffness: float) -> float:
    """Return the depth of a press of 20 to 60 N [m]."""
    return min(draw.uniform(20.0, 60.0) / stiffness, _DEEPEST)


def presses(
    draw: np.random.Generator, depth: float, contacts: int = 2, hold_s: float = 4.0,
    excited: bool = True, free_s: float = 1.0,
) -> tuple[list[Piece], float]:
    """Return a path that presses to a depth [m], holds and withdraws, and its duration [s]."""
    pieces, t = [start(-GAP)], 0.0
    for _ in range(contacts):
        t += free_s
        pieces.append(ramp(t, MOVE_S, GAP + depth))
        t += MOVE_S
        if excited:
            pieces.append(sines(t, t + hold_s, depth / 3.0, draw))
        t += hold_s
        pieces.append(ramp(t, MOVE_S, -GAP - depth))
        t += MOVE_S
    return pieces, t + 0.5 * free_s
