# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Checks of units: positions and forces that are not in metres and newtons."""

from __future__ import annotations

from math import log
from typing import Mapping

import numpy as np

from .check import Finding
from .evidence import Evidence
from .measures import FOLLOWS, LITTLE

_LENGTHS: Mapping[str, float] = {'mm': 1e3, 'um': 1e6, 'cm': 1e2, 'inches': 39.37}
"""Units of length in a metre."""

_FORCES: Mapping[str, float] = {
    'kN': 1e-3, 'kgf': 0.10197, 'lbf': 0.22481, 'grams of force': 101.97, 'mN': 1e3,
}
"""Units of force in a newton."""

_LONG_TRAVEL = 0.5  # [m] from which on a thousandth of the force means millimetres, not kN
_FEW, _PREFIX = log(3.0), log(1e3)  # what nominal models are wrong by; kilo or milli


def length_unit(evidence: Evidence) -> Finding:
    """Find positions, a reference or both that are not in metres."""
    travel = float(np.ptp(evidence.smooth.x))
    if evidence.with_reference and evidence.followed.correlation > FOLLOWS:
        ratio = evidence.followed.slope
        for name, factor in (('position', ratio), ('reference_trajectory', 1.0 / ratio)):
            unit = _nearest(factor, _LENGTHS)
            if unit is not None:
                return Finding(False, f'in free flight x moves {ratio:.3g} times as x_r, expected '
                                      f'1: {name} seems to be in {unit}; record metres')
    # The model predicts so much more force.
    unit = _mistaken(evidence, {name: 1.0 / ratio for name, ratio in _LENGTHS.items()})
    if unit is None or (unit == 'mm' and travel < _LONG_TRAVEL):
        return Finding(True, f'x travels {travel:.3g} m')
    share = evidence.of_wall.slope
    return Finding(False, f'x travels {travel:.3g} m, and the force is {share:.2g} times what the '
                          'nominal model predicts, expected about 1: the lengths seem to be in '
                          f'{unit}; record metres')


def force_unit(evidence: Evidence) -> Finding:
    """
    Find a force that is not in newtons.

    With a robot the force must be wrong by the same factor against the nominal wall and against
    the nominal robot's equation of motion, which does not know the wall.
    """
    text = f'the force is {evidence.of_wall.slope:.3g} times that of the nominal wall'
    if evidence.with_reference:
        text += f', {evidence.of_robot.slope:.3g} times what the robot felt'
    unit = _mistaken(evidence, _FORCES)
    if unit is None:
        return _of_magnitude(evidence, text)
    other = {'kN': ' (or positions in mm)', 'kgf': ' (or on another axis)',
             'lbf': ' (or on another axis)'}.get(unit, '')
    return Finding(False, f'{text}, expected about 1: it seems to be in {unit}{other}; record '
                          'newtons')


def _of_magnitude(evidence: Evidence, text: str) -> Finding:
    """Find a force that no unit explains."""
    force, expected = evidence.deviations
    possible = _PREFIX + 2.0 * _FEW  # a unit, and what force and model are wrong by
    if not expected or not force or abs(log(force / expected)) < possible:
        return Finding(True, text)
    return Finding(False, f'the force varies by {force:.3g} N, that of the nominal wall by '
                          f'{expected:.3g} N, expected about the same: no model is wrong by so '
                          'much; check that topics, joint, axis and model file belong together')


def _mistaken(evidence: Evidence, units: Mapping[str, float]) -> str | None:
    """
    Return the unit whose ratio the force has to those of nominal wall and robot.

    A wrong nominal stiffness changes the first ratio alone, wrong values of the robot the second,
    which what is missing lowers. Without a robot only a factor of a thousand is a unit.
    """
    wall, robot = evidence.of_wall, evidence.of_robot if evidence.with_reference else None
    if robot is None:
        force, expected = evidence.deviations
        follows = abs(wall.correlation) >= FOLLOWS
        ratio = wall.slope if follows else force / expected if expected else 0.0
        unit = _nearest(ratio, units)
        return unit if unit and abs(log(units[unit])) > _PREFIX - _FEW else None
    unit = _nearest(wall.slope, units) if wall.correlation >= FOLLOWS else None
    if unit is None or robot.slope <= 0.0:
        return None
    off = log(robot.slope / units[unit])
    return unit if log(LITTLE) < off < _reach(unit, {'': 1.0, unit: units[unit]}) else None


def _nearest(ratio: float, units: Mapping[str, float]) -> str | None:
    """Return the unit of a ratio, nearer to it than to any other unit; None if none is near."""
    if ratio <= 0.0:
        return None
    best = min(units, key=lambda name: abs(log(ratio / units[name])))
    reach = min(_FEW, _reach(best, {'': 1.0, **units}))
    return best if abs(log(ratio / units[best])) < reach else None


def _reach(unit: str, units: Mapping[str, float]) -> float:
    """Return half the way to the nearest other unit, in logarithms of ratios."""
    return 0.5 * min(abs(log(units[unit] / ratio)) for name, ratio in units.items()
                     if name != unit)
