# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Base class of the effects of the force sensor."""

from dataclasses import dataclass
import math
from typing import Any, Callable

import numpy as np

from .effect import Effect
from .numeric import Array, Number

Reader = Callable[[float, float, float, float], float]
"""From time, time since the last call [s], force [N] and acceleration [m/s^2] to a force."""


@dataclass(frozen=True)
class ForceSensorEffect(Effect):
    """
    Physics of the force sensor: how the measured force differs from the true one.

    A subclass overrides `sense`, and `undo` where it has an inverse; one whose reading depends on
    earlier forces overrides `reader`, `sense_along` and `undo_along` instead. t, force,
    acceleration and measured are numbers or ndarrays, shape (N,), in SI units; m is the module
    `math` or `numpy`.
    """

    port = 'force_sensor'

    @property
    def largest_reading(self) -> float:
        """End of the measuring range [N]."""
        return math.inf

    @property
    def added_mass(self) -> float:
        """Mass between sensor and contact [kg], whose inertia the sensor measures."""
        return 0.0

    def sense(self, t: Number, force: Number, acceleration: Number, m: Any) -> Number:
        """Return the measured force [N]; force as measured by the preceding effects."""
        return force

    def undo(self, t: Number, measured: Number) -> Number:
        """Return the force before this effect [N], without what depends on acceleration."""
        return measured

    def reader(self) -> Reader:
        """Return a function that reads sample by sample, and keeps what it must of the past."""
        return lambda t, dt, force, acceleration: self.sense(t, force, acceleration, math)

    def sense_along(self, t: Array, force: Array, acceleration: Array) -> Array:
        """Return the measured force of a recording with evenly spaced samples [N]."""
        return np.asarray(self.sense(t, force, acceleration, np))

    def undo_along(self, t: Array, measured: Array) -> Array:
        """Return `undo` of a recording, as far as the force can be recovered [N]."""
        return np.asarray(self.undo(t, measured))
