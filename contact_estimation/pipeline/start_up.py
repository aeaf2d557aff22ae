# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The messages that came before an arm was known: refused, and refused in replay too."""

from __future__ import annotations

from ..signals.stamp_screen import BEFORE_ANY


class StartUp:
    """
    Stamps of the last messages that were refused because the arm was not known yet.

    In replay the arm is known from the first message on. What the node refused must be refused
    again, or the estimates differ in their last digits.

    wrench_ns, motion_ns: newest stamps of a wrench and of a motion that were refused [ns]
    """

    def __init__(self, wrench_ns: int = BEFORE_ANY, motion_ns: int = BEFORE_ANY) -> None:
        self.wrench_ns, self.motion_ns = wrench_ns, motion_ns
        self._reported = False

    def refused_wrench(self, stamp_ns: int) -> None:
        """Note a wrench that was refused."""
        self.wrench_ns = max(self.wrench_ns, stamp_ns)

    def refused_motion(self, stamp_ns: int | None) -> None:
        """Note joint states or transforms that were refused; None: without a stamp."""
        if stamp_ns is not None:
            self.motion_ns = max(self.motion_ns, stamp_ns)

    def has_wrench(self, stamp_ns: int) -> bool:
        """Return whether a wrench is one of the refused ones; none is after the first later."""
        if stamp_ns <= self.wrench_ns:
            return True
        self.wrench_ns = BEFORE_ANY  # a clock that jumps back later refuses nothing
        return False

    def has_motion(self, stamp_ns: int) -> bool:
        """Return whether a motion is one of the refused ones; none is after the first later."""
        if stamp_ns <= self.motion_ns:
            return True
        self.motion_ns = BEFORE_ANY
        return False

    def take_report(self) -> dict[str, int]:
        """Return the stamps by name, once and where messages were refused; else nothing."""
        if self._reported or max(self.wrench_ns, self.motion_ns) == BEFORE_ANY:
            return {}
        self._reported = True
        return {'wrench_ns': self.wrench_ns, 'motion_ns': self.motion_ns}
