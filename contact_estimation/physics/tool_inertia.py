# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Inertia of the tool beyond the force sensor."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .drawn_effect import Scales
from .force_sensor_effect import ForceSensorEffect
from .numeric import Array
from ..parameters.specification import optional_parameter, ParameterGroup


@dataclass(frozen=True)
class ToolInertiaParameters(ParameterGroup):
    """Parameters of `ToolInertia`."""

    mass: float = optional_parameter('Mass between sensor and contact', 'kg', minimum=0.0)


class ToolInertia(ForceSensorEffect):
    """F - mass a, also in free flight."""

    name = 'tool_inertia'
    equation = 'F_measured = F_e - mass a'
    family = 'inertia'
    description = 'The force sensor also measures the inertia of the tool mounted on it.'
    Parameters = ToolInertiaParameters
    needs_touch = True  # in an attached environment it is indistinguishable from M_e

    def __init__(self, values: ToolInertiaParameters) -> None:
        super().__init__(values)
        self.added_mass = values.mass

    def sense(self, t: float, dt: float, force: float, acceleration: float) -> float:
        """Subtract mass a; see `ForceSensorEffect.sense`."""
        return force - float(self.values.mass) * acceleration

    def sense_along(self, t: Array, force: Array, acceleration: Array) -> Array:
        """Subtract mass a; see `ForceSensorEffect.sense_along`."""
        return np.asarray(force - self.values.mass * acceleration)

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """One start: the law is linear in mass."""
        return [(0.001 * scales.moved_mass,)]

    @classmethod
    def largest(cls, scales: Scales) -> float:
        """Return the target mass of the robot."""
        return scales.mass
