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

"""How long blocks are, and after which of them hypotheses are weighed."""

from __future__ import annotations

SURPRISE = 4.0
"""Mean square of a block, over the noise's: chi^2 of 5 to 10 rows, below 1e-3."""

SETTLED = 10
"""Blocks of a wall, from which something is known of it."""

_DOUBTFUL = 2.0  # mean square of a block that is judged although none is due
_EARLY = 20  # blocks of a contact, all of them short
_EARLY_DUE_S = 0.04  # of new data, from which hypotheses are weighed then
_DUE, _LEAST_DUE_S, _LONGEST_DUE_S = 0.1, 0.2, 1.0  # later: share of all since the touch, s, s
_ALERT = 5  # blocks judged after a surprise
_STEADY = 10  # long blocks without a surprise, before longer ones


class Rhythm:
    """
    Short blocks and frequent judgements where the wall may be another, few where it is not.

    Attributes
    ----------
    blocks : int
        Of the wall so far.

    """

    def __init__(self) -> None:
        self.blocks = self._of_contact = self._alert = self._unsteady = 0
        self._since_s = self._unjudged_s = 0.0

    @property
    def early(self) -> bool:
        """Whether contact or wall are new."""
        return self._of_contact <= _EARLY or self.blocks <= SETTLED

    @property
    def length(self) -> int:
        """Length of the next block: 0 for a short one, 1 and 2 for longer ones."""
        return 0 if self.early or self._alert else 1 if self._unsteady else 2

    def touch(self) -> None:
        """Begin a contact."""
        self._of_contact, self._since_s, self._unsteady = 0, 0.0, _STEADY

    def add(self, seconds: float) -> None:
        """Count a block [s]."""
        self.blocks += 1
        self._of_contact += 1
        self._since_s += seconds
        self._unjudged_s += seconds

    def judged(self) -> None:
        """Say that hypotheses have been weighed."""
        self._unjudged_s = 0.0

    def is_due(self, surprise: float) -> bool:
        """Return whether hypotheses are weighed now, by the mean square of the last block."""
        if surprise > SURPRISE:
            self._alert, self._unsteady, self._since_s = _ALERT, _STEADY, 0.0
        else:
            self._alert = max(self._alert - 1, 0)
        if self.length:
            self._unsteady = max(self._unsteady - 1, 0)
        if self._alert or self.blocks <= SETTLED or surprise > _DOUBTFUL:
            return True
        later = min(max(_DUE * self._since_s, _LEAST_DUE_S), _LONGEST_DUE_S)
        return self._unjudged_s > 0.9 * (_EARLY_DUE_S if self.early else later)
