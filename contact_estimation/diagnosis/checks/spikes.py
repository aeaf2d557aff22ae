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

"""Check: no position jumps away and back."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.signal import medfilt

from .check import Finding, Test
from .evidence import Evidence
from ..observe.signals import Signals

Array = NDArray[np.float64]

_NEIGHBOURS, _FAR = 5, 0.5  # samples of the median; distance from it, as a share of the range
# Of the samples, and of the distance of the nearest jump those of all others: more is a motion
# that is sampled coarsely.
_MOST, _APART = 0.01, 0.5


def find(evidence: Evidence) -> Finding:
    """
    Find positions that jump away and back within two samples.

    Parameters
    ----------
    evidence : Evidence
        Of a recording.

    Returns
    -------
    finding : Finding
        Not ok if there are any.

    """
    s = evidence.whole
    found = spikes(s.position)
    if not found.any():
        return Finding(True, 'no position jumps away and back')
    t, x = s.joint_t[found][0], s.position[found][0]
    return Finding(False, f'{np.count_nonzero(found)} position(s) jump away and back, the first '
                          f'to {x:.6g} m at {t:.6g} s: they are left out; check the encoder',
                   fatal=False)


def spikes(position: Array) -> NDArray[np.bool_]:
    """
    Return which positions jump away and back.

    Parameters
    ----------
    position : ndarray, shape (N,)
        [m].

    Returns
    -------
    found : ndarray of bool, shape (N,)
        None if there are too many for jumps, or others are nearly as far away.

    """
    usual = medfilt(position, _NEIGHBOURS)
    usual[:2], usual[-2:] = usual[2], usual[-3]  # the filter pads with zeros
    away = np.abs(position - usual)
    found = away > _FAR * np.ptp(usual)
    none = np.zeros(len(position), bool)
    if not found.any() or np.mean(found) >= _MOST:
        return none
    return found if np.max(away[~found]) < _APART * np.min(away[found]) else none


def without_spikes(signals: Signals) -> Signals:
    """
    Leave out positions that jump away and back.

    Parameters
    ----------
    signals : Signals
        As recorded.

    Returns
    -------
    signals : Signals
        With fewer joint samples.

    """
    kept = ~spikes(signals.position)
    return signals._replace(joint_t=signals.joint_t[kept], position=signals.position[kept])


TEST = Test(find, put_right=without_spikes)
