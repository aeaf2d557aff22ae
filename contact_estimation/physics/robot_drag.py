# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

from .law import Any, dataclass, Number, optional_parameter, Prior, RobotEffect, Scales


@dataclass(frozen=True)
class RobotDrag(RobotEffect):
    """
    Drag proportional to the square of the speed opposes the motion of the robot.

    Fluid drag, or churning of grease and oil in its gears (Batchelor, An Introduction to Fluid
    Dynamics, 1967).
    """

    c: float = optional_parameter('Drag of the robot at 1 m/s', 'N s^2/m^2', minimum=0.0)

    equation = "M_t x'' = u - c x' |x'| + F_e"
    family = 'robot'

    def drag(self, velocity: Number, m: Any) -> Number:
        return self.c * velocity * abs(velocity)

    @classmethod
    def prior(cls, scales: Scales) -> Prior:
        c = scales.force / scales.speed**2
        return Prior([(0.01 * c,)], largest=0.5 * c)
