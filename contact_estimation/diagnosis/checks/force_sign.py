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

"""The sign of the force."""

from __future__ import annotations

import numpy as np

from .check import Finding, Test
from .evidence import Evidence
from ..observe.signals import Signals

_SMALL = 0.3  # of the expected force: that of another axis
_STRONGER = 3.0  # times the force on the other side
_PUSHING = 0.5  # correlation with the nominal force, and
_WORK = 0.01  # share of the work, from which on a specimen would be an engine


def find(evidence: Evidence) -> Finding:
    """
    Find a force that does not oppose the motion.

    A wall pushes back where x is largest; a permanently attached specimen takes up energy.

    Parameters
    ----------
    evidence : Evidence
        Of a recording.

    Returns
    -------
    finding : Finding
        Not ok if F_e has the opposite sign.

    """
    if not evidence.model.environment.unilateral:
        return _of_specimen(evidence)
    low, high = evidence.sides_beyond_zero
    if evidence.with_reference and _is_other_axis(evidence):
        return Finding(True, 'the force is too small to have a sign')
    far = max(low, high, key=abs)
    if far < evidence.clear_force or abs(far) < _STRONGER * abs(min(low, high, key=abs)):
        return Finding(True, f'F_e is {high:.3g} N at the largest x; it must be < 0 while '
                             'pressing')
    return Finding(False, f'F_e is {far:.3g} N while pressing, expected < 0: the force of the '
                          'environment on the end-effector; change the sign of the recorded force')


def _is_other_axis(evidence: Evidence) -> bool:
    return max(abs(evidence.of_wall.slope), abs(evidence.of_robot.slope)) < _SMALL


def _of_specimen(evidence: Evidence) -> Finding:
    s, against = evidence.smooth, evidence.of_wall.correlation
    force = s.force - np.mean(s.force)
    works = [-float(np.sum(part * s.v)) / max(float(np.sum(np.abs(part * s.v))), 1e-300)
             for part in (s.force, force)]
    text = f'the specimen takes up {100.0 * works[1]:.0f} % of the work exchanged'
    if max(works) > -_WORK or against > -_PUSHING:
        return Finding(True, text)
    return Finding(False, f'{text}, expected > 0: it would be an engine; -F_e was diagnosed. '
                          'Change the sign of the recorded force or of the position', fatal=False)


def inverted(signals: Signals) -> Signals:
    """Invert the force; parameters as `Test.put_right`."""
    return signals._replace(force=-signals.force)


TEST = Test(find, after=('clock_offset',), put_right=inverted)
