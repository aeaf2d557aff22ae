# Copyright 2026 contact_estimation authors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""A trial: a world, what is missing from its model, and how well that is concealed."""

from __future__ import annotations

from dataclasses import dataclass
from math import exp, log
from typing import Iterable

import numpy as np
from numpy.random import Generator

from .concealment import conceal, Concealed, degree, NEAR
from .setups import draw_nominal, draw_setup, Setup
from .simulation import Run, scales_of, simulate
from .unknown import UNKNOWN
from ..physics import EFFECTS
from ..physics.random_strength import Strength, Values
from ..plant.plant_parameters import WallParameters

LEAST, MOST = 1.3, 4.0
"""Between which effects are concealed, log-uniform."""

_TRIES = 25
_PLAIN_TRIES = 2
_PLAIN_STRENGTHS = (0.01, 0.3)  # of what no magnitude conceals, as backlash: log-uniform
_GREATEST_FORCE = 320.0  # a blow beyond it is no experiment [N]
_LEAST_CONTACT_S = 2.0


@dataclass(frozen=True)
class Trial:
    """
    What is drawn, all of it.

    Attributes
    ----------
    setup : Setup
        The true world without the effect.
    effect : str
        Key of EFFECTS or of UNKNOWN; '' where nothing is missing.
    values : mapping
        Parameters of the effect.
    nominal : WallParameters
        What the model file says of the wall.
    wanted : float
        How well the effect was to be concealed; 1 without.

    """

    setup: Setup
    effect: str
    values: Values
    nominal: WallParameters
    wanted: float

    @property
    def physics(self) -> Values:
        """Parameters of the effect by dotted name."""
        return {f'{self.effect}.{name}': value for name, value in self.values.items()}

    @property
    def port(self) -> str:
        """Where the effect acts."""
        return port_of(self.effect)


def draw_trial(effect: str, rng: Generator) -> Trial:
    """
    Draw a trial.

    Parameters
    ----------
    effect : str
        Key of EFFECTS or of UNKNOWN, or '' for a world in which nothing is missing.
    rng : numpy.random.Generator
        Source of chance.

    Returns
    -------
    trial : Trial
        Concealed as drawn wherever one of 25 worlds can do so, else as near as they came; what
        shows however small it is gets any strength.

    """
    wanted = exp(rng.uniform(log(LEAST), log(MOST))) if effect else 1.0
    nearest: tuple[float, Trial] | None = None
    plain = 0
    for _ in range(_TRIES):
        setup = draw_setup(rng)
        without = simulate(setup, {}, setup.sensing.rate)
        if not _is_experiment(setup, without):
            continue
        if not effect:
            return Trial(setup, '', {}, draw_nominal(setup.wall, rng, exactly=0.4), wanted)
        draw = UNKNOWN[effect].draw if effect in UNKNOWN else EFFECTS[effect].draw
        strength = draw(scales_of(setup, without), rng)
        found = _conceal(effect, strength, setup, without, wanted)
        plain += found.plain
        if plain == _PLAIN_TRIES:
            low, high = _PLAIN_STRENGTHS
            any_strength = exp(rng.uniform(log(low), log(high)))
            return _trial(setup, effect, strength(any_strength), wanted, rng)
        away = abs(found.degree / wanted - 1.0)
        if nearest is None or away < nearest[0]:
            nearest = away, _trial(setup, effect, strength(found.strength), wanted, rng)
        if away < NEAR:
            break
    assert nearest is not None, 'most setups are experiments'
    return nearest[1]


def _trial(
    setup: Setup, effect: str, values: Values, wanted: float, rng: Generator
) -> Trial:
    values = {name: float(f'{value:.6g}') for name, value in values.items()}
    nominal = draw_nominal(wall_alike(effect, values, setup), rng, exactly=0.1)
    return Trial(setup, effect, values, nominal, wanted)


def _conceal(
    effect: str, strength: Strength, setup: Setup, without: Run, wanted: float
) -> Concealed:
    port, rate = port_of(effect), setup.sensing.rate

    def degree_of(s: float) -> float:
        physics = {f'{effect}.{name}': value for name, value in strength(s).items()}
        return degree(port, setup, simulate(setup, physics, rate), without)

    return conceal(degree_of, wanted)


def _is_experiment(setup: Setup, run: Run) -> bool:
    """Tell whether the wall is touched for long enough, and not struck."""
    contact = float(np.mean(run.force < 0.0)) * float(run.t[-1])
    return contact > _LEAST_CONTACT_S and float(-np.min(run.force)) < _GREATEST_FORCE


def port_of(effect: str) -> str:
    """
    Tell where an effect acts.

    Parameters
    ----------
    effect : str
        Key of EFFECTS or of UNKNOWN.

    Returns
    -------
    port : str
        'contact', 'force_sensor' or 'robot'.

    """
    return UNKNOWN[effect].effect.port if effect in UNKNOWN else EFFECTS[effect].port


def plan_effects(count: int, seed: int, names: Iterable[str] = EFFECTS) -> list[str]:
    """
    Spread trials over the whole vocabulary.

    Parameters
    ----------
    count : int
        Of trials.
    seed : int
        Of the study.
    names : iterable of str
        The vocabulary.

    Returns
    -------
    effects : list of str, length `count`
        Every effect once before any comes twice; a longer plan begins as a shorter one.

    """
    effects: list[str] = []
    while len(effects) < count:
        rng = np.random.default_rng([seed, len(effects)])
        effects += rng.permutation(list(names)).tolist()
    return effects[:count]


def wall_alike(effect: str, values: Values, setup: Setup) -> WallParameters:
    """
    Return the spring-damper that a model without the effect would contain.

    Parameters
    ----------
    effect : str
        Key of EFFECTS or of UNKNOWN, or ''.
    values : mapping
        Parameters of the effect.
    setup : Setup
        The world without the effect.

    Returns
    -------
    wall : WallParameters
        That of the setup, with the damping equivalent to an effect that replaces B_e.

    """
    wall = setup.wall
    damping = wall.damping
    if effect in EFFECTS:
        damping = EFFECTS[effect].equivalent_damping(values, damping, setup.depth)
    return WallParameters(
        stiffness=wall.stiffness, damping=float(f'{damping:.6g}'), location=wall.location)


def is_exact(trial: Trial) -> bool:
    """Tell whether the model file has the true wall."""
    return not trial.effect and trial.nominal == trial.setup.wall
