# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Inertia of the wall."""

from __future__ import annotations

from dataclasses import dataclass

from .contact_effect import ContactEffect
from .drawn_effect import Scales
from ..parameters.specification import optional_parameter, ParameterGroup


@dataclass(frozen=True)
class EnvironmentInertiaParameters(ParameterGroup):
    """Parameters of `EnvironmentInertia`."""

    M_e: float = optional_parameter('Mass of the wall that moves with the tool', 'kg', minimum=0.0)


class EnvironmentInertia(ContactEffect):
    """R = M_e a, without an impulse at touch-down."""

    name = 'environment_inertia'
    equation = 'F_e -= M_e a'
    family = 'inertia'
    description = 'Part of the wall moves with the tool, and its inertia adds to the force.'
    Parameters = EnvironmentInertiaParameters
    base_parameter = 'inertia'

    def __init__(self, values: EnvironmentInertiaParameters) -> None:
        super().__init__(values)
        self.inertia = values.M_e

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """One start: the law is linear in M_e."""
        return [(0.001 * scales.moved_mass,)]

    @classmethod
    def largest(cls, scales: Scales) -> float:
        """Return the target mass of the robot."""
        return scales.mass
