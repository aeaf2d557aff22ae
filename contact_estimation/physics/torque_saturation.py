# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

from .law import (
    Any, dataclass, Generator, Number, optional_parameter, Prior, RobotEffect, Scales, Strength)


@dataclass(frozen=True)
class TorqueSaturation(RobotEffect):
    """
    The drives deliver less and less of a growing control force.

    Iron saturates, and torque falls behind current (Hughes and Drury, Electric Motors and Drives,
    2019). A limit of the controller clips instead, see `ActuatorSaturation`.
    """

    limit: float = optional_parameter(
        'Force that the drives approach', 'N', minimum=1e-15, logarithmic=True)

    equation = "M_t x'' = limit tanh(u / limit) + F_e"
    family = 'limits'

    def control(self, u: Number, m: Any) -> Number:
        return self.limit * m.tanh(u / self.limit)

    @classmethod
    def prior(cls, scales: Scales) -> Prior:
        return Prior([(share * scales.control,) for share in (0.8, 1.5, 3.0, 8.0)])

    @classmethod
    def draw(cls, scales: Scales, rng: Generator) -> Strength:
        return lambda s: {'limit': scales.control / (2.0 * max(s, 1e-3))}
