# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

from .law import Any, dataclass, ForceSensorEffect, Need, Number, optional_parameter, Prior, Scales


@dataclass(frozen=True)
class ToolInertia(ForceSensorEffect):
    """
    The force sensor also measures the inertia of the tool mounted on it.

    It acts in free flight, too.
    """

    mass: float = optional_parameter('Mass between sensor and contact', 'kg', minimum=0.0)

    equation = 'F_measured = F_e - mass a'
    family = 'inertia'
    needs = frozenset({Need.TOUCH})  # in an attached environment it is indistinguishable from M_e

    @property
    def added_mass(self) -> float:
        return self.mass

    def sense(self, t: Number, force: Number, acceleration: Number, m: Any) -> Number:
        return force - self.mass * acceleration

    @classmethod
    def prior(cls, scales: Scales) -> Prior:
        return Prior([(0.001 * scales.moved_mass,)], largest=scales.mass)
