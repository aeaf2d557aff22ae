# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

from .law import Any, ContactEffect, dataclass, Need, Number, optional_parameter, Prior, Scales


@dataclass(frozen=True)
class ToolWeight(ContactEffect):
    """
    The weight of a tool or payload beyond the sensor is not compensated.

    The component of gravity along the axis on what hangs beyond the sensor (J. Hollerbach,
    W. Khalil and M. Gautier, Springer Handbook of Robotics, 2016, chapter 6). A `force_bias` is
    in the reading alone, a `gravity_error` in the motion alone.
    """

    W: float = optional_parameter('Weight along the contact axis, towards the robot', 'N')

    equation = 'F_e += W, in free flight too'
    family = 'sensor_zero'
    needs = frozenset({Need.ROBOT, Need.TOUCH})  # on an attached wall it is another location

    @property
    def pull(self) -> float:
        return self.W  # of a slack contact: the wall does not pull, the weight does

    def resistance(self, t: Number, d: Number, v: Number, state: Any, m: Any) -> Number:
        return -self.W + 0.0 * v

    def tail(self, d: Number, v: Number, state: Any, m: Any) -> Number:
        return self.W + 0.0 * v

    @classmethod
    def prior(cls, scales: Scales) -> Prior:
        return Prior([(0.01 * scales.force,)], largest=0.5 * scales.force, either_sign=True)
