# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

from .law import ContactEffect, dataclass, Need, optional_parameter, Prior, Scales


@dataclass(frozen=True)
class EnvironmentInertia(ContactEffect):
    """
    Part of the wall moves with the tool, and its inertia adds to the force.

    There is no impulse at touch-down.
    """

    M_e: float = optional_parameter('Mass of the wall that moves with the tool', 'kg', minimum=0.0)

    equation = 'F_e -= M_e a'
    family = 'inertia'
    needs = frozenset({Need.NO_MASS})

    @property
    def inertia(self) -> float:
        return self.M_e

    @classmethod
    def prior(cls, scales: Scales) -> Prior:
        return Prior([(0.001 * scales.moved_mass,)], largest=scales.mass)
