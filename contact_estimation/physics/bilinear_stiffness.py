# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Bilinear stiffness of the wall."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from numpy.random import Generator

from .contact_effect import ContactEffect
from .drawn_effect import Scales, Strength
from .numeric import Number, positive
from ..parameters.specification import optional_parameter, ParameterGroup


@dataclass(frozen=True)
class BilinearStiffnessParameters(ParameterGroup):
    """Parameters of `BilinearStiffness`."""

    K_2: float = optional_parameter('Additional stiffness beyond `depth`', 'N/m')
    depth: float = optional_parameter('Depth at which the second spring starts', 'm', minimum=0.0)


class BilinearStiffness(ContactEffect):
    """R = K_2 max(d - depth, 0), additional."""

    name = 'bilinear_stiffness'
    equation = 'F_e -= K_2 max(d - depth, 0)'
    family = 'elastic_law'
    description = 'A second spring adds to the stiffness beyond a certain depth.'
    Parameters = BilinearStiffnessParameters

    def resistance(self, t: Number, d: Number, v: Number, state: Any, m: Any) -> Number:
        """Return K_2 max(d - depth, 0); see `ContactEffect.resistance`."""
        return self.values.K_2 * positive(d - self.values.depth, m)

    @classmethod
    def bends(cls, values: Any) -> tuple[float, ...]:
        """Bend where the second spring starts."""
        return (values.depth,)

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """Spread the depth; the law is linear in K_2."""
        shares = (0.2, 0.35, 0.5, 0.65, 0.8, 0.92)
        # Starts with a small K_2 leave the depth undetermined in the first step.
        return [(0.3 * scales.spring, share * scales.depth) for share in shares]

    @classmethod
    def draw(cls, scales: Scales, rng: Generator) -> Strength:
        """Draw the depth at which the second spring starts."""
        depth = float(rng.uniform(0.3, 0.7)) * scales.depth
        return lambda s: {'K_2': 2.0 * s * scales.stiffness, 'depth': depth}
