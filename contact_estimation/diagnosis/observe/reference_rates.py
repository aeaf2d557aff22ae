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
"""Rates of a reference that was recorded without them."""

from __future__ import annotations

import numpy as np

from .signals import Recording, Signals

_SMOOTH = 0.9  # of the changes of x_r, that follow another one: else it is a staircase


def lacks_rates(signals: Signals) -> bool:
    """Return whether a reference moves smoothly but has no rates."""
    if len(signals.reference_t) < 3 or signals.reference[1:3].any():
        return False
    moves = np.diff(signals.reference[0]) != 0.0
    following = np.count_nonzero(moves[1:] & moves[:-1])
    return bool(following > _SMOOTH * np.count_nonzero(moves) > 0.0)


def with_reference_rates(recording: Recording) -> Recording:
    """Differentiate a reference that lacks its rates."""
    s = recording.signals
    if not lacks_rates(s):
        return recording
    x_r, _, _, F_r = s.reference
    rate = np.gradient(x_r, s.reference_t)
    rows = np.array([x_r, rate, np.gradient(rate, s.reference_t), F_r])
    return Recording(recording.name, s._replace(reference=rows))
