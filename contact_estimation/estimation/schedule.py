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

"""What takes effect between two samples: events and, in replay, recorded references."""

from __future__ import annotations

from collections import deque
from typing import Callable, NamedTuple

from ..reference.setpoints import Reference


class Moment(NamedTuple):
    """
    The stamp of a sample, unique even where the clock has jumped back.

    Attributes
    ----------
    jumps : int
        Number of backward clock jumps before the sample.
    stamp_ns : int
        Stamp of the sample [ns].

    """

    jumps: int
    stamp_ns: int


class Schedule:
    """
    Queue of actions and of references, each to take effect at a known sample.

    Attributes
    ----------
    actions : deque of (Moment, callable)
        Each is called after the sample of its moment and before the next.
    references : deque of ((int, int), Reference)
        Each is in force from the sample of its moment on.

    """

    def __init__(self) -> None:
        self.actions: deque[tuple[Moment, Callable[[], object]]] = deque()
        self.references: deque[tuple[tuple[int, int], Reference]] = deque()

    def apply_due(self, now: tuple[int, int]) -> Reference | None:
        """
        Call the actions that are due before a sample.

        Parameters
        ----------
        now : (int, int)
            Moment of the sample; as a plain tuple it takes a tenth of the time to make.

        Returns
        -------
        reference : Reference or None
            The newest one in force, None where it has not changed.

        """
        while self.actions and self.actions[0][0] < now:
            self.actions.popleft()[1]()
        newest = None
        while self.references and self.references[0][0] <= now:
            newest = self.references.popleft()[1]
        return newest
