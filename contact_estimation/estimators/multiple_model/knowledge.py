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
    """
    What is known of the wall.

    Attributes
    ----------
    stiffness, damping, stiffness_std, damping_std : float
        K_e [N/m], B_e [N s/m]; NaN before the first contact.
    surface, surface_std : float
        x_e [m]; NaN before it is known.
    inertia : float
        Mass that moves with the wall where that is the law, else NaN [kg].
    laws : tuple of float
        Probabilities, in the order of `laws.NAMES`.
    fit : float
        Rms of the residual over that of the noise, in the last 2 s of contact; NaN before.

    """

    stiffness: float
    damping: float
    stiffness_std: float
    damping_std: float
    surface: float
    surface_std: float
    inertia: float
    laws: tuple[float, ...]
    fit: float

    @property
    def valid(self) -> bool:
        """Whether the stiffness is known to a third of it."""
        return self.stiffness_std < SURE * self.stiffness
