# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

from .law import dataclass, optional_parameter, Prior, RobotEffect, Scales


@dataclass(frozen=True)
class ReflectedInertia(RobotEffect):
    """Inertia of rotors and gears that the feed-forward does not compensate."""

    M_r: float = optional_parameter(
        'Inertia that the feed-forward does not compensate', 'kg', minimum=0.0)

    equation = "(M_t + M_r) x'' = u + F_e"
    family = 'inertia'

    @property
    def reflected_inertia(self) -> float:
        return self.M_r

    @classmethod
    def prior(cls, scales: Scales) -> Prior:
        return Prior([(0.002 * scales.mass,)], largest=scales.mass)
