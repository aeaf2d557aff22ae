# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Weight of a tool or payload that neither sensor nor control knows."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from .contact_effect import ContactEffect
from .drawn_effect import Scales
from .numeric import Number
from ..parameters.specification import optional_parameter, ParameterGroup


@dataclass(frozen=True)
class ToolWeightParameters(ParameterGroup):
    """Parameters of `ToolWeight`."""

    W: float = optional_parameter('Weight along the contact axis, towards the robot', 'N')


class ToolWeight(ContactEffect):
    """
    F_e + W, in free flight too: a constant force on the tool, which sensor and robot both feel.

    The component of gravity along the axis on what hangs beyond the sensor (J. Hollerbach,
    W. Khalil and M. Gautier, Springer Handbook of Robotics, 2016, chapter 6). A `force_bias` is
    in the reading alone, a `gravity_error` in the motion alone.
    """

    name = 'tool_weight'
    equation = 'F_e += W, in free flight too'
    family = 'sensor_zero'
    description = 'The weight of a tool or payload beyond the sensor is not compensated.'
    Parameters = ToolWeightParameters
    needs_robot = True
    needs_touch = True  # on an attached wall it is another location
    either_sign = True

    def __init__(self, values: ToolWeightParameters) -> None:
        super().__init__(values)
        self.pull = values.W  # of a slack contact: the wall does not pull, the weight does

    def resistance(self, t: Number, d: Number, v: Number, state: Any, m: Any) -> Number:
        """Return -W; see `ContactEffect.resistance`."""
        return -self.values.W + 0.0 * v

    def tail(self, d: Number, v: Number, state: Any, m: Any) -> Number:
        """Return W; see `ContactEffect.tail`."""
        return self.values.W + 0.0 * v

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """One start: the law is linear in W."""
        return [(0.01 * scales.force,)]

    @classmethod
    def largest(cls, scales: Scales) -> float:
        """Return a force of half the largest contact force."""
        return 0.5 * scales.force
