# Copyright 2026 contact_estimation authors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""The impedance law of a robot with all its effects, for numbers and arrays."""

from __future__ import annotations

import math
from typing import Any, Sequence

import numpy as np

from .effect import Effect
from .force_lag import ForceLag, ForceLagParameters
from .numeric import Array
from .robot_effect import RobotEffect


class RobotLaw:
    """
    Eq. (1) as a force on a mass: mass xdd = force + F_e.

    force = f - drag(xd), tau f' + f = control(M_t xdd_r - B_t (xd - xd_r) - K_t (x - x_r) + F_r),
    the reference delayed by `reference_delay`, F_r with force tracking only.

    Parameters
    ----------
    mass, damping, stiffness : float
        M_t [kg], B_t [N s/m], K_t [N/m].
    effects : sequence of Effect
        Effects of other ports are ignored.

    Attributes
    ----------
    mass : float
        Moving mass [kg].
    damping, stiffness : float
        Of the impedance law [N s/m], [N/m].
    reference_delay : float
        Delay of the reference [s].
    states : int
        1 with a lag of the drives, whose state is f [N], else 0.

    """

    def __init__(
        self, mass: float, damping: float, stiffness: float, effects: Sequence[Effect]
    ) -> None:
        arm = [effect for effect in effects if isinstance(effect, RobotEffect)]
        self._feed_forward = mass * math.prod(effect.mass_scale for effect in arm)
        self.damping = damping * math.prod(effect.damping_scale for effect in arm)
        self.stiffness = stiffness * math.prod(effect.stiffness_scale for effect in arm)
        self.mass = self._feed_forward + sum(effect.reflected_inertia for effect in arm)
        self.reference_delay = sum(effect.reference_delay for effect in arm)
        self._lag = sum(effect.actuator_lag for effect in arm)
        self.states = int(self._lag > 0.0)
        self._controls = [e for e in arm if type(e).control is not RobotEffect.control]
        self._drags = [e for e in arm if type(e).drag is not RobotEffect.drag]

    def impedance_force(self, x: Any, v: Any, reference: Any) -> Any:
        """
        Evaluate the impedance law.

        Parameters
        ----------
        x, v : float or ndarray, shape (N,)
            Position [m] and velocity [m/s].
        reference : sequence of float, or ndarray, shape (4, N)
            x_r [m], its rate [m/s] and acceleration [m/s^2], F_r [N] (0: none).

        Returns
        -------
        u : float or ndarray, shape (N,)
            Force commanded to the drives [N].

        """
        x_r, v_r, a_r, F_r = reference
        return (self._feed_forward * a_r - self.damping * (v - v_r)
                - self.stiffness * (x - x_r) + F_r)

    def force(self, x: Any, v: Any, reference: Any, m: Any) -> Any:
        """
        Return the force that drives the mass, without a lag; parameters as `impedance_force`.

        m is `math` or `numpy`.

        Returns
        -------
        force : float or ndarray, shape (N,)
            Without F_e [N].

        """
        return self.less_drag(self.control(x, v, reference, m), v, m)

    def control(self, x: Any, v: Any, reference: Any, m: Any) -> Any:
        """Return the force that is asked of the drives [N]; parameters as `force`."""
        u = self.impedance_force(x, v, reference)
        for effect in self._controls:
            u = effect.control(u, m)
        return u

    def less_drag(self, f: Any, v: Any, m: Any) -> Any:
        """Subtract the drag at a velocity v [m/s] from the force f of the drives [N]."""
        for effect in self._drags:
            f = f - effect.drag(v, m)
        return f

    def rate(self, u: float, f: float) -> float:
        """Return f' [N/s] where a control force u is asked of drives that lag [N]."""
        return (u - f) / self._lag

    def force_along(self, t: Array, x: Array, v: Array, reference: Array) -> Array:
        """
        Evaluate the driving force along a recorded motion.

        Parameters
        ----------
        t, x, v : ndarray, shape (N,)
            Time [s], evenly spaced, position [m] and velocity [m/s].
        reference : ndarray, shape (4, N)
            As of `impedance_force`.

        Returns
        -------
        force : ndarray, shape (N,)
            Without F_e [N].

        """
        u = self.control(x, v, reference, np)
        if self._lag:
            u = ForceLag(ForceLagParameters(tau=self._lag)).sense_along(t, u, u)
        return np.asarray(self.less_drag(u, v, np))

    @property
    def is_linear(self) -> bool:
        """Whether no effect limits, delays or opposes the control force."""
        return not self._controls and not self._drags and not self._lag
