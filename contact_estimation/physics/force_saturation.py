# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

import math

import numpy as np

from .law import (
    Any, dataclass, ForceSensorEffect, Generator, Number, optional_parameter, Prior, Scales, Seen,
    Strength)


@dataclass(frozen=True)
class ForceSaturation(ForceSensorEffect):
    """The force signal is clipped at the end of the measuring range."""

    limit: float = optional_parameter('End of the measuring range', 'N', minimum=0.0)

    equation = 'F_measured = clip(F_e, +-limit)'
    family = 'limits'

    @property
    def largest_reading(self) -> float:
        return self.limit

    def sense(self, t: Number, force: Number, acceleration: Number, m: Any) -> Number:
        if m is math:
            return min(self.limit, max(-self.limit, force))
        return np.clip(force, -self.limit, self.limit)

    def may_show(self, seen: Seen) -> bool:
        return seen.clips(self.limit)

    @classmethod
    def prior(cls, scales: Scales) -> Prior:
        return Prior([(share * scales.force,) for share in (0.4, 0.6, 0.75, 0.87, 0.96)])

    @classmethod
    def draw(cls, scales: Scales, rng: Generator) -> Strength:
        return lambda s: {'limit': (1.0 - 0.8 * s) * scales.force}
