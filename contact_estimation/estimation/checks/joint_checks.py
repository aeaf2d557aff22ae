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

"""Checks of the joint states: a joint that does not move, and a rate that is too low."""

from __future__ import annotations

from .check import Check, CLEAR, Evidence

_FEWEST_PER_CUTOFF = 2.0  # sampling theorem
_SLOWER = 0.9  # than the wrench


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
