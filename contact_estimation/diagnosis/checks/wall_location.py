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

"""The location of the wall."""

from __future__ import annotations

from dataclasses import replace
from typing import Sequence

import numpy as np

from .check import Check, Finding, Test
from .evidence import Evidence

_LISTED = 6
_FAR = 1.5  # times the depth: more than physics of the surface explain


def find(evidence: Evidence) -> Finding:
    """
    Find contacts that do not begin at the wall of the model.

    A late contact may be a clearance, unless the tool is never before the wall in free flight.
    Without a reference it is left to the diagnosis.

    Parameters
    ----------
    evidence : Evidence
        Of a recording.

    Returns
    -------
    finding : Finding
        Not ok if the wall is elsewhere.

    """
    wall, onset = evidence.model.environment, evidence.onset
    if not wall.unilateral or onset is None:
        return Finding(True, f'environment.location is {wall.location:g} m')
    text = (f'the force begins at x = {onset.position:.4g} m and goes {onset.depth:.3g} m deep; '
            f'environment.location is {wall.location:g} m')
    off = onset.position - wall.location
    x = evidence.smooth.x
    never, always = float(np.max(x)) < wall.location, float(np.min(x)) > wall.location
    far = abs(off) > _FAR * onset.depth + onset.blur
    beyond = always and evidence.with_reference and evidence.sees_free_flight
    if never or (far and (off < 0.0 or beyond)):
        return Finding(False, f'{text}, expected there; set the location to about '
                              f'{onset.position:.4g} m')
    return Finding(True, text)


def with_places(checks: Sequence[Check], places: Sequence[float]) -> list[Check]:
    """
    Replace the result of this check by what the contacts have shown.

    Parameters
    ----------
    checks : sequence of Check
        Of the recordings.
    places : sequence of float
        Where the surface of each contact is [m].

    Returns
    -------
    checks : list of Check
        That of the location failed; nothing is refused, since each contact is moved to the surface
        of the model.

    """
    listed = ', '.join(f'{place:.4g}' for place in places[:_LISTED])
    listed += ' ...' if len(places) > _LISTED else ''
    text = (f'the surface is at x = {listed} m in {len(places)} contacts, expected at one place: '
            'the object was moved or is touched somewhere else; each contact is moved to '
            'environment.location before it is diagnosed; touch one place, or keep the object '
            'fixed')
    return [replace(one, ok=False, text=text) if one.name == 'wall_location' else one
            for one in checks]


TEST = Test(find, after=('clock_offset', 'force_sign', 'position_sign', 'length_unit',
                         'excitation', 'axis'))
