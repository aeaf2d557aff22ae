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

"""
Random draws of effect parameters as functions of a strength.

Signs, time constants and the like are drawn here. The magnitude is proportional to a strength
from 0 (no effect) to 1 (strongest plausible), which follows from the degree of concealment.
"""

from __future__ import annotations

from math import exp, log, pi
from typing import Callable, Mapping, NamedTuple

from numpy.random import Generator

from .worlds import RandomWorld
from ..parameters.specification import specifications
from ..physics import EFFECTS
from ..physics.physics import Scales
from ..plant.plant_parameters import WallParameters

Values = Mapping[str, float]
Strength = Callable[[float], Values]
_Draw = Callable[[Scales, Generator], Strength]

_LARGEST_DAMPING = 300.0  # of a wall, at half the depth [N s/m]


def draw_strength(name: str, scales: Scales, rng: Generator) -> Strength:
    """
    Draw the parameters of an effect except its magnitude.

    Parameters
    ----------
    name : str
        Key of EFFECTS.
    scales : Scales
        Characteristic magnitudes of the world.
    rng : numpy.random.Generator
        Random generator.

    Returns
    -------
    strength : callable
        Strength, 0 to 1, to parameters by name.

    """
    draw = _DRAWS.get(name)
    return _from_its_own_start(name, scales) if draw is None else draw(scales, rng)


def wall_alike(name: str, values: Values, world: RandomWorld) -> WallParameters:
    """
    Return the spring-damper with which a modeller unaware of the effect would replace the wall.

    Parameters
    ----------
    name : str
        Key of EFFECTS or of UNKNOWN.
    values : mapping
        Parameters of the effect.
    world : RandomWorld
        World without the effect.

    Returns
    -------
    wall : WallParameters
        True wall; for hunt_crossley_damping, which has no B_e, with its damping at half depth.

    """
    wall = world.wall
    damping = 0.5 * values['chi'] * world.depth if 'chi' in values else wall.damping
    return WallParameters(
        stiffness=wall.stiffness, damping=float(f'{damping:.6g}'), location=wall.location)


def _from_its_own_start(name: str, scales: Scales) -> Strength:
    """Scale the first parameter of the start values of an effect without an entry in _DRAWS."""
    cls = EFFECTS[name]
    names = [spec.name for spec in specifications(cls.Parameters)]
    start = dict(zip(names, cls.starts(scales)[0]))
    neutral = cls.neutral.get(names[0], 0.0)
    most = 30.0 * (start[names[0]] - neutral)
    return lambda s: {**start, names[0]: neutral + s * most}


def _proportional(
    parameter: str, most: Callable[[Scales], float], either_sign: bool = False
) -> _Draw:
    """Build the draw of an effect with one parameter."""
    def draw(scales: Scales, rng: Generator) -> Strength:
        strongest = most(scales) * (_sign(rng) if either_sign else 1.0)
        return lambda s: {parameter: s * strongest}

    return draw


def _limit(greatest: Callable[[Scales], float]) -> _Draw:
    """Build the draw of a saturation."""
    def draw(scales: Scales, rng: Generator) -> Strength:
        return lambda s: {'limit': (1.0 - 0.8 * s) * greatest(scales)}

    return draw


class _Branch(NamedTuple):
    """A log-uniform range."""

    low: float
    high: float

    def draw(self, rng: Generator) -> float:
        return exp(rng.uniform(log(self.low), log(self.high)))


def _sign(rng: Generator) -> float:
    return float(rng.choice([-1.0, 1.0]))


def _stribeck(scales: Scales, rng: Generator) -> Strength:
    fall, v_s = float(rng.uniform(1.5, 3.0)), _Branch(0.05, 0.4).draw(rng) * scales.speed
    most = 0.3 * scales.force
    return lambda s: {'F_c': s * most / fall, 'F_s': s * most, 'v_s': v_s}


def _cubic(scales: Scales, rng: Generator) -> Strength:
    share = float(rng.choice([1.0, -0.2]))  # softening must stay monotonic within the depth
    return lambda s: {'K_3': s * share * scales.stiffness / scales.depth**2}


def _power_law(scales: Scales, rng: Generator) -> Strength:
    most, half = float(rng.choice([1.0, -0.4])), 0.5 * scales.depth

    def values(s: float) -> Values:
        n = 1.0 + s * most
        return {'n': n, 'K_n': scales.stiffness * half ** (1.0 - n)}

    return values


def _viscoelastic(scales: Scales, rng: Generator) -> Strength:
    tau = _Branch(0.03, 0.6).draw(rng)
    return lambda s: {'K_1': 2.0 * s * scales.stiffness, 'tau': tau}


def _bouc_wen(scales: Scales, rng: Generator) -> Strength:
    beta = _Branch(0.8, 8.0).draw(rng) / scales.depth
    gamma = float(rng.uniform(-0.4, 0.4)) * beta
    return lambda s: {'alpha': 1.5 * s * scales.stiffness, 'beta': beta, 'gamma': gamma}


def _moving(scales: Scales, rng: Generator) -> Strength:
    frequency, phase = _Branch(0.4, 5.0).draw(rng), float(rng.uniform(0.0, 2.0 * pi))
    return lambda s: {
        'amplitude': 0.3 * s * scales.depth, 'frequency': frequency, 'phase': phase}


def _bilinear(scales: Scales, rng: Generator) -> Strength:
    depth = float(rng.uniform(0.3, 0.7)) * scales.depth
    return lambda s: {'K_2': 2.0 * s * scales.stiffness, 'depth': depth}


def _mismatch(scales: Scales, rng: Generator) -> Strength:
    names = ('K_t_scale', 'B_t_scale', 'M_t_scale')
    shares = [0.5 * _sign(rng) * float(rng.uniform(0.3, 1.0)) for _ in names]
    return lambda s: {name: 1.0 + s * share for name, share in zip(names, shares)}


_DRAWS: dict[str, _Draw] = {
    'coulomb_friction': _proportional('F_c', lambda e: 0.4 * e.force),
    'stribeck_friction': _stribeck,
    'environment_inertia': _proportional('M_e', lambda e: e.mass),
    'cubic_stiffness': _cubic,
    'power_law_stiffness': _power_law,
    'hunt_crossley_damping': _proportional('chi', lambda e: 2.0 * _LARGEST_DAMPING / e.depth),
    'quadratic_damping': _proportional('B_2', lambda e: 0.5 * e.force / e.speed**2),
    'viscoelastic_relaxation': _viscoelastic,
    'bouc_wen_hysteresis': _bouc_wen,
    'contact_offset': _proportional('offset', lambda e: 0.5 * e.depth, either_sign=True),
    'moving_environment': _moving,
    'adhesion': _proportional('F_a', lambda e: 0.7 * e.force),
    'dead_zone': _proportional('gap', lambda e: 0.5 * e.depth),
    'backlash': _proportional('gap', lambda e: 0.5 * e.depth),
    'bilinear_stiffness': _bilinear,
    'stiffness_drift': _proportional('rate', lambda e: 0.7 / e.duration, either_sign=True),
    'plastic_set': _proportional('residual', lambda e: 0.9),
    'tool_inertia': _proportional('mass', lambda e: e.mass),
    'force_lag': _proportional('tau', lambda e: 0.1),
    'force_delay': _proportional('delay', lambda e: 0.1),
    'force_bias': _proportional('bias', lambda e: 0.3 * e.force, either_sign=True),
    'force_drift': _proportional(
        'rate', lambda e: 0.5 * e.force / e.duration, either_sign=True),
    'force_saturation': _limit(lambda e: e.force),
    'robot_friction': _proportional('F_c', lambda e: 0.6 * e.force),
    'impedance_mismatch': _mismatch,
    'reflected_inertia': _proportional('M_r', lambda e: e.mass),
    'command_delay': _proportional('delay', lambda e: 0.1),
    'actuator_saturation': _limit(lambda e: e.control),
}
"""By effect; an effect without an entry is drawn from its own start values."""
