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

"""Skew between the stamps of wrench and joint states."""

from __future__ import annotations

from .check import Check, Evidence
from .lag_search import Skew, skew_of

_SIGNIFICANT = 40.0  # likelihood ratio
_BETTER = 0.5  # share of the residual above the noise that the lag takes away
_LEAST_S = 0.003  # a shorter lag is that of an ordinary sensor, and part of timing_std
_DEVIATIONS = 3.0  # of timing_std
_OF_PERIOD = 0.5  # of the joint states
_OTHER_PHYSICS = 20.0  # likelihood ratio over the best other explanation but a mass
_OVER_MASS = 30.0  # likelihood ratio over a mass


class StampSkew(Check):
    """The stamps of wrench and joint states are of one clock and of the same instants."""

    name = 'stamp_skew'
    message = ('the stamps of the wrench are 10 ms late against the joint states; a lag acts as a '
               'damping of -K tau; set synchronisation.offset to +0.01')
    cause = 'The drivers stamp on arrival, or their clocks differ.'
    remedy = ('Set `synchronisation.offset` to the value given (it is added to the stamps of the '
              'joint states), or synchronise the clocks.')
    invalidates = True
    confirmations = 2

    def judge(self, seen: Evidence) -> str | None:
        """Search the lag in the last seconds of contact."""
        skew = _remembered(seen)
        if skew is None or not _is_clear(skew, seen):
            return '' if skew and _is_none(skew, seen) else None
        if skew.over_mass < _OVER_MASS:
            return None
        when = 'late' if skew.seconds > 0.0 else 'early'
        return (f'the stamps of the wrench are {1e3 * abs(skew.seconds):.2g} ms {when} against '
                'the joint states; a lag acts as a damping of -K tau; set '
                f'synchronisation.offset to {_offset(skew, seen):+.3f}')


class StampSkewOrMass(Check):
    """No lag, and no mass moves with the wall."""

    name = 'stamp_skew_or_mass'
    message = ('the stamps of the wrench are 10 ms early against the joint states, or a mass of '
               '1.2 kg moves with the wall; in the first case set synchronisation.offset to -0.01')
    cause = 'One frequency of excitation cannot tell a lag of the motion from a mass.'
    remedy = ('Touch down again or excite several frequencies; then see stamp_skew. For a mass '
              'choose an estimator that estimates it.')
    confirmations = 2

    def judge(self, seen: Evidence) -> str | None:
        """Search the lag in the last seconds of contact."""
        skew = _remembered(seen)
        if skew is None or not _is_clear(skew, seen):
            return '' if skew and _is_none(skew, seen) else None
        if skew.over_mass >= _OVER_MASS:
            return ''
        when = 'late' if skew.seconds > 0.0 else 'early'
        return (f'the stamps of the wrench are {1e3 * abs(skew.seconds):.2g} ms {when} against '
                f'the joint states, or a mass of {skew.mass:.2g} kg moves with the wall; in the '
                f'first case set synchronisation.offset to {_offset(skew, seen):+.3f}')


def _remembered(seen: Evidence) -> Skew | None:
    """Return the skew, computed once for both checks."""
    if 'skew' not in seen.memory:
        seen.memory['skew'] = skew_of(seen)
    found: Skew | None = seen.memory['skew']
    return found


def _limit(seen: Evidence) -> float:
    """Return the lag of an ordinary sensor, or of sparse joint states as interpolated [s]."""
    sparse = _OF_PERIOD / seen.joint_rate if seen.joint_rate > 0.0 else 0.0  # NaN: not yet known
    return max(_LEAST_S, _DEVIATIONS * seen.parameters.synchronisation.timing_std, sparse)


def _is_clear(skew: Skew, seen: Evidence) -> bool:
    """Return whether there is a lag, and no other physics than perhaps a mass."""
    return (abs(skew.seconds) > _limit(seen) and skew.gain > _SIGNIFICANT
            and skew.excess_gone > _BETTER and skew.over_physics > _OTHER_PHYSICS)


def _is_none(skew: Skew, seen: Evidence) -> bool:
    """Return whether the contact shows that there is no lag."""
    return abs(skew.seconds) <= _limit(seen) and skew.sharpness > _SIGNIFICANT


def _offset(skew: Skew, seen: Evidence) -> float:
    return seen.parameters.synchronisation.offset + skew.seconds
