# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Checks of the experiment: contact, wall, motion and command."""

from dataclasses import replace
from math import sqrt
from typing import Sequence

import numpy as np

from .check import bend_of, Check, Finding, FOLLOWS, line_through, LISTED, STRAIGHT
from .quantities import Quantities
from ..observe.shares import LITTLE, MUCH
from ..observe.signals import lacks_rates
from ...signals.stream_faults import CLEAR

_VARIES = sqrt(2.0)  # spread in the white noise from which on as much is signal
_FAR = 1.5  # times the depth: a surface that is so far off is more than physics of the surface


def excitation(quantities: Quantities) -> Finding:
    """Find a force or a position that is nothing but noise."""
    force, position = (np.concatenate([getattr(part, row) for part in quantities.parts])
                       for row in ('force', 'position'))
    ratios = (float(np.std(force)) / max(quantities.force_noise, 1e-300),
              float(np.std(position)) / max(quantities.position_noise, 1e-300))
    if ratios[1] < _VARIES:
        return Finding(False, 'the position is nothing but noise, expected a motion; check the '
                              'joint, or excite the contact')
    if ratios[0] > _VARIES:
        return Finding(True, f'the force varies by {ratios[0]:.3g} times its noise')
    text = f'the force is nothing but noise of {quantities.force_noise:.3g} N'
    if quantities.with_reference:
        felt = float(np.std(quantities.implied_force))
        pushed = line_through(quantities.wall_force, -quantities.implied_force).correlation
        if felt > CLEAR * quantities.force_noise and pushed > FOLLOWS:
            return Finding(False, f'{text}, but the robot was pushed by {felt:.3g} N: expected '
                                  'the force of the contact; check topic, --axis and sensor')
    return Finding(False, f'{text}, expected a contact force: nothing was touched, or the sensor '
                          'is not connected; record a contact')


def unilateral(quantities: Quantities) -> Finding:
    """
    Find free flight of a robot that the model attaches to the wall, or none where it does not.

    A specimen without a command may well be slack; a robot that is commanded leaves the wall. What
    pushes and pulls, each for much of the time, and is nowhere free, does not touch a surface.
    """
    if quantities.model.environment.unilateral:
        return _of_touch(quantities)
    if len(quantities.whole.reference_t) < 2:
        return Finding(True, 'no reference_trajectory: not the robot of eq. (1)')
    x, onset = quantities.smooth.x, quantities.onset
    free = 0.0 if onset is None else onset.position - float(np.min(x))
    text = f'the force is that of free flight over {1e3 * free:.3g} mm of the motion'
    if onset is None or free <= LITTLE * float(np.ptp(x)):
        return Finding(True, text)
    before, within = (line_through(x[side], quantities.smooth.force[side]).slope
                      for side in (x < onset.position, x >= onset.position))
    if abs(before) > MUCH * abs(within):
        return Finding(True, 'the force changes over the whole motion')
    return Finding(False, f'{text}, expected a wall that the tool is attached to '
                          '(environment.unilateral: false); set environment.unilateral to true')


def _of_touch(quantities: Quantities) -> Finding:
    force = quantities.smooth.force
    least = max(quantities.clear_force, LITTLE * float(np.ptp(force)))
    pulls, pushes = (float(np.mean(sign * force > least)) for sign in (1.0, -1.0))
    text = f'F_e pulls for {100.0 * pulls:.0f} % of the time, pushes for {100.0 * pushes:.0f} %'
    if min(pulls, pushes) < MUCH or quantities.sees_free_flight:
        return Finding(True, text)
    return Finding(False, f'{text}, and nowhere is there free flight: nothing that only touches '
                          'a surface; set environment.unilateral to false')


def wall_location(quantities: Quantities) -> Finding:
    """Find contacts that do not begin at the wall of the model."""
    # A late contact may be a clearance, unless the tool is never before the wall in free flight.
    # Without a reference it is left to the diagnosis.
    wall, onset = quantities.model.environment, quantities.onset
    if not wall.unilateral or onset is None:
        return Finding(True, f'environment.location is {wall.location:g} m')
    text = (f'the force begins at x = {onset.position:.4g} m and goes {onset.depth:.3g} m deep; '
            f'environment.location is {wall.location:g} m')
    off = onset.position - wall.location
    x = quantities.smooth.x
    never, always = float(np.max(x)) < wall.location, float(np.min(x)) > wall.location
    far = abs(off) > _FAR * onset.depth + onset.blur
    beyond = always and quantities.with_reference and quantities.sees_free_flight
    if never or (far and (off < 0.0 or beyond)):
        return Finding(False, f'{text}, expected there; set the location to about '
                              f'{onset.position:.4g} m')
    return Finding(True, text)


def with_places(checks: Sequence[Check], places: Sequence[float]) -> list[Check]:
    """Replace the result of `wall_location` by where the surface of each contact is [m]."""
    # Nothing is refused, since each contact is moved to the surface of the model.
    listed = ', '.join(f'{place:.4g}' for place in places[:LISTED])
    listed += ' ...' if len(places) > LISTED else ''
    text = (f'the surface is at x = {listed} m in {len(places)} contacts, expected at one place: '
            'the object was moved or is touched somewhere else; each contact is moved to '
            'environment.location before it is diagnosed; touch one place, or keep the object '
            'fixed')
    return [replace(one, ok=False, text=text) if one.name == 'wall_location' else one
            for one in checks]


def constant_speed(quantities: Quantities) -> Finding:
    """Find a single stroke at constant speed, in which depth grows in proportion to time."""
    bend = bend_of(*quantities.motion_in_contact)
    text = f'the motion departs from one stroke at constant speed by {100.0 * bend:.2g} % of ' \
           'its range'
    if bend > STRAIGHT:
        return Finding(True, text)
    return Finding(False, f'{text}: laws of time and speed, and what yields for good, look like '
                          'laws of depth, and only the latter are named; which of them fit about '
                          'as well may differ from stroke to stroke. Record the way back or a '
                          'hold, or another speed and diagnose both recordings together',
                   fatal=False)


def command_topic(quantities: Quantities) -> Finding:
    """Find a reference that is measured, only the goal, or not what the robot follows."""
    if not quantities.with_reference:
        return Finding(True, 'no reference_trajectory')
    s, robot = quantities.smooth, quantities.model.robot
    assert s.reference is not None
    away = np.abs(s.force - quantities.sides[0])
    contact = away > MUCH * float(np.max(away))
    felt = robot.stiffness * float(np.sqrt(np.mean((s.x - s.reference[0])[contact] ** 2)))
    pressed = float(np.sqrt(np.mean(away[contact] ** 2)))
    share = felt / max(pressed, 1e-300)
    text = f'in contact the robot is deflected from x_r by {share:.2g} times F_e / K_t'
    change = ('; record the trajectory that the robot was told to follow as '
              'reference_trajectory')
    tested = not robot.force_tracking and pressed > CLEAR * quantities.force_noise
    if tested and share < LITTLE:
        return Finding(False, f'{text}, expected about 1: the reference seems to be the measured '
                              f'position{change}')
    moves = float(np.mean(np.diff(quantities.whole.reference[0]) != 0.0))
    pulled = robot.stiffness * (s.reference[0] - s.x)[~contact]
    needed = quantities.implied_force[~contact]
    left = float(np.sqrt(np.mean(needed**2) / max(np.mean(pulled**2), 1e-300)))
    if moves < LITTLE and not contact.all() and left > MUCH:
        return Finding(False, 'x_r is held, and in free flight a robot that is pulled to it would '
                              f'need {100.0 * left:.0f} % of K_t (x_r - x) less: the reference '
                              f'seems to be only the goal of a planner{change}')
    follows = line_through(s.reference[0], s.x).correlation
    if abs(follows) < MUCH and quantities.of_robot.correlation < FOLLOWS:
        return Finding(False, f'the correlation of x with x_r is {follows:.2f}, and the '
                              'deflection is no force: the robot follows another '
                              f'reference{change}')
    return Finding(True, text)


def reference_rates(quantities: Quantities) -> Finding:
    """Find a reference that moves smoothly, but was recorded without its rates."""
    if not quantities.with_reference:
        return Finding(True, 'no reference_trajectory')
    if not lacks_rates(quantities.whole):
        return Finding(True, 'x_r is recorded with its rates')
    return Finding(False, 'x_r moves smoothly, but all its velocities and accelerations are 0 or '
                          'missing, expected the feed-forward that the robot was told: both are '
                          'differentiated from x_r; record them', fatal=False)
