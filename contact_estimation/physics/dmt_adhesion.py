# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Adhesion that also pulls while the wall is pressed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from numpy.random import Generator

from .adhesion import Adhesion, AdhesionParameters
from .drawn_effect import Scales, Strength
from .numeric import Number
from ..parameters.specification import optional_parameter


@dataclass(frozen=True)
class DmtAdhesionParameters(AdhesionParameters):
    """Parameters of `DmtAdhesion`."""

    reach: float = optional_parameter(
        'Distance from the surface at which the pull ends', 'm', minimum=1e-12)


class DmtAdhesion(Adhesion):
    """
    F_e += F_a in contact; then, withdrawing, F_e = F_a (1 + d / reach) until d = -reach.

    Derjaguin, Muller and Toporov, J. Colloid and Interface Science 53, 1975: attraction adds to
    the elastic force without changing it. The liquid neck between wet surfaces pulls alike.
    """

    name = 'dmt_adhesion'
    equation = 'F_e += F_a in contact; F_e = F_a (1 + d / reach) on leaving'
    description = 'The wall attracts the tool while they touch, until it is pulled off.'
    Parameters = DmtAdhesionParameters

    def __init__(self, values: DmtAdhesionParameters) -> None:
        super().__init__(values)
        self.reach = values.reach

    def resistance(self, t: Number, d: Number, v: Number, state: Any, m: Any) -> Number:
        """Return -F_a; see `ContactEffect.resistance`."""
        return -self.values.F_a + 0.0 * v

    @classmethod
    def starts(cls, scales: Scales) -> list[tuple[float, ...]]:
        """Start from the greatest pull in the recording; spread the reach."""
        pull = max(scales.greatest_pull, 0.02 * scales.force)
        return [(pull, share * scales.depth) for share in (0.02, 0.1, 0.5)]

    @classmethod
    def draw(cls, scales: Scales, rng: Generator) -> Strength:
        """Draw the reach."""
        reach = float(rng.uniform(0.05, 0.3)) * scales.depth
        return lambda s: {'F_a': 0.7 * s * scales.force, 'reach': reach}
