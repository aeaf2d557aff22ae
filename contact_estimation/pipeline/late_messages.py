# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""
Messages that a recorder received late, put back in the order of their stamps.

What a recorder without CPU misses is sent again, seconds later, each topic for itself. The node
had it in time and has paired it, so the replay must. A topic that stays behind is another matter:
its clock is wrong or its driver is slow, and the node has rejected it.
"""

from __future__ import annotations

from collections import Counter
from typing import Callable, Iterable, Iterator

from ..messages.cdr import header_stamp_ns
from ..recordings import RecordedMessage
from ..signals.stamp_screen import BEFORE_ANY, StampScreen
from ..signals.synchronisation import SynchronisationParameters

_MOST_HELD = 6000  # messages for which a late topic is awaited


class LateMessages:
    """Undo the lateness of one topic against the other, where it does not last."""

    def __init__(self, wrench: str, limits: Callable[[], SynchronisationParameters]) -> None:
        self._wrench, self._limits = wrench, limits

    def joined(
        self, batches: Iterable[list[RecordedMessage]]
    ) -> Iterator[list[RecordedMessage]]:
        """Join a batch that ends with one topic late and those that follow."""
        held: list[list[RecordedMessage]] = []
        together: list[RecordedMessage] = []
        for batch in batches:
            held.append(batch)
            together += batch
            if self.end_together(together):
                yield together
            elif len(together) >= _MOST_HELD:
                yield from held
            else:
                continue
            held, together = [], []
        yield from held

    def end_together(self, messages: list[RecordedMessage]) -> bool:
        """Return whether the last stamps of both topics are within the limit of lateness."""
        last: dict[bool, int | None] = {}
        for message in reversed(messages):
            last.setdefault(message.topic == self._wrench, self._stamp_ns(message))
            if len(last) == 2:
                break
        wrench_ns, joint_ns = last.get(True), last.get(False)
        if wrench_ns is None or joint_ns is None:
            return False
        return abs(wrench_ns - joint_ns) <= self._limits().timeout_s * 1e9

    def ordered(self, messages: list[RecordedMessage]) -> list[RecordedMessage]:
        """Order messages by stamps, where both topics end and set time back together."""
        if not self.end_together(messages):
            return messages
        topics = {of_wrench: _TopicOrder(of_wrench, self._limits()) for of_wrench in (False, True)}
        for place, message in enumerate(messages):
            stamp_ns = self._stamp_ns(message)
            topics[message.topic == self._wrench].add(place, stamp_ns)
        if topics[False].jumps != topics[True].jumps:
            return messages
        keys = {**topics[False].keys, **topics[True].keys}
        return [messages[place] for place in sorted(keys, key=keys.__getitem__)]

    def _stamp_ns(self, message: RecordedMessage) -> int | None:
        stamp_ns = header_stamp_ns(message.data)
        if stamp_ns is None or message.topic == self._wrench:
            return stamp_ns
        return stamp_ns + round(self._limits().offset * 1e9)


class _TopicOrder:
    """Keys by which the messages of one topic sort, as the pairing screens their stamps."""

    def __init__(self, of_wrench: bool, limits: SynchronisationParameters) -> None:
        self.keys: dict[int, tuple[int, int, bool]] = {}
        self.jumps = 0
        self._of_wrench = of_wrench
        self._newest_ns = BEFORE_ANY
        self._gap_ns = int(limits.maximum_gap_s * 1e9)
        self._jump_ns = int(limits.time_jump_s * 1e9)
        self._offset_ns = 0 if of_wrench else round(limits.offset * 1e9)
        self._screen = StampScreen('', Counter())

    def add(self, place: int, stamp_ns: int | None) -> None:
        """Add the message at a place; one that is rejected sorts with the one before it."""
        self.keys[place] = self.jumps, self._newest_ns, self._of_wrench
        if stamp_ns is None:
            return
        for admitted_ns, at in self._screen.admit(
                (stamp_ns, place), self._newest_ns, BEFORE_ANY, self._gap_ns, self._jump_ns,
                self._offset_ns):
            self.jumps += admitted_ns < self._newest_ns
            self._screen.before_ns, self._newest_ns = self._newest_ns, admitted_ns
            self.keys[at] = self.jumps, admitted_ns, self._of_wrench
