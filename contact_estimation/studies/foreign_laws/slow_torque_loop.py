# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Torque loop of finite bandwidth."""

from __future__ import annotations

from typing import Any

from numpy.random import Generator

from .law import Magnitudes, RobotLaw, Strength


class SlowTorqueLoop(RobotLaw):
    """
    The drives deliver the commanded force through a loop of the second order.

    tau^2 f'' + 2 zeta tau f' + f = u.
    Pratt and Williamson, Proc. IEEE/RSJ Int. Conf. Intelligent Robots and Systems, 1995 (series
    elastic actuators).
    """

    families = ('timing', 'robot', 'inertia')

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        zeta = float(rng.uniform(0.4, 1.0))
        return lambda s: {'tau': max(0.05 * s, 5e-4), 'zeta': zeta}

    def drive(
        self, u: float, x: float, v: float, dt: float, state: Any
    ) -> tuple[float, Any]:
        """Return the force of the loop; see `RobotLaw.drive`."""
        tau, zeta = self.values.tau, self.values.zeta
        f, rate = state or (u, 0.0)
        # Implicit in f and its rate: stable for loops far faster than a step.
        damping, spring = 2.0 * zeta / tau, 1.0 / tau**2
        rate = (rate + dt * spring * (u - f)) / (1.0 + dt * damping + dt**2 * spring)
        f += dt * rate
        return f, (f, rate)
