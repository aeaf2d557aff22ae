# Copyright 2026 contact_estimation authors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""Limits that hold for every reference, whatever estimate, setpoint or parameter is behind it."""

from __future__ import annotations

from dataclasses import dataclass
from math import copysign, inf, isfinite
from typing import Sequence

from .setpoints import Reference
from ..exceptions import ParameterRangeError
from ..parameters.specification import parameter, ParameterGroup


@dataclass(frozen=True)
class PoseLimits(ParameterGroup):
    """Limits of ~/target_pose, beside those of x_r."""

    lead: float = parameter(
        0.1, 'Largest distance of the target from the measured position', 'm', minimum=1e-6,
        maximum=10.0,
    )
    lower: tuple[float, ...] = parameter(
        (-10.0, -10.0, -10.0), 'Lower corner of the box, in the frame of kinematics.base, in '
        'which targets may lie', 'm',
    )
    upper: tuple[float, ...] = parameter(
        (10.0, 10.0, 10.0), 'Upper corner of that box', 'm',
    )

    def __post_init__(self) -> None:
        """Check that the box is not empty."""
        super().__post_init__()
        if any(lower > upper for lower, upper in zip(self.lower, self.upper)):
            raise ParameterRangeError(
                'reference.limits.lower must be <= reference.limits.upper in each component, got '
                f'{list(self.lower)} and {list(self.upper)}; exchange them where lower is larger'
            )


def limited(
    last: Reference, target: Reference, dt: float, period: float, speed: float, deepest: float
) -> Reference:
    """
    Return the reference that is nearest to a target within the limits.

    x_r is finite, moves at most `speed` dt from the last reference, and not deeper than
    `deepest`; from beyond it, x_r retreats at that speed. The same holds along the parabola that
    the robot follows until the next reference.

    Parameters
    ----------
    last : Reference
        Published before; finite.
    target : Reference
        Wanted; where its position is not finite, x_r stays.
    dt : float
        Time since the last reference [s]; x_r stays where this is not > 0.
    period : float
        Time for which the robot follows the new one [s].
    speed : float
        Largest |dx_r/dt| [m/s].
    deepest : float
        Largest x_r [m]; NaN: no limit.

    Returns
    -------
    reference : Reference
        With the force of the target.

    """
    position, velocity, acceleration, force = target
    if not isfinite(position):
        return Reference(last.position, 0.0, 0.0, force)
    if position > deepest:
        position, velocity, acceleration = deepest, 0.0, 0.0
    before = last.position
    step, most = position - before, speed * dt if dt > 0.0 else 0.0
    if velocity == 0.0 == acceleration and abs(step) <= most and position == target[0]:
        return target  # at rest within all limits, the usual case
    if abs(step) > most:
        position = before + copysign(most, step)
        velocity, acceleration = copysign(speed, step), 0.0
    if velocity != 0.0 or acceleration != 0.0:
        velocity, acceleration = _rates(
            position, velocity, acceleration, period, speed, deepest)
    return Reference(position, velocity, acceleration, force)


def _rates(
    position: float, velocity: float, acceleration: float, period: float, speed: float,
    deepest: float,
) -> tuple[float, float]:
    """Return velocity and acceleration with which the limits hold until the next reference."""
    if not (isfinite(velocity) and isfinite(acceleration)):
        return 0.0, 0.0
    v = min(max(velocity, -speed), speed)
    reached = v + period * acceleration
    a = acceleration if v == velocity and abs(reached) <= speed else 0.0
    furthest = position + period * (v + max(0.5 * period * a, 0.0))
    if furthest > deepest:
        v, a = min(v, max(0.0, (deepest - position) / period)), 0.0
    return v, a


def step_along(
    position: Sequence[float], normal: Sequence[float], step: float, limits: PoseLimits
) -> float | None:
    """
    Return the step along the normal that is nearest to a wanted one within the limits.

    Parameters
    ----------
    position : sequence of float
        Measured [m].
    normal : sequence of float
        Unit vector.
    step : float
        Wanted [m].
    limits : PoseLimits
        Lead and box.

    Returns
    -------
    step : float or None
        In [m]; None where no step leads into the box, or the wanted one is not finite.

    """
    if not isfinite(step):
        return None
    low, high = -limits.lead, limits.lead
    for p, n, lower, upper in zip(position, normal, limits.lower, limits.upper):
        if abs(n) < 1e-9:
            ends = (-inf, inf) if lower <= p <= upper else (inf, -inf)
        else:
            ends = ((lower - p) / n, (upper - p) / n)
            ends = (min(ends), max(ends))
        low, high = max(low, ends[0]), min(high, ends[1])
    return min(max(step, low), high) if low <= high else None
