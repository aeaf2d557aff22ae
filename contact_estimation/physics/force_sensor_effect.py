# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Base class of the effects of the force sensor."""

from __future__ import annotations

import math
from typing import ClassVar

import numpy as np

from .effect import Effect
from .numeric import Array, Number


class ForceSensorEffect(Effect):
    """Physics of the force sensor: how the measured force differs from the true one."""

    port = 'force_sensor'
    memory: ClassVar[bool] = False
    """Whether the measured force depends on earlier forces."""

    limit: float = math.inf
    """End of the measuring range [N]."""

    added_mass: float = 0.0
    """Mass between sensor and contact [kg], whose inertia the sensor measures."""

    def sense(self, t: float, dt: float, force: float, acceleration: float) -> float:
        """
        Return the measured force at one instant.

        Parameters
        ----------
        t, dt : float
            Time and time since the last call [s].
        force : float
            F_e as measured by the preceding effects of the chain [N].
        acceleration : float
            Acceleration of the end-effector [m/s^2].

        Returns
        -------
        force : float
            Measured force [N].

        """
        return force

    def sense_along(self, t: Array, force: Array, acceleration: Array) -> Array:
        """
        Return the measured force of a whole recording with evenly spaced samples.

        Parameters
        ----------
        t, force, acceleration : ndarray, shape (N,)
            Time [s], F_e [N] and acceleration [m/s^2].

        Returns
        -------
        force : ndarray, shape (N,)
            Measured force [N].

        """
        measured, last = [], float(t[0])
        for now, f, a in zip(t.tolist(), force.tolist(), acceleration.tolist()):
            measured.append(self.sense(now, now - last, f, a))
            last = now
        return np.array(measured)

    def undo(self, t: Number, measured: Number) -> Number:
        """
        Remove from one measured force what depends on neither acceleration nor earlier forces.

        Parameters
        ----------
        t : float or ndarray, shape (N,)
            Time [s].
        measured : float or ndarray, shape (N,)
            Measured force [N].

        Returns
        -------
        force : float or ndarray, shape (N,)
            Force before this effect, as far as it can be recovered [N].

        """
        return measured

    def undo_along(self, t: Array, measured: Array) -> Array:
        """
        Remove from a recording what does not depend on acceleration.

        Parameters
        ----------
        t, measured : ndarray, shape (N,)
            Time [s] and measured force [N].

        Returns
        -------
        force : ndarray, shape (N,)
            Force before this effect, as far as it can be recovered [N].

        """
        return np.asarray(self.undo(t, measured))
