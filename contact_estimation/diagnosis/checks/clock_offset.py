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

"""The clocks of the topics."""

from __future__ import annotations

from typing import Sequence

from .check import Check, Finding, Test
from .evidence import Evidence
from ...physics import EFFECTS

_EARLY_S, _LATE_S = 0.03, 0.15  # no sensor is ahead of the motion, or later than that
_LEAST_SAMPLES = 3.0
_CORRELATED, _BETTER = 0.85, 0.005  # correlation at the best shift, and its gain
_AT_PEAK = 0.5  # of the shift: by which the peaks may be apart from it
_LEFT = 0.5  # most of the variance that a shift leaves: dissipation is ahead of the motion too


def find(evidence: Evidence) -> Finding:
    """
    Find topics that are stamped by clocks that differ.

    Parameters
    ----------
    evidence : Evidence
        Of a recording.

    Returns
    -------
    finding : Finding
        Not ok if they do not overlap, or the force is ahead of the motion or later than any
        sensor.

    """
    overlap = evidence.overlap
    if not overlap.enough:
        return Finding(False, f'{overlap.text}: expected the same time, got '
                              f'{overlap.seconds:.3g} s in common; stamp all topics by one '
                              'clock, in one unit')
    if not evidence.model.environment.unilateral:
        return Finding(True, overlap.text)
    lag = evidence.lag
    text = f'the force fits the motion best when shifted by {1e3 * lag.seconds:.0f} ms'
    off = lag.seconds > _LATE_S or lag.seconds < -_EARLY_S
    explains = 1.0 - lag.correlation**2 < _LEFT * (1.0 - lag.unshifted**2)
    # A damped contact is ahead of its spring, but not of what the robot felt.
    felt = evidence.with_reference and evidence.of_robot.correlation > lag.correlation
    # What is held back as it leaves is ahead as well; a robot would have felt that.
    held = evidence.pulls and not evidence.with_reference
    long = abs(lag.seconds) > _LEAST_SAMPLES * evidence.period
    # What yields is ahead of its spring, but peaks with it.
    shifted = off and _AT_PEAK * abs(lag.seconds) > abs(
        evidence.peaks_apart(abs(lag.seconds)) - lag.seconds)
    if (shifted and explains and not felt and not held and long
            and lag.correlation > max(_CORRELATED, lag.unshifted + _BETTER)):
        return Finding(False, f'{text}, expected {-1e3 * _EARLY_S:.0f} to {1e3 * _LATE_S:.0f} ms: '
                              'the clocks of wrench and joint_states differ; synchronise them')
    return Finding(True, text)


def with_offset(
    checks: Sequence[Check], topic: str, late: float, commanded: bool = True
) -> list[Check]:
    """
    Replace the result of this check by what the fits have shown.

    Parameters
    ----------
    checks : sequence of Check
        Of a recording.
    topic : str
        'joint_states' or 'wrench'.
    late : float
        By how much its stamps are late [s]; negative if they are early.
    commanded : bool
        Whether there is a robot with a reference; otherwise a force drives the wall.

    Returns
    -------
    checks : list of Check
        That of the clocks failed.

    """
    side, when = ('late', 'earlier') if late > 0.0 else ('early', 'later')
    others = 'command and force both fit the motion'
    if topic == 'wrench':
        others = 'the force fits motion and command'
    cause = f'{topic} are' if topic == 'joint_states' else f'{topic} is'
    cause += f' stamped {side}' + (' or filtered' if late > 0.0 else '')
    if not commanded:
        others = 'the force that drives the wall fits the motion'
        cause += ', or wrench is a command that the drive follows late; record the measured force'
    elif late < 0.0:
        cause += ', or the other topics late'
    joints = late if topic == 'joint_states' else -late
    text = (f'{others} best about {1e3 * abs(late):.2g} ms {when}, '
            f'expected at the same instant: {cause}; stamp each sample when it is '
            f'measured (on line, set synchronisation.offset to {-joints:.2g} s)')
    return [Check(one.name, False, text, True, frozenset(EFFECTS))
            if one.name == 'clock_offset' else one for one in checks]


TEST = Test(find, after=('sampling_rate',))
