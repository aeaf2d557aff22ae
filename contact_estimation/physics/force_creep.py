# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Creep of the force sensor."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.random import Generator

from .drawn_effect import log_uniform, Scales, Strength
from .force_lag import ForceLag, ForceLagParameters
from .force_sensor_effect import ForceSensorEffect
from .numeric import Array
from ..parameters.specification import optional_parameter, ParameterGroup

_FASTEST_S = 0.1  # of creep; what is faster is dynamics of the sensor
_LONGEST = 0.1  # of the recording
_USUAL = 0.03  # share of the force that small imperfections of a rig look like


@dataclass(frozen=True)
class ForceCreepParameters(ParameterGroup):
    """Parameters of `ForceCreep`."""

    share: float = optional_parameter(
        'Force that appears in time, as a share of that at once', '1', minimum=0.0)
    tau: float = optional_parameter('Time constant of the creep', 's', minimum=0.0)


class ForceCreep(ForceSensorEffect):
    """
    F + share y, tau y' + y = F.

    Bartel and Yaniv, J. Research of the National Bureau of Standards 102(3), 1997: creep of load
    cells. One whose force decays is `ForceDecay`.
    """

    name = 'force_creep'
    equation = "F_measured = F_e + share y, tau y' + y = F_e"
    family = 'relaxation'
    description = 'The force sensor creeps: part of a force appears with time.'
    Parameters = ForceCreepParameters

    memory = True

    def __init__(self, values: ForceCreepParameters) -> None:
        super().__init__(values)
        self._share = values.share
        self._lag = ForceLag(ForceLagParameters(tau=values.tau))

    def sense(self, t: float, dt: float, force: float, acceleration: float) -> float:
        """Add the part that follows; see `ForceSensorEffect.sense`."""
        return force + float(self._share * self._lag.sense(t, dt, force, acceleration))

    def sense_along(self, t: Array, force: Array, acceleration: Array) -> Array:
        """Add the part that follows; see `ForceSensorEffect.sense_along`."""
        followed = self._lag.sense_along(t, force, acceleration)
        return np.asarray(force + self._share * followed)

    def undo_along(self, t: Array, measured: Array) -> Array:
        """Invert the discrete filter; see `ForceSensorEffect.undo_along`."""
        from scipy.signal import lfilter, lfilter_zi  # slow to import, and no node needs it

        decay, begin, end = self._lag.weights(float(t[1] - t[0]))
        share = self._share
        system = [1.0, -decay], [1.0 + share * end, share * begin - decay]
        rest = lfilter_zi(*system) * measured[0]
        return np.asarray(lfilter(*system, measured, zi=rest)[0])

    @classmethod
    def plausible(cls, values: Any) -> bool:
        """Return whether a sensor creeps so slowly, and by less than the force itself."""
        return bool(values.tau > _FASTEST_S and values.share < 1.0)

    @classmethod
    def is_flexible(cls, values: Any, duration: float) -> bool:
        """
        Is one that is still going on at the end, or small.

        A zero that settles looks like the one, and what friction, hum and a warming sensor leave
        like the other.
        """
        return bool(values.tau > _LONGEST * duration or values.share < _USUAL)

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """Spread tau; the law is linear in the share."""
        return [(0.05, tau) for tau in scales.time_constants()[::2]]

    @classmethod
    def largest(cls, scales: Scales) -> float:
        """Return a half."""
        return 0.5

    @classmethod
    def draw(cls, scales: Scales, rng: Generator) -> Strength:
        """Draw tau."""
        tau = max(1.5 * _FASTEST_S, log_uniform(rng, 0.01, 0.08) * scales.duration)
        return lambda s: {'share': 0.5 * s, 'tau': tau}
