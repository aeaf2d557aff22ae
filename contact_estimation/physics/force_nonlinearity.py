# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Nonlinear characteristic of the force sensor."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from .drawn_effect import Scales
from .force_gain import CALIBRATED
from .force_sensor_effect import ForceSensorEffect
from .numeric import Array, Number
from ..parameters.specification import optional_parameter, ParameterGroup


@dataclass(frozen=True)
class ForceNonlinearityParameters(ParameterGroup):
    """Parameters of `ForceNonlinearity`."""

    bend: float = optional_parameter('Change of the sensitivity per force', '1/N')
    gain: float = optional_parameter('Sensitivity to small forces', '1', minimum=0.01)


class ForceNonlinearity(ForceSensorEffect):
    """
    F (gain + bend |F|).

    An elastic law of the wall does the same to the force; the motion of a robot, which feels the
    true force, tells it. Fraden, Handbook of Modern Sensors, 2016, section 3.5.
    """

    name = 'force_nonlinearity'
    equation = 'F_measured = F_e (gain + bend |F_e|)'
    family = 'sensor_gain'
    description = 'The sensitivity of the force sensor changes with the force.'
    Parameters = ForceNonlinearityParameters
    neutral = {'gain': 1.0}
    needs_robot = True
    either_sign = True

    def __init__(self, values: ForceNonlinearityParameters) -> None:
        super().__init__(values)
        if values.bend < 0.0:  # beyond twice this force the reading falls
            self.limit = -0.25 * values.gain**2 / values.bend

    def sense(self, t: float, dt: float, force: float, acceleration: float) -> float:
        """Change the sensitivity; see `ForceSensorEffect.sense`."""
        return force * float(self.values.gain + self.values.bend * abs(force))

    def sense_along(self, t: Array, force: Array, acceleration: Array) -> Array:
        """Change the sensitivity; see `ForceSensorEffect.sense_along`."""
        return np.asarray(force * (self.values.gain + self.values.bend * np.abs(force)))

    def undo(self, t: Number, measured: Number) -> Number:
        """Solve for F, up to where the reading falls; see `ForceSensorEffect.undo`."""
        gain, bend = self.values.gain, self.values.bend
        root = np.sqrt(np.maximum(gain**2 + 4.0 * bend * np.abs(measured), 0.0))
        return 2.0 * measured / (gain + root)

    @classmethod
    def exceeds_calibration(cls, values: Any, force: float) -> bool:
        """Compare the sensitivity to small and to large forces."""
        small = values.gain - 1.0
        return bool(max(abs(small), abs(small + values.bend * force)) > CALIBRATED)

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """Bend the greatest force by a tenth up and down."""
        return [(share / scales.force, 1.0) for share in (0.1, -0.1)]

    @classmethod
    def is_flexible(cls, values: Any, duration: float) -> bool:
        """Is always one: it lets force and motion each have a wall of its own."""
        return True

    @classmethod
    def largest(cls, scales: Scales) -> float:
        """Return the bend that would turn the reading at the greatest force."""
        return 0.5 / scales.force
