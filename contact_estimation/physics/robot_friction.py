# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

from .law import Any, dataclass, Number, optional_parameter, Prior, RobotEffect, Scales


@dataclass(frozen=True)
class RobotFriction(RobotEffect):
    """Dry friction in the joints of the robot opposes its motion."""

    F_c: float = optional_parameter('Dry friction force of the robot', 'N', minimum=0.0)

    equation = "M_t x'' = u - F_c sgn(x') + F_e"
    family = 'robot'

    def drag(self, velocity: Number, m: Any) -> Number:
        return self.F_c * m.tanh(velocity / self.sign_velocity)

    @classmethod
    def prior(cls, scales: Scales) -> Prior:
        return Prior([(0.002 * scales.force,)], largest=0.6 * scales.force)
