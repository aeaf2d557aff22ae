# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

from .law import (
    dataclass, Generator, Joint, log_uniform, optional_parameter, Prior, RobotEffect, Scales,
    Strength)

_DAMPED, _MOST_DAMPED = 0.15, 0.7  # damping ratio of a gear; one that does not ring relaxes
_MOST_LINK = 0.9  # of M_t: a motor has some mass


@dataclass(frozen=True)
class JointFlexibility(RobotEffect):
    """
    A joint or a tool mount yields between the measured position and the wall.

    The measured position is x, of the motor; m = link_share M_t, c = 2 zeta sqrt(m / C).
    Spong, J. Dynamic Systems, Measurement, and Control 109(4), 1987.
    """

    compliance: float = optional_parameter(
        'Deflection of the joint, or of the tool, per force', 'm/N', minimum=0.0)
    link_share: float = optional_parameter(
        'Mass of the link beyond it, as a share of M_t', '1', minimum=0.001, maximum=0.95)
    damping_ratio: float = optional_parameter(
        'Damping of the link on the joint over the critical one', '1', minimum=0.001, maximum=0.99)

    equation = ("(M_t - m) x'' = u - f, m y'' = f + F_e(y, y'), m = link_share M_t, "
                "f = (x - y) / compliance + c (x' - y'), c = 2 damping_ratio sqrt(m / compliance)")
    family = 'inertia'
    resonates = True

    def joint(self, mass: float) -> Joint | None:
        C = self.compliance
        return Joint(C, self.link_share * mass, self.damping_ratio) if C > 0.0 else None

    def is_possible(self, stiffness: float, damping: float) -> bool:
        """Return whether the link rings, and leaves a motor behind it."""
        return self.damping_ratio < _MOST_DAMPED and self.link_share < _MOST_LINK

    @classmethod
    def prior(cls, scales: Scales) -> Prior:
        return Prior([(share / scales.spring, link, _DAMPED)
                      for share in (0.01, 0.05, 0.25) for link in (0.1, 0.4)])

    @classmethod
    def draw(cls, scales: Scales, rng: Generator) -> Strength:
        share, ratio = log_uniform(rng, 0.1, 0.5), log_uniform(rng, 0.05, 0.3)
        return lambda s: {'compliance': 0.5 * s / scales.spring, 'link_share': share,
                          'damping_ratio': ratio}
