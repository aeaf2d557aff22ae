# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""The walls of earlier in a contact, to go back to where only the zero of the sensor changed."""

from .wall_statistics import WallStatistics


class EarlierWalls:
    """
    The walls of earlier in a contact.

    first, inward: before the first change since the touch, and before the tool moved outward, if
    it does
    changed: whether the wall has changed since the latter
    """

    def __init__(self) -> None:
        self._rate = 0.0
        self.begin()

    def begin(self) -> None:
        """Begin a contact."""
        self.first: WallStatistics | None = None
        self.inward: WallStatistics | None = None
        self.changed = False

    def follow(self, rate: float, present: WallStatistics) -> None:
        """Keep the present wall before a block of a mean rate [m/s] if it begins to go out."""
        self._rate = rate
        if rate > 0.0:
            self.inward = None
        elif rate < 0.0 and self.inward is None:
            self.inward, self.changed = present.copied(), False

    def note_change(self, before: WallStatistics) -> None:
        """Keep the wall before a change if it is the first."""
        self.first, self.changed = self.first or before, True
        if not self._rate:
            self.inward = None
