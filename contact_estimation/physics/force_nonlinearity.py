# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

from math import inf

import numpy as np

from .force_gain import CALIBRATED
from .law import (
    Any, dataclass, ForceSensorEffect, Need, Number, optional_parameter, Prior, Scales, Seen)


@dataclass(frozen=True)
class ForceNonlinearity(ForceSensorEffect):
    """
    The sensitivity of the force sensor changes with the force.

    An elastic law of the wall does the same to the force; the motion of a robot, which feels the
    true force, tells it. Fraden, Handbook of Modern Sensors, 2016, section 3.5.
    """

    bend: float = optional_parameter('Change of the sensitivity per force', '1/N')
    gain: float = optional_parameter(
        'Sensitivity to small forces', '1', minimum=0.01, neutral=1.0, linear=True)

    equation = 'F_measured = F_e (gain + bend |F_e|)'
    family = 'sensor_gain'
    needs = frozenset({Need.ROBOT})

    @property
    def largest_reading(self) -> float:
        """Beyond twice this force the reading falls."""
        return -0.25 * self.gain**2 / self.bend if self.bend < 0.0 else inf

    def sense(self, t: Number, force: Number, acceleration: Number, m: Any) -> Number:
        return force * (self.gain + self.bend * abs(force))

    def undo(self, t: Number, measured: Number) -> Number:
        root = np.sqrt(np.maximum(self.gain**2 + 4.0 * self.bend * np.abs(measured), 0.0))
        return 2.0 * measured / (self.gain + root)

    def may_show(self, seen: Seen) -> bool:
        """Compare the sensitivity to small and to large forces."""
        small = self.gain - 1.0
        return max(abs(small), abs(small + self.bend * seen.force)) > CALIBRATED

    def is_flexible(self, seen: Seen) -> bool:
        """Is always one: it lets force and motion each have a wall of its own."""
        return True

    @classmethod
    def prior(cls, scales: Scales) -> Prior:
        # The largest would turn the reading at the greatest force.
        return Prior([(share / scales.force, 1.0) for share in (0.1, -0.1)],
                     largest=0.5 / scales.force, either_sign=True)
