# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""What is known of a wall."""

from __future__ import annotations

from typing import NamedTuple

SURE = 0.3
"""Relative standard deviation of K_e above which there is no estimate."""

OUTSIDE, OUTSIDE_M = 4.0, 5e-4
"""Distance from a surface where no force is that of the wall [deviations of the surface, m]."""


class Knowledge(NamedTuple):
    """What is known of the wall."""

    # stiffness, damping, stiffness_std, damping_std: K_e [N/m], B_e [N s/m]; NaN before the first
    # contact
    stiffness: float
    damping: float
    stiffness_std: float
    damping_std: float
    # surface, surface_std: x_e [m]; NaN before it is known
    surface: float
    surface_std: float
    inertia: float  # mass that moves with the wall where that is the law, else NaN [kg]
    laws: tuple[float, ...]  # probabilities, in the order of `laws.NAMES`
    # rms of the residual over that of the noise, in the last 2 s of contact; NaN before
    fit: float

    @property
    def valid(self) -> bool:
        """Whether the stiffness is known to a third of it."""
        return self.stiffness_std < SURE * self.stiffness
