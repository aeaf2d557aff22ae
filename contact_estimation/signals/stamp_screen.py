# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Stamps that no measurement can have."""

from collections import Counter
from typing import Any

BEFORE_ANY = -(2**63)
"""Where no stamp has come yet: before any that a message can have [ns]."""

CONFIRMING = 5
"""
Consecutive messages of a topic that prove a new clock: 10 ms at 500 Hz, 50 ms at 100 Hz.

If each stamp is false with the probability p, independently, they mistake false ones for a clock
with less than p^5 at each message; and none of them is lost.
"""

_END = 2**63  # of what a stamp can say [ns]
_PERIODS = 5  # lost in a row are no silence

Message = tuple[int, Any]
"""Stamp [ns] and content."""


class StampScreen:
    """
    Reject stamps that no measurement can have, before anything else is done with the messages.

    A stamp of zero is valid only as the first of a clock that begins there. One too far ahead of
    the last stamps of both topics, or behind them, is held back: the next message of the topic
    refutes it, or `CONFIRMING` messages that increase prove that the clock was set, or that both
    topics were silent. All of them are used then.

    held: held back, in the order of their arrival
    before_ns: the stamp used before the last one of the topic; `BEFORE_ANY` where there is none
    [ns]
    """

    def __init__(self, kind: str, rejected: Counter[str]) -> None:
        self._kind, self._rejected = kind, rejected
        self.held: list[Message] = []
        self.before_ns = BEFORE_ANY

    def admit(
        self, message: Message, last_ns: int, other_ns: int, gap_ns: int, jump_ns: int,
        offset_ns: int = 0,
    ) -> list[Message]:
        """
        Take a message; return those that can be used now, in the order of their stamps.

        last_ns, other_ns: last stamp used of this topic and of the other; `BEFORE_ANY` where there
        is none [ns]
        gap_ns: largest distance ahead of them, except in a topic so slow that five of its periods
        are longer: then these, up to `jump_ns` [ns]
        jump_ns: largest distance behind them on one clock [ns]
        offset_ns: what was added to the stamps of this topic [ns]
        """
        stamp_ns = message[0]
        ahead_ns = max(gap_ns, min(jump_ns, _PERIODS * (last_ns - self.before_ns)))
        measured_ns, far = stamp_ns - offset_ns, not -jump_ns <= stamp_ns - other_ns <= ahead_ns
        if not 0 <= measured_ns < _END:  # also true for NaN
            return self._reject('invalid_stamp')
        begun = last_ns != BEFORE_ANY
        if measured_ns == 0 and (begun or far and other_ns != BEFORE_ANY):
            return self._reject('zero_stamp')
        if begun and last_ns - jump_ns <= stamp_ns <= last_ns:
            return self._reject('duplicate' if stamp_ns == last_ns else 'out_of_order')
        if begun and last_ns != offset_ns and far:  # nothing follows from a single stamp of zero
            if stamp_ns > last_ns + ahead_ns or stamp_ns < last_ns:
                return self._hold(message, last_ns)
        return self._release(message, last_ns, jump_ns)

    def _reject(self, reason: str) -> list[Message]:
        self._rejected[f'{self._kind}_{reason}'] += 1
        return []

    def _refute(self, last_ns: int) -> None:
        for stamp_ns, _ in self.held:
            self._reject('future_stamp' if stamp_ns > last_ns else 'past_stamp')
        self.held = []

    def _hold(self, message: Message, last_ns: int) -> list[Message]:
        stamp_ns, held = message[0], self.held
        if held and stamp_ns == held[-1][0]:
            return self._reject('duplicate')
        if held and (stamp_ns < held[-1][0] or (stamp_ns > last_ns) != (held[0][0] > last_ns)):
            self._refute(last_ns)
        self.held.append(message)
        if len(self.held) < CONFIRMING:
            return []
        confirmed, self.held = self.held, []
        return confirmed

    def _release(self, message: Message, last_ns: int, jump_ns: int) -> list[Message]:
        """Return a message on a known clock, after those held back that are on it too."""
        if self.held and not message[0] - jump_ns <= self.held[-1][0] < message[0]:
            self._refute(last_ns)
        confirmed, self.held = self.held, []
        return [*confirmed, message]
