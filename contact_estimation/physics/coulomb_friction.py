# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Coulomb friction of the wall."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from .contact_effect import ContactEffect
from .drawn_effect import Scales
from .numeric import Number
from ..parameters.specification import optional_parameter, ParameterGroup


@dataclass(frozen=True)
class CoulombFrictionParameters(ParameterGroup):
    """Parameters of `CoulombFriction`."""

    F_c: float = optional_parameter('Dry friction force of the wall', 'N', minimum=0.0)


class CoulombFriction(ContactEffect):
    """R = F_c sgn(v)."""

    name = 'coulomb_friction'
    equation = 'F_e -= F_c sgn(v)'
    family = 'friction'
    description = 'Dry friction of constant magnitude opposes the motion of the wall.'
    Parameters = CoulombFrictionParameters
    needs_return = True
    jumps = True

    def resistance(self, t: Number, d: Number, v: Number, state: Any, m: Any) -> Number:
        """Return F_c sgn(v); see `ContactEffect.resistance`."""
        return self.values.F_c * m.tanh(v / self.sign_velocity)

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """One start: the law is linear in F_c."""
        return [(0.002 * scales.force,)]

    @classmethod
    def largest(cls, scales: Scales) -> float:
        """Return 0.4 times the largest force."""
        return 0.4 * scales.force
