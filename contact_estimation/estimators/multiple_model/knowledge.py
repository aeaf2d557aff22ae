# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""What is known of a wall."""

from math import exp, hypot
from typing import NamedTuple

from .constants import DAMPING_S, DAMPING_STD_S

SURE = 0.3
"""Relative standard deviation of K_e above which there is no estimate."""

OUTSIDE = 4.0
"""Deviations of a surface, outside of which no force is that of the wall."""

_OUTSIDE_M = 5e-4  # the same [m]
_SLOWEST_S = DAMPING_S + 2.0 * DAMPING_STD_S  # B_e / K_e


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
    # relative deviations of K_e and B_e beside these: over the depths of the last second, and of a
    # wall that is as likely to be curved as not
    varies: tuple[float, float] = (0.0, 0.0)
    doubt: float = 1.0  # factor of both deviations, above 1 where no law fits

    @property
    def valid(self) -> bool:
        """Whether the stiffness is known to a third of it."""
        return self.stiffness_std < SURE * self.stiffness

    @property
    def _margin(self) -> float:
        return OUTSIDE * self.surface_std + _OUTSIDE_M

    @property
    def outermost(self) -> float:
        """Return the position outside of which no force is that of the wall [m]."""
        return self.surface - self._margin

    def was_free_at(self, x: float, stiffness: float, unfelt: float) -> bool:
        """Return whether a place [m] is deeper in a wall than a force [N] that is not felt."""
        return stiffness * (x - self.surface - self._margin) > unfelt

    def force_left(self, x: float, free_s: float) -> float:
        """Return the force at a place that a wall has which comes back for some time [m, s, N]."""
        return self.stiffness * (x - self.surface) * exp(-free_s / _SLOWEST_S)

    @property
    def published_stds(self) -> tuple[float, float]:
        """Return the deviations of K_e and B_e to be published, with what widens them."""
        return (hypot(self.doubt * self.stiffness_std, self.varies[0] * self.stiffness),
                hypot(self.doubt * self.damping_std, self.varies[1] * self.damping))
