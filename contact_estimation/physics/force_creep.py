# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

from functools import cached_property
from typing import ClassVar

import numpy as np

from .force_lag import ForceLag
from .law import (
    Array, dataclass, ForceSensorEffect, Generator, log_uniform, optional_parameter, Prior, Reader,
    Scales, Seen, Strength)

_FASTEST_S = 0.1  # of creep; what is faster is dynamics of the sensor
_LONGEST = 0.1  # of the recording
_USUAL = 0.03  # share of the force that small imperfections of a rig look like


@dataclass(frozen=True)
class ForceCreep(ForceSensorEffect):
    """
    The force sensor creeps: part of a force appears with time.

    Bartel and Yaniv, J. Research of the National Bureau of Standards 102(3), 1997: creep of load
    cells. One whose force decays is `ForceDecay`.
    """

    share: float = optional_parameter(
        'Force that appears in time, as a share of that at once', '1', minimum=0.0)
    tau: float = optional_parameter('Time constant of the creep', 's', minimum=0.0)

    equation = "F_measured = F_e + share y, tau y' + y = F_e"
    family = 'relaxation'
    sign: ClassVar[float] = 1.0

    @cached_property
    def _lag(self) -> ForceLag:
        return ForceLag(self.tau)

    def reader(self) -> Reader:
        follow, share = self._lag.reader(), self.sign * self.share
        return lambda t, dt, force, a: force + share * follow(t, dt, force, a)

    def sense_along(self, t: Array, force: Array, acceleration: Array) -> Array:
        followed = self._lag.sense_along(t, force, acceleration)
        return np.asarray(force + self.sign * self.share * followed)

    def undo_along(self, t: Array, measured: Array) -> Array:
        """Invert the discrete filter."""
        from scipy.signal import lfilter, lfilter_zi  # slow to import, and no node needs it

        decay, begin, end = self._lag.weights(float(t[1] - t[0]))
        share = self.sign * self.share
        system = [1.0, -decay], [1.0 + share * end, share * begin - decay]
        rest = lfilter_zi(*system) * measured[0]
        return np.asarray(lfilter(*system, measured, zi=rest)[0])

    def is_possible(self, stiffness: float, damping: float) -> bool:
        return self.tau > _FASTEST_S and self.share < 1.0

    def is_flexible(self, seen: Seen) -> bool:
        """Is one that is still going on at the end, or small."""
        # A zero that settles looks like the one, and what friction, hum and a warming sensor leave
        # like the other.
        return self.tau > _LONGEST * seen.duration or self.share < _USUAL

    @classmethod
    def prior(cls, scales: Scales) -> Prior:
        return Prior([(0.05, tau) for tau in scales.time_constants()[::2]])

    @classmethod
    def draw(cls, scales: Scales, rng: Generator) -> Strength:
        tau = max(1.5 * _FASTEST_S, log_uniform(rng, 0.01, 0.08) * scales.duration)
        return lambda s: {'share': 0.5 * s, 'tau': tau}
