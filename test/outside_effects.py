# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Effects outside the library, in worlds that are exact besides, left unexplained."""

from __future__ import annotations

from math import pi, sin
from types import SimpleNamespace
from typing import Any

from contact_estimation.physics.contact_effect import ContactEffect
from contact_estimation.physics.effect import Effect
from contact_estimation.physics.force_sensor_effect import ForceSensorEffect
from contact_estimation.physics.robot_effect import RobotEffect


class SoftSpell(ContactEffect):
    """A wall that is softer during an interval."""

    name = 'soft_spell'

    def resistance(self, t: Any, d: Any, v: Any, state: Any, m: Any) -> Any:
        """Return the missing spring force; see `ContactEffect.resistance`."""
        return -self.values.softer * d if self.values.first < t < self.values.last else 0.0


class WarmingWall(ContactEffect):
    """A wall that softens as motion warms it, and recovers as it cools."""

    name = 'warming_wall'
    states = 1  # warmth, as distance travelled in contact [m]

    def resistance(self, t: Any, d: Any, v: Any, state: Any, m: Any) -> Any:
        """Return the missing spring force; see `ContactEffect.resistance`."""
        return -self.values.softening * state[0] * d

    def state_rates(
        self, t: float, d: float, v: float, contact: bool, state: tuple[float, ...]
    ) -> tuple[float, ...]:
        """Return the rate of warmth: heating by motion in contact, exponential cooling."""
        return ((abs(v) if contact else 0.0) - state[0] / self.values.tau,)


class Ripple(ContactEffect):
    """A force periodic in the depth, as of a thread or of magnets."""

    name = 'ripple'

    def resistance(self, t: Any, d: Any, v: Any, state: Any, m: Any) -> Any:
        """Return the periodic force; see `ContactEffect.resistance`."""
        return self.values.amplitude * sin(2.0 * pi * d / self.values.wavelength)


class Hum(ForceSensorEffect):
    """A force sensor that picks up the mains."""

    name = 'hum'

    def sense(self, t: float, dt: float, force: float, acceleration: float) -> float:
        """Return the disturbed force; see `ForceSensorEffect.sense`."""
        return force + float(self.values.amplitude) * sin(2.0 * pi * self.values.frequency * t)


class DeadBand(RobotEffect):
    """Drives that do not answer to small forces."""

    name = 'dead_band'

    def control(self, u: Any, m: Any) -> Any:
        """Return what exceeds the band; see `RobotEffect.control`."""
        width = self.values.width
        return u - 0.5 * (abs(u + width) - abs(u - width))


OUTSIDE_EFFECTS: dict[str, type[Effect]] = {
    cls.name: cls for cls in (SoftSpell, WarmingWall, Ripple, Hum, DeadBand)
}


def make_outside(name: str, **values: float) -> Effect:
    """Build an effect outside the library, to pass to `World`."""
    parameters: Any = SimpleNamespace(**values)
    return OUTSIDE_EFFECTS[name](parameters)
