# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Wall that is softer during an interval."""

from __future__ import annotations

from typing import Any

from numpy.random import Generator

from .law import ContactLaw, Magnitudes, Strength


class SoftSpell(ContactLaw):
    """
    A spring that fails and recovers.

    R = -softer d while first < t < last.
    Doebling, Farrar and Prime, Shock and Vibration Digest 30(2), 1998 (loss of stiffness).
    """

    @classmethod
    def draw(cls, magnitudes: Magnitudes, rng: Generator) -> Strength:
        """Draw; see `ForeignLaw.draw`."""
        first = magnitudes.duration * float(rng.uniform(0.15, 0.6))
        last = first + magnitudes.duration * float(rng.uniform(0.1, 0.25))
        return lambda s: {'softer': 0.8 * s * magnitudes.stiffness, 'first': first, 'last': last}

    def respond(
        self, t: float, d: float, v: float, dt: float, state: Any
    ) -> tuple[float, Any]:
        """Return the missing spring force; see `ContactLaw.respond`."""
        return (-self.values.softer * d if self.values.first < t < self.values.last else 0.0), None
