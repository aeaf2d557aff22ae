# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Stribeck friction of the wall."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from numpy.random import Generator

from .contact_effect import ContactEffect
from .drawn_effect import log_uniform, Scales, Strength
from .numeric import Number
from ..parameters.specification import optional_parameter, ParameterGroup

_LEAST_LEFT = 0.1  # of F_s, at speed


@dataclass(frozen=True)
class StribeckFrictionParameters(ParameterGroup):
    """Parameters of `StribeckFriction`."""

    F_c: float = optional_parameter('Friction force at high speed', 'N', minimum=0.0)
    F_s: float = optional_parameter('Friction force near zero speed', 'N', minimum=0.0)
    v_s: float = optional_parameter(
        'Stribeck velocity: speed at which F_s - F_c has fallen to 1/e', 'm/s', minimum=1e-06)


class StribeckFriction(ContactEffect):
    """R = (F_c + (F_s - F_c) exp(-(v / v_s)^2)) sgn(v)."""

    name = 'stribeck_friction'
    equation = 'F_e -= (F_c + (F_s - F_c) exp(-(v / v_s)^2)) sgn(v)'
    family = 'friction'
    description = 'Dry friction of the wall that decreases with speed (Stribeck effect).'
    Parameters = StribeckFrictionParameters
    needs_return = True
    linear_in = ('F_c', 'F_s')
    resolved_speed = 'v_s'
    jumps = True

    def resistance(self, t: Number, d: Number, v: Number, state: Any, m: Any) -> Number:
        """Return the falling friction; see `ContactEffect.resistance`."""
        p = self.values
        level = p.F_c + (p.F_s - p.F_c) * m.exp(-((v / p.v_s) ** 2))
        return level * m.tanh(v / self.sign_velocity)

    @classmethod
    def plausible(cls, values: Any) -> bool:
        """Return whether friction falls with speed, not to nothing."""
        return bool(_LEAST_LEFT * values.F_s < values.F_c < values.F_s)

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """Spread v_s; the law is linear in F_c and F_s."""
        return [(0.002 * scales.force, 0.004 * scales.force, share * scales.speed)
                for share in (0.02, 0.05, 0.1, 0.2, 0.4)]

    @classmethod
    def draw(cls, scales: Scales, rng: Generator) -> Strength:
        """Draw F_s / F_c and v_s."""
        fall, v_s = float(rng.uniform(1.5, 3.0)), log_uniform(rng, 0.05, 0.4) * scales.speed
        most = 0.3 * scales.force
        return lambda s: {'F_c': s * most / fall, 'F_s': s * most, 'v_s': v_s}
