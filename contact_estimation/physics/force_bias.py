# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

from .law import Any, dataclass, ForceSensorEffect, Number, optional_parameter, Prior, Scales


@dataclass(frozen=True)
class ForceBias(ForceSensorEffect):
    """The force sensor was not tared: a constant is added to the force."""

    bias: float = optional_parameter('Measured force without load', 'N')

    equation = 'F_measured = F_e + bias'
    family = 'sensor_zero'

    def sense(self, t: Number, force: Number, acceleration: Number, m: Any) -> Number:
        return force + self.bias

    def undo(self, t: Number, measured: Number) -> Number:
        return measured - self.bias

    @classmethod
    def prior(cls, scales: Scales) -> Prior:
        return Prior([(0.002 * scales.force,)], largest=0.3 * scales.force, either_sign=True)
