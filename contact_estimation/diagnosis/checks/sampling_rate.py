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

"""The sampling rate."""

from __future__ import annotations

from math import log, pi, sqrt

import numpy as np

from .check import Finding, of_families, Test
from .evidence import Evidence
from ..observe.signals import LEAST_SAMPLES

_COARSE = 1.0  # radians of the natural oscillation, a sample
# Between recorded rates of the reference and those of its positions: steps over which they are
# compared, the share of the greatest rate from which on, the factor that is another clock, and the
# scatter of that.
_STRIDE, _FAST, _STRETCHED, _SCATTER = 10, 0.3, 1.03, 0.1


def find(evidence: Evidence) -> Finding:
    """
    Find sampling that is too slow for the oscillation of robot or mass and wall.

    Parameters
    ----------
    evidence : Evidence
        Of a recording.

    Returns
    -------
    finding : Finding
        Not ok if dynamics fall between the samples; fatal if stamps have another unit.

    """
    rate, angular = 1.0 / evidence.period, _natural_frequency(evidence)
    if angular is None or not evidence.overlap.enough:
        return Finding(True, f'{rate:.3g} Hz')
    text = f'{rate:.3g} Hz for an oscillation of wall and mass at {angular / (2.0 * pi):.3g} Hz'
    unlike = _rates_over_stamps(evidence)
    if unlike is not None:
        return Finding(False, f'{text}; x_r moves {1.0 / unlike:.3g} times as fast as its '
                              'recorded rates, expected 1: stamps or rates have another unit, '
                              'or another clock; record seconds')
    if angular * evidence.period > 2.0 * pi:
        return Finding(False, f'{text}: nothing of it can be seen; check the unit of the stamps, '
                              'or record at a higher rate')
    if angular * evidence.period < _COARSE:
        return Finding(True, text)
    return Finding(False, f'{text}, expected at least {2.0 * pi / _COARSE:.1f} samples a period; '
                          'record at a higher rate. No fast dynamics are named', fatal=False)


def _rates_over_stamps(evidence: Evidence) -> float | None:
    """Return the ratio of recorded rates to differences of the reference if it is not 1."""
    t, (x, v, _, _) = evidence.whole.reference_t, evidence.whole.reference
    if len(t) <= _STRIDE:
        return None
    travel = np.concatenate([[0.0], np.cumsum(0.5 * (v[1:] + v[:-1]) * np.diff(t))])
    foretold, moved = (row[_STRIDE:] - row[:-_STRIDE] for row in (travel, x))
    fast = np.abs(foretold) > _FAST * np.max(np.abs(foretold))
    if np.count_nonzero(fast) < LEAST_SAMPLES:
        return None
    with np.errstate(divide='ignore'):  # of a reference that is held
        ratios = foretold[fast] / moved[fast]
    low, usual, high = np.quantile(ratios, (0.25, 0.5, 0.75))
    unlike = usual > 0.0 and abs(log(usual)) > log(_STRETCHED)
    return float(usual) if unlike and high - low < _SCATTER * usual else None


def _natural_frequency(evidence: Evidence) -> float | None:
    """Return the natural frequency of the nominal contact [rad/s]."""
    wall, robot = evidence.model.environment, evidence.model.robot
    if evidence.with_reference:
        return sqrt(max(wall.stiffness + robot.stiffness, 0.0) / robot.mass)
    if not wall.unilateral and wall.inertia > 0.0:
        return sqrt(max(wall.stiffness, 0.0) / wall.inertia)
    return None


TEST = Test(find, after=('stamp_bursts',), could_cause=of_families(
    'timing', 'inertia', 'damping_law', 'robot', 'limits', 'clearance', 'adhesion'))
