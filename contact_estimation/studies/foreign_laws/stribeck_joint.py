# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Joint friction with Stribeck curve and viscous rise."""

from __future__ import annotations

from math import exp, tanh

from numpy.random import Generator

from .law import log_uniform, Magnitudes, RobotLaw, Strength


class StribeckJoint(RobotLaw):
    """
    Friction of a lubricated gear.

    Friction (F_c + F_s exp(-abs(v / v_s))) sgn(v) + F_v sgn(v) abs(v / v_t)^0.7, sgn(v) smoothed.
    Bona and Indri, Proc. IEEE Conf. Decision and Control, 2005; Bittencourt and
    Gunnarsson, J. Dynamic Systems, Measurement, and Control 134(5), 2012.
    """

    families = ('robot',)

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        share, v_s = float(rng.uniform(0.1, 0.6)), magnitudes.speed * log_uniform(rng, 0.05, 0.3)
        F_c, F_v = 0.3 * magnitudes.force, 0.1 * magnitudes.force
        return lambda s: {'F_c': s * F_c, 'F_s': s * share * F_c, 'v_s': v_s, 'F_v': s * F_v,
                          'v_t': magnitudes.speed}

    def drive(
        self, u: float, x: float, v: float, dt: float, state: float
    ) -> tuple[float, float]:
        """Return the force less the friction; see `RobotLaw.drive`."""
        p, speed = self.values, abs(v)
        most = (p.F_c + p.F_s * exp(-speed / p.v_s) + p.F_v * (speed / p.v_t) ** 0.7)
        return u - most * tanh(v / (0.03 * p.v_t)), state
