# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Drift of the stiffness."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from .contact_effect import ContactEffect
from .drawn_effect import Scales
from .numeric import Number
from ..parameters.specification import optional_parameter, ParameterGroup


@dataclass(frozen=True)
class StiffnessDriftParameters(ParameterGroup):
    """Parameters of `StiffnessDrift`."""

    rate: float = optional_parameter('Relative change of the stiffness per second', '1/s')


class StiffnessDrift(ContactEffect):
    """K_e (1 + rate t) in the linear term."""

    name = 'stiffness_drift'
    equation = 'F_e = -(K_e (1 + rate t) d + B_e v)'
    family = 'wall_motion'
    needs_return = True  # of one stroke and a hold, time tells what relaxes, too
    description = 'The stiffness of the wall increases or decreases linearly with time.'
    Parameters = StiffnessDriftParameters
    needs_spring = True
    either_sign = True

    def spring(self, t: Number, d: Number, force: Number, m: Any) -> Number:
        """Let the stiffness drift; see `ContactEffect.spring`."""
        return force * (1.0 + self.values.rate * t)

    @classmethod
    def is_flexible(cls, values: Any, duration: float) -> bool:
        """Is one."""
        return True

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """One start: nearly linear."""
        return [(0.002 / scales.duration,)]

    @classmethod
    def largest(cls, scales: Scales) -> float:
        """Return the rate at which the stiffness changes by 70 % over the recording."""
        return 0.7 / scales.duration
