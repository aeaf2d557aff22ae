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

"""Units that are taken for metres and newtons."""

from __future__ import annotations

from math import exp, log
from typing import Mapping

from .evidence import Evidence

LENGTHS: Mapping[str, float] = {'mm': 1e3, 'um': 1e6, 'cm': 1e2, 'inches': 39.37}
"""Units of length in a metre."""

FORCES: Mapping[str, float] = {
    'kN': 1e-3, 'kgf': 0.10197, 'lbf': 0.22481, 'grams of force': 101.97, 'mN': 1e3,
}
"""Units of force in a newton."""

LONG_TRAVEL = 0.5
"""Travel [m] from which on a thousandth of the expected force means millimetres, not kN."""

_CORRELATED = 0.7
_WALL, _WALL_NEAR = log(2.2), log(1.35)  # factor by which a nominal stiffness may be wrong
_NEAR = log(20.0)  # ratios that other things have as well must fit better
_ROBOT_LOW, _ROBOT_HIGH = log(0.15), log(1.6)  # the same of the implied force: physics lower it
_HUGE, _WALL_ALONE = log(250.0), log(3.0)  # without a robot: less is a wrong nominal model
_SAME = log(2.2)  # of velocities in free flight: a robot lags behind its reference


def nearest_unit(ratio: float, units: Mapping[str, float]) -> str | None:
    """
    Return the unit with a ratio.

    Parameters
    ----------
    ratio : float
        Measured.
    units : mapping of str to float
        Expected ratios.

    Returns
    -------
    unit : str or None
        None if no ratio is near.

    """
    if ratio <= 0.0:
        return None
    best = min(units, key=lambda name: abs(log(ratio / units[name])))
    return best if abs(log(ratio / units[best])) < _SAME else None


def mistaken_unit(evidence: Evidence, units: Mapping[str, float]) -> str | None:
    """
    Return the unit whose ratio the force has to those of nominal wall and robot.

    A wrong nominal stiffness changes the first ratio alone, wrong values of the robot the second.
    Without a robot only a factor of hundreds is a unit: nominal models are off by a few.

    Parameters
    ----------
    evidence : Evidence
        Of a recording.
    units : mapping of str to float
        Ratios to be expected.

    Returns
    -------
    unit : str or None
        None if there is none.

    """
    wall = evidence.of_wall
    if not evidence.with_reference and abs(wall.correlation) < _CORRELATED:
        return _of_ranges(evidence, units)
    if wall.slope <= 0.0 or wall.correlation < _CORRELATED:
        return None
    best = min(units, key=lambda name: abs(log(wall.slope / units[name])))
    off = log(wall.slope / units[best])
    if not evidence.with_reference:
        known = abs(log(units[best])) > _HUGE and abs(off) < _WALL_ALONE
        return best if known else None
    robot = evidence.of_robot
    most = _WALL if abs(log(units[best])) > _NEAR else _WALL_NEAR
    if robot.slope <= 0.0 or abs(off) > most:
        return None
    return best if _ROBOT_LOW < log(robot.slope / units[best]) < _ROBOT_HIGH else None


def _of_ranges(evidence: Evidence, units: Mapping[str, float]) -> str | None:
    """Return the unit of a force that does not follow the nominal one, by its deviation alone."""
    force, expected = evidence.deviations
    if not expected or not force:
        return None
    return next((name for name, ratio in units.items()
                 if abs(log(ratio)) > _HUGE and abs(log(force / expected / ratio)) < _WALL_ALONE),
                None)


def inverse(units: Mapping[str, float]) -> dict[str, float]:
    """
    Return the ratios of forces at lengths in other units.

    Parameters
    ----------
    units : mapping of str to float
        Units of length.

    Returns
    -------
    ratios : dict of str to float
        A model in newtons a metre predicts so much more force.

    """
    return {name: exp(-log(ratio)) for name, ratio in units.items()}
