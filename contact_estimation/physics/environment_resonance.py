# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

from math import pi

import numpy as np

from .law import (
    Any, Array, ContactEffect, dataclass, discretise, Flags, Generator, log_uniform, Number,
    optional_parameter, Prior, Scales, Seen, State, Strength)
from .moving_environment import MANY_PERIODS

_DAMPED = 0.3  # wide enough for the next of the frequencies to be near
_RESOLVED = 0.125  # periods a sample
_LOWEST, _HIGHEST, _FREQUENCIES = 0.1, 6.0, 9  # times the pace of the motion


@dataclass(frozen=True)
class EnvironmentResonance(ContactEffect):
    """
    A mass behind the surface resonates on a spring and a damper of its own.

    d = v = 0 out of contact.

    Den Hartog, Mechanical Vibrations, 1956 (vibration absorber). States: z = y - d and w = y',
    so that a wall at rest has none at any depth.
    """

    mass: float = optional_parameter('Mass that resonates', 'kg', minimum=0.0)
    frequency: float = optional_parameter(
        'Its natural frequency while the surface rests', 'Hz', minimum=0.01)
    damping_ratio: float = optional_parameter(
        'Its damping over the critical one', '1', minimum=0.001, maximum=0.99)

    equation = ("F_e -= mass y'', y'' = omega^2 (d - y) + 2 damping_ratio omega (v - y'), "
                'omega = 2 pi frequency')
    family = 'inertia'
    resonates = True
    states = 2
    weights = ('mass',)

    @property
    def _omega(self) -> float:
        return float(2.0 * pi * self.frequency)

    def _acceleration(self, v: Any, state: Any) -> Any:
        z, w = state
        return -self._omega * (self._omega * z + 2.0 * self.damping_ratio * (w - v))

    def resistance(self, t: Number, d: Number, v: Number, state: Any, m: Any) -> Number:
        return self.mass * self._acceleration(v, state)

    def state_rates(self, t: float, d: float, v: float, contact: bool, state: State) -> State:
        rate = v if contact else 0.0
        return state[1] - rate, self._acceleration(rate, state)

    def states_along(self, t: Array, d: Array, v: Array, contact: Flags) -> Array:
        from scipy.signal import lfilter  # slow to import

        spring, damping = self._omega**2, 2.0 * self.damping_ratio * self._omega
        system = discretise(1.0, damping, spring, float(t[1] - t[0]))
        # In y and p = y' - damping d no rate of d appears, which jumps at a touch-down.
        rows = (spring * system.position + damping * system.velocity,
                (spring - damping**2) * system.velocity - damping * spring * system.position)
        surface = np.where(contact, d, 0.0)
        moved = surface - surface[0]  # from rest: y = d, y' = 0
        y, p = (lfilter(row, system.denominator, moved) for row in rows)
        return np.array([y - moved, p + damping * moved])

    def is_flexible(self, seen: Seen) -> bool:
        return self.frequency * seen.touch < MANY_PERIODS

    def may_show(self, seen: Seen) -> bool:
        """Need a period, and samples in it: else it is the course of the force alone."""
        fastest = _RESOLVED / seen.sample_period
        return 1.0 / seen.touch <= self.frequency <= fastest

    @classmethod
    def prior(cls, scales: Scales) -> Prior:
        frequencies = np.geomspace(_LOWEST, _HIGHEST, _FREQUENCIES) / scales.pace
        shares = (0.01, 0.5) if scales.driven else (0.01,)  # the force is linear in the mass
        return Prior([(share * scales.moved_mass, float(f), _DAMPED)
                      for share in shares for f in frequencies])

    @classmethod
    def draw(cls, scales: Scales, rng: Generator) -> Strength:
        frequency, ratio = log_uniform(rng, 5.0, 25.0), log_uniform(rng, 0.03, 0.2)
        return lambda s: {'mass': 0.5 * s * scales.mass, 'frequency': frequency,
                          'damping_ratio': ratio}
