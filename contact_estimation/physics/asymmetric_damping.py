# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Damping that differs between the directions of motion."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from .contact_effect import ContactEffect
from .drawn_effect import Scales
from .numeric import Number
from ..parameters.specification import optional_parameter, ParameterGroup

_PASSIVE = 1.1  # times B_e


@dataclass(frozen=True)
class AsymmetricDampingParameters(ParameterGroup):
    """Parameters of `AsymmetricDamping`."""

    B_a: float = optional_parameter(
        'Half the difference of the damping towards larger and smaller x', 'N s/m')


class AsymmetricDamping(ContactEffect):
    """
    R = B_a |v|: the damping is B_e + B_a for v > 0 and B_e - B_a for v < 0.

    A shock absorber damps rebound more than compression (Dixon, The Shock Absorber Handbook,
    2007); colliding structures damp their approach (Jankowski 2005). No direction is driven:
    |B_a| <= B_e.
    """

    name = 'asymmetric_damping'
    equation = 'F_e -= B_a |v|'
    family = 'damping_law'
    description = 'Damping that differs between the two directions of motion.'
    Parameters = AsymmetricDampingParameters
    needs_return = True
    either_sign = True

    def resistance(self, t: Number, d: Number, v: Number, state: Any, m: Any) -> Number:
        """Return B_a |v|; see `ContactEffect.resistance`."""
        return self.values.B_a * abs(v)

    @classmethod
    def drives(cls, values: Any, stiffness: float, damping: float) -> bool:
        """Return whether one direction is driven, by more than the fit's error."""
        return bool(abs(values.B_a) > _PASSIVE * damping)

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """One start: the law is linear in B_a."""
        return [(0.01 * scales.damper,)]

    @classmethod
    def largest(cls, scales: Scales) -> float:
        """Return the damping of the wall: more would drive the motion in one direction."""
        return scales.damping
