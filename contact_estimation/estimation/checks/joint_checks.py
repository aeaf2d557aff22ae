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

"""Checks of the joint states: a joint that stands still, units, velocities, and the rate."""

from __future__ import annotations

from math import ceil, inf

import numpy as np

from .check import Check, CLEAR, Evidence
from .robust_statistics import median_of

_FEWEST_PER_CUTOFF = 2.0  # sampling theorem
_SLOWER = 0.9  # than the wrench
_FASTEST = 10.0  # of any arm [m/s]
_DEEPEST = 0.5  # of any contact [m]
_STEP_S = 0.02  # over which positions and velocities are compared
_MOVES = 20.0  # steps over their noise, for a comparison
_FACTOR = 2.0  # between measured velocities and those of the positions


class JointStill(Check):
    """The joint of the contact axis moves."""

    name = 'joint_still'
    message = ("position of joint 'gripper' has not changed since the start while the force "
               'changed by 20 N; set joint to that of the contact axis')
    cause = 'Another joint was chosen, or its driver repeats one position.'
    remedy = 'Set `joint` and start again, or repair the driver.'
    invalidates = True

    def judge(self, seen: Evidence) -> str | None:
        """Compare the travel since the start with the change of the force."""
        if seen.travel > 0.0:
            return ''
        if seen.spread < CLEAR * seen.noise:
            return None
        joint = seen.parameters.joints[seen.axis]
        which = f'joint {joint!r}' if joint else 'the joint'
        return (f'position of {which} has not changed since the start while the force changed by '
                f'{seen.spread:.3g} N; set joint to that of the contact axis')


class PositionUnit(Check):
    """Positions are in metres."""

    name = 'position_unit'
    message = ('the contact axis moves at up to 80 m/s, 12 m into the wall: no robot does; '
               'publish positions in metres')
    cause = 'Positions come in millimetres, or a revolute joint is taken for the contact axis.'
    remedy = ('Publish positions in metres and velocities in metres per second; for an arm set '
              '`kinematics.*` and `contact.normal`.')
    invalidates = True

    def judge(self, seen: Evidence) -> str | None:
        """Compare speed and penetration with those of any robot."""
        x, t = seen.x, seen.t
        if len(x) < 3:
            return None
        speeds = np.abs((x[2:] - x[:-2]) / (t[2:] - t[:-2]))
        fast = int(0.95 * len(speeds))
        speed = float(np.partition(speeds, fast)[fast])
        depths = seen.x[seen.contact] - seen.pipeline.location
        depth = float(np.max(depths, initial=0.0))
        if not (speed > _FASTEST or depth > _DEEPEST and not seen.pipeline.touch_down.text):
            return ''
        return (f'the contact axis moves at up to {speed:.3g} m/s, {depth:.3g} m into the wall: '
                'no robot does; publish positions in metres')


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
        """Compare what velocities add up to in 20 ms with the steps of the positions."""
        if len(seen.x) < 3 or not np.isfinite(seen.v).all() or not seen.joint_rate > 0.0:
            return None
        t, x, v = seen.t, seen.x, seen.v
        count = max(1, round(_STEP_S / seen.period))
        path = np.zeros(len(t))
        np.cumsum(0.5 * (v[1:] + v[:-1]) * (t[1:] - t[:-1]), out=path[1:])
        whole = t[count:] - t[:-count] < 2.0 * _STEP_S  # no gap between samples
        steps, added = ((one[count:] - one[:-count])[whole] for one in (x, path))
        noise = _noise_of_joints(seen)
        power = float(steps @ steps)
        if power <= _MOVES**2 * noise**2 * len(steps):
            return None
        factor = float(steps @ added) / power
        if 1.0 / _FACTOR < factor < _FACTOR:
            return ''
        return (f'velocities of the joint states are {factor:.2g} times the rate of their '
                'positions; publish them in the units of the positions, or leave them empty')


def _noise_of_joints(seen: Evidence) -> float:
    """Return the noise of positions: samples between joint states lie on straight lines."""
    lag = max(1, ceil(0.99 / (seen.joint_rate * seen.period)))
    bends = seen.x[2 * lag:] - 2.0 * seen.x[lag:-lag] + seen.x[:-2 * lag]
    return median_of(np.abs(bends)) + 1e-12 if len(bends) else inf


class JointRate(Check):
    """Joint states come fast enough for the filter."""

    name = 'joint_rate'
    message = ('joint states come at 60 Hz, but the filter passes 50 Hz; publish them at 100 Hz '
               'or more, or lower conditioning.cutoff_frequency to 15')
    cause = ('Between joint states the position is interpolated by a straight line, which the '
             'filter passes on as a wrong motion.')
    remedy = 'Publish joint states faster, or lower `conditioning.cutoff_frequency`.'

    def judge(self, seen: Evidence) -> str | None:
        """Compare the rate with the cut-off frequency."""
        rate, cutoff = seen.joint_rate, seen.parameters.conditioning.cutoff_frequency
        if rate != rate:
            return None
        period = seen.pipeline.sample_period_s
        needed = _FEWEST_PER_CUTOFF * cutoff
        if cutoff == 0.0 or rate >= needed or rate * period >= _SLOWER:
            return ''
        return (f'joint states come at {rate:.3g} Hz, but the filter passes {cutoff:g} Hz; '
                f'publish them at {needed:.3g} Hz or more, or lower '
                f'conditioning.cutoff_frequency to {0.25 * rate:.2g}')
