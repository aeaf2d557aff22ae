# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""What waits for its sample: actions, and the references that the robot follows."""

from collections import deque
from typing import Callable

import numpy as np
from numpy.typing import NDArray

from .axes import Moment
from .axis_pipeline import NO_REFERENCE
from ..reference.setpoints import Reference


class Agenda:
    """
    Actions and references in the order of samples, across backward jumps of the clock.

    jumps: backward clock jumps so far
    followed: what the robot follows at the sample for which `apply` was last called
    actions, references: those that wait, with their moments
    """

    def __init__(self) -> None:
        self.jumps, self.followed = 0, NO_REFERENCE
        # As plain tuples moments take a tenth of the time to make.
        self.actions: deque[tuple[Moment, Callable[[], object]]] = deque()
        self.references: deque[tuple[tuple[int, int], Reference]] = deque()

    def change_clock(self) -> None:
        """Follow nothing after a backward jump of the clock."""
        self.jumps += 1
        self.followed = NO_REFERENCE

    def apply(self, stamp_ns: int) -> None:
        """Call the actions that are due before a sample, and follow the newest reference."""
        now, actions, references = (self.jumps, stamp_ns), self.actions, self.references
        while actions and actions[0][0] < now:
            actions.popleft()[1]()
        while references and references[0][0] <= now:
            self.followed = references.popleft()[1]

    def next_due(self, stamps_ns: NDArray[np.int64]) -> int:
        """Return the first sample before which an action or a reference is due."""
        begins = [len(stamps_ns)]
        for waiting, after in ((self.actions, 1), (self.references, 0)):
            if waiting and waiting[0][0][0] == self.jumps:
                begins.append(int(np.searchsorted(stamps_ns, waiting[0][0][1] + after)))
        return min(begins)
