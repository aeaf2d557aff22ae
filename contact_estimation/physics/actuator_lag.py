# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Drives that follow the control force with a lag."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from .drawn_effect import Scales
from .robot_effect import RobotEffect
from ..parameters.specification import optional_parameter, ParameterGroup

_SLOWEST_S = 0.1  # of a force or torque loop


@dataclass(frozen=True)
class ActuatorLagParameters(ParameterGroup):
    """Parameters of `ActuatorLag`."""

    tau: float = optional_parameter('Time constant of the drives', 's', minimum=0.0)


class ActuatorLag(RobotEffect):
    """
    M_t xdd = f + F_e, tau f' + f = u.

    Eppinger and Seering, Proc. IEEE Conf. Robotics and Automation, 1987: actuator dynamics.
    """

    name = 'actuator_lag'
    equation = "M_t x'' = f + F_e, tau f' + f = u"
    family = 'timing'
    description = 'The drives deliver the control force with a lag.'
    Parameters = ActuatorLagParameters
    sampled_delay = 'tau'

    def __init__(self, values: ActuatorLagParameters) -> None:
        super().__init__(values)
        self.actuator_lag = values.tau

    @classmethod
    def plausible(cls, values: Any) -> bool:
        """Return whether a torque loop can be so slow."""
        return bool(values.tau < _SLOWEST_S)

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """Spread tau."""
        return [(tau,) for tau in scales.delays()[::2]]

    @classmethod
    def largest(cls, scales: Scales) -> float:
        """Return 0.05 s: a robot with slower drives oscillates."""
        return 0.05
