# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""A trial: a randomised world, one effect or none, and a nominal model that lacks the effect."""

from __future__ import annotations

from dataclasses import dataclass
from math import exp, log
from typing import Iterable

import numpy as np
from numpy.random import Generator

from .concealment import conceal, Concealed, degree, TOLERANCE
from .simulation import Run, scales_of, simulate
from .worlds import draw_nominal_wall, draw_world, RandomWorld
from ...physics import EFFECTS
from ...physics.random_strength import Strength, Values
from ...plant.plant_parameters import WallParameters

MIN_DEGREE, MAX_DEGREE = 1.3, 4.0
"""Range of the degree of concealment, log-uniform."""

EFFECTS_OF_A_WALL = [name for name, cls in EFFECTS.items() if not cls.needs_attachment]
"""Effects that the worlds of the trials, in all of which a robot touches a wall, can show."""

_MAX_WORLDS = 25
_NOT_CONCEALABLE_WORLDS = 2  # worlds tried before any strength is accepted
_NOT_CONCEALABLE_STRENGTHS = (0.01, 0.3)  # of effects such as backlash: log-uniform
_MAX_FORCE = 320.0  # more is an impact, not an experiment [N]
_MIN_CONTACT_S = 2.0


@dataclass(frozen=True)
class Trial:
    """Everything drawn for one trial."""

    world: RandomWorld  # True world without the effect
    effect: str  # key of EFFECTS; '' in a clean world
    values: Values  # parameters of the effect
    nominal: WallParameters  # wall of the nominal model
    requested_degree: float  # requested degree of concealment; 1 in a clean world

    @property
    def physics(self) -> Values:
        """Parameters of the effect by dotted name."""
        return {f'{self.effect}.{name}': value for name, value in self.values.items()}

    @property
    def port(self) -> str:
        """Port of the effect."""
        return EFFECTS[self.effect].port

    @property
    def is_exact(self) -> bool:
        """Whether the nominal model equals the true world."""
        return not self.effect and self.nominal == self.world.wall


def draw_trial(effect: str, rng: Generator) -> Trial:
    """Draw a trial."""
    requested = exp(rng.uniform(log(MIN_DEGREE), log(MAX_DEGREE))) if effect else 1.0
    nearest: tuple[float, Trial] | None = None
    not_concealable = 0
    for _ in range(_MAX_WORLDS):
        world = draw_world(rng)
        without = simulate(world, {}, world.sensors.rate)
        if not _is_usable(without):
            continue
        if not effect:
            return Trial(world, '', {}, draw_nominal_wall(world.wall, rng, exact=0.4), requested)
        strength = EFFECTS[effect].draw(scales_of(world, without), rng)
        found = _conceal(effect, strength, world, without, requested)
        not_concealable += found.not_concealable
        if not_concealable == _NOT_CONCEALABLE_WORLDS:
            low, high = _NOT_CONCEALABLE_STRENGTHS
            any_strength = exp(rng.uniform(log(low), log(high)))
            return _trial(world, effect, strength(any_strength), requested, rng)
        deviation = abs(found.degree / requested - 1.0)
        if nearest is None or deviation < nearest[0]:
            nearest = deviation, _trial(world, effect, strength(found.strength), requested, rng)
        if deviation < TOLERANCE:
            break
    assert nearest is not None, 'most worlds are usable'
    return nearest[1]


def _trial(
    world: RandomWorld, effect: str, values: Values, requested: float, rng: Generator
) -> Trial:
    values = {name: float(f'{value:.6g}') for name, value in values.items()}
    nominal = draw_nominal_wall(equivalent_wall(effect, values, world), rng, exact=0.1)
    return Trial(world, effect, values, nominal, requested)


def _conceal(
    effect: str, strength: Strength, world: RandomWorld, without: Run, requested: float
) -> Concealed:
    in_motion, rate = EFFECTS[effect].needs_robot, world.sensors.rate

    def degree_of(s: float) -> float:
        physics = {f'{effect}.{name}': value for name, value in strength(s).items()}
        return degree(in_motion, world, simulate(world, physics, rate), without)

    return conceal(degree_of, requested)


def _is_usable(run: Run) -> bool:
    """Return whether the contact is long enough and free of hard impacts."""
    contact_s = float(np.mean(run.force < 0.0)) * float(run.t[-1])
    return contact_s > _MIN_CONTACT_S and float(-np.min(run.force)) < _MAX_FORCE


def plan_effects(count: int, seed: int, names: Iterable[str] = EFFECTS_OF_A_WALL) -> list[str]:
    """Distribute trials evenly over effects."""
    effects: list[str] = []
    while len(effects) < count:
        rng = np.random.default_rng([seed, len(effects)])
        effects += rng.permutation(list(names)).tolist()
    return effects[:count]


def equivalent_wall(effect: str, values: Values, world: RandomWorld) -> WallParameters:
    """Return the spring-damper by which a modeller unaware of the effect replaces the wall."""
    wall = world.wall
    damping = EFFECTS[effect].equivalent_damping(values, wall.damping, world.depth)
    return WallParameters(
        stiffness=wall.stiffness, damping=float(f'{damping:.6g}'), location=wall.location)
