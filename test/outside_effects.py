# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Effects outside the library, in worlds that are exact besides, left unexplained."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi, sin
from typing import Any

from contact_estimation.parameters import optional_parameter
from contact_estimation.physics.contact_effect import ContactEffect, State
from contact_estimation.physics.effect import Effect
from contact_estimation.physics.force_sensor_effect import ForceSensorEffect
from contact_estimation.physics.numeric import Number
from contact_estimation.physics.robot_effect import RobotEffect


@dataclass(frozen=True)
class SoftSpell(ContactEffect):
    """A wall that is softer during an interval."""

    softer: float = optional_parameter('', '1')
    first: float = optional_parameter('', '1')
    last: float = optional_parameter('', '1')

    def resistance(self, t: Any, d: Any, v: Any, state: Any, m: Any) -> Any:
        return -self.softer * d if self.first < t < self.last else 0.0


@dataclass(frozen=True)
class WarmingWall(ContactEffect):
    """A wall that softens as motion warms it, and recovers as it cools."""

    softening: float = optional_parameter('', '1')
    tau: float = optional_parameter('', '1')
    states = 1  # warmth, as distance travelled in contact [m]

    def resistance(self, t: Any, d: Any, v: Any, state: Any, m: Any) -> Any:
        return -self.softening * state[0] * d

    def state_rates(self, t: float, d: float, v: float, contact: bool, state: State) -> State:
        """Heat by motion in contact, and cool exponentially."""
        return ((abs(v) if contact else 0.0) - state[0] / self.tau,)


@dataclass(frozen=True)
class Ripple(ContactEffect):
    """A force periodic in the depth, as of a thread or of magnets."""

    amplitude: float = optional_parameter('', '1')
    wavelength: float = optional_parameter('', '1')

    def resistance(self, t: Any, d: Any, v: Any, state: Any, m: Any) -> Any:
        return self.amplitude * sin(2.0 * pi * d / self.wavelength)


@dataclass(frozen=True)
class Hum(ForceSensorEffect):
    """A force sensor that picks up the mains."""

    amplitude: float = optional_parameter('', '1')
    frequency: float = optional_parameter('', '1')

    def sense(self, t: Number, force: Number, acceleration: Number, m: Any) -> Number:
        return force + self.amplitude * m.sin(2.0 * pi * self.frequency * t)


@dataclass(frozen=True)
class DeadBand(RobotEffect):
    """Drives that do not answer to small forces."""

    width: float = optional_parameter('', '1')

    def control(self, u: Any, m: Any) -> Any:
        width = self.width
        return u - 0.5 * (abs(u + width) - abs(u - width))


OUTSIDE_EFFECTS: dict[str, type[Effect]] = {
    cls.name: cls for cls in (SoftSpell, WarmingWall, Ripple, Hum, DeadBand)
}


def make_outside(name: str, **values: float) -> Effect:
    """Build an effect outside the library, to pass to `World`."""
    return OUTSIDE_EFFECTS[name](**values)
