# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Quadratic damping of the wall."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from .contact_effect import ContactEffect
from .drawn_effect import Scales
from .numeric import Number
from ..parameters.specification import optional_parameter, ParameterGroup


@dataclass(frozen=True)
class QuadraticDampingParameters(ParameterGroup):
    """Parameters of `QuadraticDamping`."""

    B_2: float = optional_parameter('Drag at 1 m/s', 'N s^2/m^2')


class QuadraticDamping(ContactEffect):
    """R = B_2 v |v|."""

    name = 'quadratic_damping'
    equation = 'F_e -= B_2 v |v|'
    family = 'damping_law'
    description = 'Drag of the wall proportional to the square of the speed.'
    Parameters = QuadraticDampingParameters

    def resistance(self, t: Number, d: Number, v: Number, state: Any, m: Any) -> Number:
        """Return B_2 v |v|; see `ContactEffect.resistance`."""
        return self.values.B_2 * v * abs(v)

    @classmethod
    def plausible(cls, values: Any) -> bool:
        """Refuse drag that falls with speed: it would drive the motion."""
        return bool(values.B_2 >= 0.0)

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """One start: the law is linear in B_2."""
        return [(0.01 * scales.damper / scales.speed,)]

    @classmethod
    def largest(cls, scales: Scales) -> float:
        """Return B_2 whose drag at the largest speed is half the largest force."""
        return 0.5 * scales.force / scales.speed**2
