# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Checks of the joint states: a joint that stands still, units, velocities."""

from __future__ import annotations

import numpy as np

from .check import Check, Evidence
from ...signals.stream_faults import CLEAR

_FASTEST = 10.0  # of any arm [m/s]
_DEEPEST = 0.5  # of any contact [m]
_STEP_S, _STEP = 0.02, 10  # at least, over which positions and velocities are compared; samples
# Steps over those of a tenth of the time: 10 of a motion, 3.2 of a random walk, 1 of white noise.
_MOVES = 5.0
_FACTOR = 2.0  # between measured velocities and those of the positions
_SURE = 3.0  # standard deviations of that factor
_BEYOND = 0.5  # of the range of a joint, beyond its limits: the controller would stop it earlier


class JointStill(Check):
    """The joint of the contact axis moves."""

    name = 'joint_still'
    message = ("position of joint 'gripper' has not changed since the start while the force "
               'changed by 20 N; set joint to that of the contact axis')
    cause = 'Another joint was chosen, or its driver repeats one position.'
    remedy = 'Set `joint` and start again, or repair the driver; for an arm, see `kinematics.*`.'
    invalidates = True

    def judge(self, seen: Evidence) -> str | None:
        """Compare the travel since the start with the change of the force."""
        if seen.travel > 0.0:
            return ''
        if seen.spread < CLEAR * seen.noise:
            return None
        if seen.is_arm:
            which, remedy = 'the tip of the arm', ('check that joint_states come from the driver, '
                                                   'and kinematics.base and kinematics.tip')
        else:
            joint = seen.parameters.joints[seen.axis]
            which = f'joint {joint!r}' if joint else 'the joint'
            remedy = 'set joint to that of the contact axis'
        return (f'position of {which} has not changed since the start while the force changed by '
                f'{seen.spread:.3g} N; {remedy}')


class JointUnits(Check):
    """Joints of an arm turn within the limits of its description."""

    name = 'joint_units'
    message = ("joint 'elbow' is at 97 rad, where the robot description allows -3.1 to 3.1 rad: "
               'are these degrees? Publish joint states in radians')
    cause = 'The driver publishes degrees, or names the joints in another order.'
    remedy = 'Publish positions in radians and velocities in radians per second.'
    invalidates = True
    confirmations = 3

    def judge(self, seen: Evidence) -> str | None:
        """Compare the present positions with the limits."""
        for place, (name, low, high) in seen.limits.items():
            if place >= len(seen.joints):
                return None
            q, slack = seen.joints[place], _BEYOND * (high - low)
            if not low - slack <= q <= high + slack:
                return (f'joint {name!r} is at {q:.3g} rad, where the robot description allows '
                        f'{low:.3g} to {high:.3g} rad: are these degrees? Publish joint states in '
                        'radians')
        return ''


class PositionUnit(Check):
    """Positions are in metres."""

    name = 'position_unit'
    message = ('the contact axis moves at up to 80 m/s, 12 m into the wall: no robot does; '
               'publish positions in metres')
    cause = 'Positions come in millimetres, or a revolute joint is taken for the contact axis.'
    remedy = ('Publish positions in metres and velocities in metres per second, of an arm in '
              'radians; for an arm set `kinematics.*` and `contact.normal`.')
    invalidates = True

    def judge(self, seen: Evidence) -> str | None:
        """Compare speed and penetration with those of any robot."""
        x, t = seen.x, seen.t
        if len(x) < 3:
            return None
        speeds = np.abs(x[2:] - x[:-2]) / np.maximum(t[2:] - t[:-2], 0.1 * seen.period)
        fast = int(0.95 * len(speeds))
        speed = float(np.partition(speeds, fast)[fast])
        depth = float(np.max(seen.x[seen.contact] - seen.location, initial=0.0))
        if not (speed > _FASTEST or depth > _DEEPEST and not seen.pipeline.surface_text):
            return ''
        unit = 'joint states in radians' if seen.is_arm else 'positions in metres'
        return (f'the contact axis moves at up to {speed:.3g} m/s, {depth:.3g} m into the wall: '
                f'no robot does; publish {unit}')


class JointVelocity(Check):
    """Measured velocities are the rates of the positions."""

    name = 'joint_velocity'
    message = ('velocities of the joint states are 57 times the rate of their positions; publish '
               'them in the units of the positions, or leave them empty')
    cause = 'The driver publishes zeros, other units, or the wrong sign.'
    remedy = ('Repair the driver, or leave `velocity` empty: it is then taken from the '
              'positions.')
    invalidates = True

    def judge(self, seen: Evidence) -> str | None:
        """Compare what velocities add up to with the steps of the positions."""
        if not np.isfinite(seen.v).all() or not seen.joint_rate > 0.0 or seen.bursts:
            return None
        t, x, v, short = seen.t, seen.x, seen.v, seen.stride
        count = max(_STEP * short, round(min(_STEP_S / seen.period, float(len(t)))))
        if len(x) < 2 * count:
            return None
        path = np.append(0.0, np.cumsum(0.5 * (v[1:] + v[:-1]) * np.diff(t)))
        whole = t[count:] - t[:-count] < 2.0 * count * seen.period  # no gap between samples
        steps, added = ((one[count:] - one[:-count])[whole] for one in (x, path))
        power = float(steps @ steps)
        at_once = float(np.mean(np.square(x[short:] - x[:-short])))
        if not power > _MOVES**2 * at_once * len(steps) or not power > 0.0:
            return None
        factor = float(steps @ added) / power
        rest = added - factor * steps
        std = (count * float(rest @ rest) / len(steps) / power)**0.5  # steps overlap
        if 1.0 / _FACTOR < factor < _FACTOR:
            return ''
        if not (factor - _SURE * std > _FACTOR or factor + _SURE * std < 1.0 / _FACTOR):
            return None
        return (f'velocities of the joint states are {factor:.2g} times the rate of their '
                'positions; publish them in the units of the positions, or leave them empty')
