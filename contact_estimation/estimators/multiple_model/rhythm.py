# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""How long blocks are, and when hypotheses are weighed."""

from .constants import FADE_S

SURPRISE = 4.0
"""Mean square of a block, over the noise's: chi^2 of 5 to 10 rows, below 1e-3."""

SETTLED = 10
"""Blocks of a wall, from which something is known of it."""

_DOUBTFUL = 2.0  # mean square of a block that is judged although none is due
_EARLY = 20  # blocks of a contact, all of them short
_EARLY_DUE_S = 0.04  # of new data, from which hypotheses are weighed in the first contact
_LEAST_DUE_S = 0.2  # the same later
_OF_ALL, _OF_CONTACT = 0.1, 0.5  # share of the data that is new, from which they are weighed
_ALERT = 5  # blocks judged after a surprise
_STEADY = 10  # long blocks without a surprise, before longer ones


class Rhythm:
    """Short blocks and frequent judgements where the wall may be another, few where it is not."""

    def __init__(self, followed: bool) -> None:
        self.followed, self.walks = followed, False
        self.blocks = self._of_contact = self._alert = self._unsteady = 0
        self._since_s = self._contact_s = self._unjudged_s = 0.0

    @property
    def early(self) -> bool:
        """Whether contact or wall are new."""
        return self._of_contact <= _EARLY or self.blocks <= SETTLED

    @property
    def surprised(self) -> bool:
        """Whether a block of a wall of which something is known has been a surprise of late."""
        return self._alert > 0 and self.blocks > SETTLED

    def waits(self, surprise: float) -> bool:
        """Return whether a block may hold half of a jump: the next shows what is after it."""
        return surprise > SURPRISE and not self._alert and (
            self._of_contact > 0 and self.blocks >= SETTLED)

    @property
    def length(self) -> int:
        """Length of the next block: 0 for a short one, 1 and 2 for longer ones."""
        if self.early or self._alert:
            return 0
        return 1 if self._unsteady or self.followed or self.walks else 2

    def touch(self) -> None:
        """Begin a contact."""
        self._of_contact, self._contact_s, self._unsteady = 0, 0.0, _STEADY

    def add(self, seconds: float) -> None:
        """Count a block [s]."""
        self.blocks += 1
        self._of_contact += 1
        self._since_s += seconds
        self._contact_s += seconds
        self._unjudged_s += seconds

    @property
    def unjudged(self) -> bool:
        """Whether there are data with which hypotheses have not been weighed."""
        return self._unjudged_s > 0.0

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
        if self.followed:
            return self.early or self._unjudged_s > 0.9 * _LEAST_DUE_S
        due = _EARLY_DUE_S if self.walks or self.blocks <= _EARLY else max(_LEAST_DUE_S, min(
            _OF_ALL * min(self._since_s, FADE_S), _OF_CONTACT * self._contact_s))
        return self._unjudged_s > 0.9 * due
