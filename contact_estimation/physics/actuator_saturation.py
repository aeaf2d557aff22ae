# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

from .law import (
    Any, dataclass, Generator, Number, optional_parameter, positive, Prior, RobotEffect, Scales,
    Strength)


@dataclass(frozen=True)
class ActuatorSaturation(RobotEffect):
    """The drives cannot deliver the commanded force."""

    limit: float = optional_parameter('Largest force of the drives', 'N', minimum=0.0)

    equation = "M_t x'' = clip(u, +-limit) + F_e"
    family = 'limits'

    def control(self, u: Number, m: Any) -> Number:
        return positive(u + self.limit, m) - positive(u - self.limit, m) - self.limit

    @classmethod
    def prior(cls, scales: Scales) -> Prior:
        return Prior([(share * scales.control,) for share in (0.3, 0.5, 0.7, 0.85, 0.96)])

    @classmethod
    def draw(cls, scales: Scales, rng: Generator) -> Strength:
        return lambda s: {'limit': (1.0 - 0.8 * s) * scales.control}
