# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

from dataclasses import astuple, dataclass

from .law import Generator, optional_parameter, Prior, random_sign, RobotEffect, Scales, Strength

_ALIKE = 0.3  # of their mean deviation from 1: less between the scales is one for all


@dataclass(frozen=True)
class ImpedanceMismatch(RobotEffect):
    """The robot realises a mass, damping or stiffness other than the target."""

    K_t_scale: float = optional_parameter(
        'Stiffness of the robot divided by K_t', '1', minimum=0.0, neutral=1.0)
    B_t_scale: float = optional_parameter(
        'Damping of the robot divided by B_t', '1', minimum=0.0, neutral=1.0)
    M_t_scale: float = optional_parameter(
        'Mass of the robot divided by M_t', '1', minimum=0.01, neutral=1.0)

    equation = 'M_t_scale M_t, B_t_scale B_t, K_t_scale K_t in eq. (1)'
    family = 'robot'

    def impedance(
        self, mass: float, damping: float, stiffness: float
    ) -> tuple[float, float, float]:
        return self.M_t_scale * mass, self.B_t_scale * damping, self.K_t_scale * stiffness

    def is_possible(self, stiffness: float, damping: float) -> bool:
        """Return whether the scales differ: all alike are the gain of the force sensor."""
        scales = astuple(self)
        return max(scales) - min(scales) > _ALIKE * abs(sum(scales) / 3.0 - 1.0)

    @classmethod
    def prior(cls, scales: Scales) -> Prior:
        return Prior([(1.002, 1.002, 1.002)])

    @classmethod
    def draw(cls, scales: Scales, rng: Generator) -> Strength:
        names = ('K_t_scale', 'B_t_scale', 'M_t_scale')
        shares = [0.5 * random_sign(rng) * float(rng.uniform(0.3, 1.0)) for _ in names]
        return lambda s: {name: 1.0 + s * share for name, share in zip(names, shares)}
