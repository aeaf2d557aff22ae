# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

from .law import Any, dataclass, Number, optional_parameter, Prior, RobotEffect, Scales


@dataclass(frozen=True)
class GravityError(RobotEffect):
    """
    Gravity, compensated wrongly, pushes the robot with a constant force.

    What is left of gravity where the control compensates for another mass, such as that of a
    payload it does not know (Siciliano, Sciavicco, Villani and Oriolo, Robotics, 2009, section
    8.5). At rest the robot is off by F_g / K_t.
    """

    F_g: float = optional_parameter('Force towards the wall that is not compensated', 'N')

    equation = "M_t x'' = u + F_g + F_e"
    family = 'robot'

    def drag(self, velocity: Number, m: Any) -> Number:
        return 0.0 * velocity - self.F_g

    @classmethod
    def prior(cls, scales: Scales) -> Prior:
        return Prior([(0.01 * scales.force,)], largest=0.5 * scales.force)
