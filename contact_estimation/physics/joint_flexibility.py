# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Elasticity between the motor, whose position is measured, and the link that touches the wall."""

from __future__ import annotations

from dataclasses import astuple, dataclass
from typing import Any

from numpy.random import Generator

from .drawn_effect import log_uniform, Scales, Strength
from .robot_effect import Joint, RobotEffect
from ..parameters.specification import optional_parameter, ParameterGroup

_DAMPED, _MOST_DAMPED = 0.15, 0.7  # damping ratio of a gear; one that does not ring relaxes
_MOST_LINK = 0.9  # of M_t: a motor has some mass


@dataclass(frozen=True)
class JointFlexibilityParameters(ParameterGroup):
    """Parameters of `JointFlexibility`."""

    compliance: float = optional_parameter(
        'Deflection of the joint, or of the tool, per force', 'm/N', minimum=0.0)
    link_share: float = optional_parameter(
        'Mass of the link beyond it, as a share of M_t', '1', minimum=0.001, maximum=0.95)
    damping_ratio: float = optional_parameter(
        'Damping of the link on the joint over the critical one', '1', minimum=0.001, maximum=0.99)


class JointFlexibility(RobotEffect):
    """
    Motor: (M_t - m) x'' = u - f. Link: m y'' = f + F_e(y, y'), f = (x - y) / C + c (x' - y').

    The measured position is x, of the motor; m = link_share M_t, c = 2 zeta sqrt(m / C).
    Spong, J. Dynamic Systems, Measurement, and Control 109(4), 1987.
    """

    name = 'joint_flexibility'
    equation = ("(M_t - m) x'' = u - f, m y'' = f + F_e(y, y'), m = link_share M_t, "
                "f = (x - y) / compliance + c (x' - y'), c = 2 damping_ratio sqrt(m / compliance)")
    family = 'inertia'
    description = 'A joint or a tool mount yields between the measured position and the wall.'
    Parameters = JointFlexibilityParameters
    resonates = True

    def joint(self, mass: float) -> Joint | None:
        """Return the joint unless it is rigid; see `RobotEffect.joint`."""
        C, share, ratio = astuple(self.values)
        return Joint(C, share * mass, ratio) if C > 0.0 else None

    @classmethod
    def plausible(cls, values: Any) -> bool:
        """Return whether the link rings, and leaves a motor behind it."""
        return bool(values.damping_ratio < _MOST_DAMPED and values.link_share < _MOST_LINK)

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """Spread the compliance beside that of the wall, and the mass of the link."""
        return [(share / scales.spring, link, _DAMPED)
                for share in (0.01, 0.05, 0.25) for link in (0.1, 0.4)]

    @classmethod
    def draw(cls, scales: Scales, rng: Generator) -> Strength:
        """Draw mass and damping."""
        share, ratio = log_uniform(rng, 0.1, 0.5), log_uniform(rng, 0.05, 0.3)
        return lambda s: {'compliance': 0.5 * s / scales.spring, 'link_share': share,
                          'damping_ratio': ratio}
