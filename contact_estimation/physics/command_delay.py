# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Delay of the reference."""

from __future__ import annotations

from dataclasses import dataclass

from .drawn_effect import Scales
from .robot_effect import RobotEffect
from ..parameters.specification import optional_parameter, ParameterGroup


@dataclass(frozen=True)
class CommandDelayParameters(ParameterGroup):
    """Parameters of `CommandDelay`."""

    delay: float = optional_parameter('Delay of the reference', 's', minimum=0.0)


class CommandDelay(RobotEffect):
    """The reference at t - delay."""

    name = 'command_delay'
    equation = 'x_r(t - delay) in eq. (1)'
    family = 'timing'
    description = 'The robot follows its reference with a delay.'
    Parameters = CommandDelayParameters
    sampled_delay = 'delay'

    def __init__(self, values: CommandDelayParameters) -> None:
        super().__init__(values)
        self.reference_delay = values.delay

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """Spread the delay."""
        return [(delay,) for delay in scales.delays()[::2]]

    @classmethod
    def largest(cls, scales: Scales) -> float:
        """Return 0.1 s."""
        return 0.1
