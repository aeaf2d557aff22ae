# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

from .law import dataclass, optional_parameter, Prior, RobotEffect, Scales

_SLOWEST_S = 0.1  # of a force or torque loop


@dataclass(frozen=True)
class ActuatorLag(RobotEffect):
    """
    The drives deliver the control force with a lag.

    Eppinger and Seering, Proc. IEEE Conf. Robotics and Automation, 1987: actuator dynamics.
    """

    tau: float = optional_parameter('Time constant of the drives', 's', minimum=0.0)

    equation = "M_t x'' = f + F_e, tau f' + f = u"
    family = 'timing'

    @property
    def lag(self) -> float:
        return self.tau

    def is_possible(self, stiffness: float, damping: float) -> bool:
        return self.tau < _SLOWEST_S

    @classmethod
    def prior(cls, scales: Scales) -> Prior:
        # With drives slower than that a robot oscillates.
        return Prior([(tau,) for tau in scales.delays()[::2]], largest=0.05)
