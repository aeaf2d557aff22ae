# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Checks of signs and axes: force and position that point elsewhere."""

from math import log
from typing import Mapping

import numpy as np

from .check import Finding, FOLLOWS, UNRELATED, WORTH_A_NAME
from .quantities import Quantities
from ..observe.shares import LITTLE, MUCH
from ..observe.signals import Signals
from ...signals.stream_faults import CLEAR


def wrench_axes(quantities: Quantities) -> Finding:
    """Find a wrench of an arm in other axes than configured, by the weight of the tool."""
    found = quantities.recording.foreign_axes
    return Finding(not found, found or 'no weight turns with other axes than configured')


def force_sign(quantities: Quantities) -> Finding:
    """Find a force that does not oppose the motion."""
    # A wall pushes back where x is largest; a permanently attached specimen takes up energy.
    if not quantities.model.environment.unilateral:
        return _of_specimen(quantities)
    low, high = quantities.sides_beyond_zero
    if quantities.with_reference and max(  # it may be that of another axis
            abs(quantities.of_wall.slope), abs(quantities.of_robot.slope)) < MUCH:
        return Finding(True, 'the force is too small to have a sign')
    far, near = sorted((low, high), key=abs, reverse=True)
    if far < quantities.clear_force or not _is_at_one_end(far, near):
        return Finding(True, f'F_e is {high:.3g} N at the largest x; it must be < 0 while '
                             'pressing')
    return Finding(False, f'F_e is {far:.3g} N while pressing, expected < 0: the force of the '
                          'environment on the end-effector; change the sign of the recorded force')


def _is_at_one_end(far: float, near: float) -> bool:
    """Return whether a force is a contact, and that at the other end of the motion none."""
    return abs(near) <= MUCH * abs(far)


def _of_specimen(quantities: Quantities) -> Finding:
    s, against = quantities.smooth, quantities.of_wall.correlation
    power = -s.force * s.v
    work = float(np.sum(power)) / max(float(np.sum(np.abs(power))), 1e-300)
    text = f'the specimen takes up {100.0 * work:.0f} % of the work exchanged'
    if work > -WORTH_A_NAME or against > -UNRELATED:
        return Finding(True, text)
    return Finding(False, f'{text}, expected > 0: it would be an engine; -F_e was diagnosed. '
                          'Change the sign of the recorded force or of the position', fatal=False)


def inverted(signals: Signals) -> Signals:
    """Invert the force."""
    return signals._replace(force=-signals.force)


def position_sign(quantities: Quantities) -> Finding:
    """Find a position that decreases into the wall, or against its reference."""
    change = ('; change the sign of the recorded position, or let the contact axis point into '
              'the wall')
    if quantities.with_reference and quantities.followed.correlation < -FOLLOWS:
        return Finding(False, f'x moves {quantities.followed.slope:.3g} times as x_r in free '
                              f'flight, expected 1{change}')
    if not quantities.model.environment.unilateral:
        return Finding(True, 'a permanently attached specimen has no side')
    low, high = quantities.sides_beyond_zero
    if abs(low) < quantities.clear_force or not _is_at_one_end(low, high):
        return Finding(True, f'the force is {high:.3g} N at the largest x, {low:.3g} N at the '
                             'smallest')
    if _is_at_one_end(float(np.ptp(quantities.smooth.force)), low):
        change = ', which has more force in between; cut the recording where the specimen breaks'
    return Finding(False, f'the force is {low:.3g} N at the smallest x and {high:.3g} N at the '
                          f'largest, expected the contact at large x{change}')


def axis(quantities: Quantities) -> Finding:
    """Find a force that is not that of the contact axis."""
    # The motion shows a contact that the force hardly shows. A force that follows no line, but is
    # the same at a place on the ways in and out, is that of a strongly nonlinear contact, such as
    # a dome that buckles.
    if not quantities.model.environment.unilateral:
        return Finding(True, f'correlation of force and nominal force '
                             f'{quantities.of_wall.correlation:.2f}')
    wall, robot = quantities.of_wall, None
    text = f'the force is {wall.slope:.2g} times that of the nominal wall'
    varies, expected = quantities.deviations
    if quantities.with_reference:
        robot = quantities.of_robot
        text += f' and {robot.slope:.2g} times what the robot felt'
        expected = min(expected, float(np.std(quantities.implied_force)))
    text += f' (correlation {wall.correlation:.2f})'
    lines = [wall] if robot is None else [wall, robot]
    least = LITTLE if robot is None else MUCH  # without a robot the wall may be too stiff
    small = all(abs(line.slope) < least for line in lines)
    # Metal that yields follows no line either, but presses where it is deepest.
    if robot is None and varies > least * expected:
        small &= _is_at_one_end(float(np.ptp(quantities.smooth.force)), quantities.sides[1])
    no_line = all(abs(line.correlation) < UNRELATED for line in lines)
    unrelated = robot is not None and no_line
    if robot is None and no_line and quantities.repeats > FOLLOWS:
        return Finding(True, f'{text}, the same on the ways in and out')
    if expected < CLEAR * quantities.force_noise or not (small or unrelated):
        return Finding(True, text)
    return Finding(False, f'{text}, expected about 1: this seems to be another axis of the '
                          'sensor, or one that is not connected; choose --axis, check '
                          "the wrench's frame and unit and the nominal stiffness, or cut the "
                          'recording where a specimen breaks')


_LENGTHS: Mapping[str, float] = {'mm': 1e3, 'um': 1e6, 'nm': 1e9, 'cm': 1e2, 'inches': 39.37}
"""Units of length in a metre."""

_FORCES: Mapping[str, float] = {
    'kN': 1e-3, 'kgf': 0.10197, 'lbf': 0.22481, 'grams of force': 101.97, 'mN': 1e3,
    'uN': 1e6, 'nN': 1e9,
}
"""Units of force in a newton."""

_LONG_TRAVEL = 0.5  # [m] from which on a thousandth of the force means millimetres, not kN
_FEW, _PREFIX = log(3.0), log(1e3)  # what nominal models are wrong by; kilo or milli
# What friction, or a wrong gain, adds where another unit is near. A twentieth of the force, of
# another axis, is twice what inches or half of what kgf would leave.
_ADDED = log(1.75)


def length_unit(quantities: Quantities) -> Finding:
    """Find positions, a reference or both that are not in metres."""
    travel = float(np.ptp(quantities.smooth.x))
    if quantities.with_reference and quantities.followed.correlation > FOLLOWS:
        ratio = quantities.followed.slope
        for name, factor in (('position', ratio), ('reference_trajectory', 1.0 / ratio)):
            unit = _nearest(factor, _LENGTHS)
            if unit is not None:
                return Finding(False, f'in free flight x moves {ratio:.3g} times as x_r, expected '
                                      f'1: {name} seems to be in {unit}; record metres')
    # The model predicts so much more force.
    unit = _mistaken(quantities, {name: 1.0 / ratio for name, ratio in _LENGTHS.items()})
    if unit is None or (unit == 'mm' and travel < _LONG_TRAVEL):
        return Finding(True, f'x travels {travel:.3g} m')
    share = quantities.of_wall.slope
    return Finding(False, f'x travels {travel:.3g} m, and the force is {share:.2g} times what the '
                          'nominal model predicts, expected about 1: the lengths seem to be in '
                          f'{unit}; record metres, or name the units of a table by --units')


def force_unit(quantities: Quantities) -> Finding:
    """Find a force that is not in newtons."""
    # With a robot the force must be wrong by the same factor against the nominal wall and against
    # the nominal robot's equation of motion, which does not know the wall.
    text = f'the force is {quantities.of_wall.slope:.3g} times that of the nominal wall'
    if quantities.with_reference:
        text += f', {quantities.of_robot.slope:.3g} times what the robot felt'
    unit = _mistaken(quantities, _FORCES)
    if unit is None:
        return _of_magnitude(quantities, text)
    other = {'kN': ' (or positions in mm)', 'kgf': ' (or on another axis)',
             'lbf': ' (or on another axis, or its gain is wrong)',
             'mN': ' (or in nN and positions in um, or in pN and nm)'}.get(unit, '')
    return Finding(False, f'{text}, expected about 1: it seems to be in {unit}{other}; record '
                          'newtons, or name the units of a table by --units')


def _of_magnitude(quantities: Quantities, text: str) -> Finding:
    """Find a force that no unit explains."""
    force, expected = quantities.deviations
    possible = _PREFIX + 2.0 * _FEW  # a unit, and what force and model are wrong by
    if not expected or not force or abs(log(force / expected)) < possible:
        return Finding(True, text)
    return Finding(False, f'the force varies by {force:.3g} N, that of the nominal wall by '
                          f'{expected:.3g} N, expected about the same: no model is wrong by so '
                          'much; check that topics, joint, axis and model file belong together')


def _mistaken(quantities: Quantities, units: Mapping[str, float]) -> str | None:
    """Return the unit whose ratio the force has to those of nominal wall and robot."""
    # A wrong nominal stiffness changes the first ratio alone, wrong values of the robot the
    # second, which what is missing lowers. Without a robot only a factor of a thousand is a unit.
    wall, robot = quantities.of_wall, quantities.of_robot if quantities.with_reference else None
    if robot is None:
        force, expected = quantities.deviations
        follows = abs(wall.correlation) >= FOLLOWS
        ratio = wall.slope if follows else force / expected if expected else 0.0
        unit = _nearest(ratio, units)
        return unit if unit and abs(log(units[unit])) > _PREFIX - _FEW else None
    unit = _nearest(wall.slope, units) if wall.correlation >= FOLLOWS else None
    if unit is None or robot.slope <= 0.0:
        return None
    off = log(robot.slope / units[unit])
    return unit if log(LITTLE) < off < 0.5 * abs(log(units[unit])) else None


def _nearest(ratio: float, units: Mapping[str, float]) -> str | None:
    """Return the unit of a ratio, nearer to it than any other, or 1; None if none is near."""
    if ratio <= 0.0:
        return None
    known = {'': 1.0, **units}  # the right unit, which is no mistake
    best = min(known, key=lambda name: abs(log(ratio / known[name])))
    half = 0.5 * min(abs(log(known[best] / known[name])) for name in known if name != best)
    return best if best and abs(log(ratio / known[best])) < min(_FEW, max(_ADDED, half)) else None
