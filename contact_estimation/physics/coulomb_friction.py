"""Dry friction in the bearings of the wall."""

from __future__ import annotations

from dataclasses import dataclass
from math import nan
from typing import Any

from ..parameters import ParameterGroup, parameter
from .physics import SIGN_VELOCITY, ContactEffect, Number


@dataclass(frozen=True)
class CoulombFrictionParameters(ParameterGroup):
    """Parameters of `CoulombFriction`."""

    F_c: float = parameter(
        nan, 'Dry friction of the wall, against its motion', 'N', minimum=0.0, nan_is_off=True
    )


class CoulombFriction(ContactEffect):
    """R = F_c sgn(v)."""

    name = 'coulomb_friction'
    equation = 'F_e -= F_c sgn(v)'
    Parameters = CoulombFrictionParameters

    def resistance(self, t: Number, d: Number, v: Number, state: Any, m: Any) -> Number:
        """Give F_c sgn(v); see `ContactEffect.resistance`."""
        return self.values.F_c * m.tanh(v / SIGN_VELOCITY)
