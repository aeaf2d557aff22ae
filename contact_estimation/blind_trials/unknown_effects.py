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
Effects outside the library, which a diagnosis must report as unexplained.

They exist in blind trials only and are no parameters of any file.
"""

from __future__ import annotations

from math import pi, sin
from types import SimpleNamespace
from typing import Any, Callable, NamedTuple

from numpy.random import Generator

from ..physics.contact_effect import ContactEffect
from ..physics.effect import Effect
from ..physics.force_sensor_effect import ForceSensorEffect
from ..physics.random_strength import Strength, Values
from ..physics.robot_effect import RobotEffect
from ..physics.scales import Scales


class WallResonance(ContactEffect):
    """A mass behind the surface, attached by a spring and a damper."""

    name = 'wall_resonance'
    states = 2

    def _pull(self, d: float, v: float, state: Any) -> float:
        omega, p = 2.0 * pi * self.values.frequency, self.values
        return float(p.mass * omega * (omega * (d - state[0])
                                       + 2.0 * p.damping_ratio * (v - state[1])))

    def resistance(self, t: Any, d: Any, v: Any, state: Any, m: Any) -> Any:
        """Return the force of spring and damper; see `ContactEffect.resistance`."""
        return self._pull(d, v, state)

    def state_rates(
        self, t: float, d: float, v: float, contact: bool, state: tuple[float, ...]
    ) -> tuple[float, ...]:
        """Return the motion of the mass; out of contact the surface is at rest."""
        pull = self._pull(d, v, state) if contact else self._pull(0.0, 0.0, state)
        return state[1], pull / self.values.mass


class SoftSpell(ContactEffect):
    """A wall that is softer during an interval."""

    name = 'soft_spell'

    def resistance(self, t: Any, d: Any, v: Any, state: Any, m: Any) -> Any:
        """Return the missing spring force; see `ContactEffect.resistance`."""
        return -self.values.softer * d if self.values.first < t < self.values.last else 0.0


class WarmingWall(ContactEffect):
    """A wall that softens as motion warms it, and recovers as it cools."""

    name = 'warming_wall'
    states = 1  # warmth, as distance travelled in contact [m]

    def resistance(self, t: Any, d: Any, v: Any, state: Any, m: Any) -> Any:
        """Return the missing spring force; see `ContactEffect.resistance`."""
        return -self.values.softening * state[0] * d

    def state_rates(
        self, t: float, d: float, v: float, contact: bool, state: tuple[float, ...]
    ) -> tuple[float, ...]:
        """Return the rate of warmth: heating by motion in contact, exponential cooling."""
        return ((abs(v) if contact else 0.0) - state[0] / self.values.tau,)


class Ripple(ContactEffect):
    """A force periodic in the depth, as of a thread or of magnets."""

    name = 'ripple'

    def resistance(self, t: Any, d: Any, v: Any, state: Any, m: Any) -> Any:
        """Return the periodic force; see `ContactEffect.resistance`."""
        return self.values.amplitude * sin(2.0 * pi * d / self.values.wavelength)


class BentGauge(ForceSensorEffect):
    """A force sensor whose gain depends on the load."""

    name = 'bent_gauge'

    def sense(self, t: float, dt: float, force: float, acceleration: float) -> float:
        """Return the distorted force; see `ForceSensorEffect.sense`."""
        return force * (1.0 + float(self.values.bend) * force)


class Windage(RobotEffect):
    """A robot with drag proportional to the square of its speed."""

    name = 'windage'

    def drag(self, velocity: Any, m: Any) -> Any:
        """Return c v abs(v); see `RobotEffect.drag`."""
        return self.values.c * velocity * abs(velocity)


class Unknown(NamedTuple):
    """
    An effect outside the library.

    Attributes
    ----------
    effect : type of Effect
        Its law.
    draw : callable
        From scales of the world and a random generator to a strength, as `Effect.draw`.

    """

    effect: type[Effect]
    draw: Callable[[Scales, Generator], Strength]


def _draw_resonance(scales: Scales, rng: Generator) -> Strength:
    frequency, ratio = float(rng.uniform(6.0, 25.0)), float(rng.uniform(0.03, 0.1))
    return lambda s: {'mass': 0.3 * s * scales.mass, 'frequency': frequency,
                      'damping_ratio': ratio}


def _draw_spell(scales: Scales, rng: Generator) -> Strength:
    first = scales.duration * float(rng.uniform(0.15, 0.6))
    last = first + scales.duration * float(rng.uniform(0.1, 0.25))
    return lambda s: {'softer': 0.8 * s * scales.stiffness, 'first': first, 'last': last}


def _draw_warming(scales: Scales, rng: Generator) -> Strength:
    tau = float(rng.uniform(1.0, 4.0))
    most = 0.8 * scales.stiffness / (0.2 * scales.speed * tau)
    return lambda s: {'softening': s * most, 'tau': tau}


def _draw_ripple(scales: Scales, rng: Generator) -> Strength:
    wavelength = scales.depth / float(rng.uniform(2.0, 5.0))
    return lambda s: {'amplitude': 0.3 * s * scales.force, 'wavelength': wavelength}


def _draw_gauge(scales: Scales, rng: Generator) -> Strength:
    sign = float(rng.choice([-1.0, 1.0]))
    return lambda s: {'bend': 0.5 * sign * s / scales.force}


def _draw_windage(scales: Scales, rng: Generator) -> Strength:
    return lambda s: {'c': 2.0 * s * scales.control / scales.speed**2}


UNKNOWN: dict[str, Unknown] = {
    unknown.effect.name: unknown for unknown in (
        Unknown(WallResonance, _draw_resonance), Unknown(SoftSpell, _draw_spell),
        Unknown(WarmingWall, _draw_warming), Unknown(Ripple, _draw_ripple),
        Unknown(BentGauge, _draw_gauge), Unknown(Windage, _draw_windage),
    )
}


def make_unknown(name: str, values: Values) -> Effect:
    """
    Build an effect outside the library.

    Parameters
    ----------
    name : str
        Key of UNKNOWN.
    values : mapping
        Parameters of the effect.

    Returns
    -------
    effect : Effect
        Effect to pass to `World`.

    """
    parameters: Any = SimpleNamespace(**values)
    return UNKNOWN[name].effect(parameters)
