# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

from .law import (
    Any, dataclass, ForceSensorEffect, Generator, Need, Number, optional_parameter, Prior,
    random_sign, Scales, Seen, Strength)

CALIBRATED = 0.05
"""Relative error of the sensitivity that is usual."""


@dataclass(frozen=True)
class ForceGain(ForceSensorEffect):
    """
    The sensitivity of the force sensor is not that of its calibration.

    K_e and B_e make up for it in the force; the motion of a robot, which feels the true force,
    tells it. It is the same as an impedance of which M_t, B_t and K_t are all 1 / gain of the
    target.
    """

    gain: float = optional_parameter('Measured over true force', '1', minimum=0.01, neutral=1.0)

    equation = 'F_measured = gain F_e'
    family = 'sensor_gain'
    needs = frozenset({Need.ROBOT})

    def sense(self, t: Number, force: Number, acceleration: Number, m: Any) -> Number:
        return force * self.gain

    def undo(self, t: Number, measured: Number) -> Number:
        return measured / self.gain

    def may_show(self, seen: Seen) -> bool:
        return abs(self.gain - 1.0) >= CALIBRATED

    def is_flexible(self, seen: Seen) -> bool:
        """Is always one: it lets force and motion each have a wall of its own."""
        return True

    @classmethod
    def prior(cls, scales: Scales) -> Prior:
        return Prior([(gain,) for gain in (0.5, 0.65, 0.85, 1.15, 1.4, 1.8)])

    @classmethod
    def draw(cls, scales: Scales, rng: Generator) -> Strength:
        sign = random_sign(rng)
        return lambda s: {'gain': 1.0 + sign * (1.1 * CALIBRATED + 0.4 * s)}
