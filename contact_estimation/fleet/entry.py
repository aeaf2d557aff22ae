# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""A recording of the fleet with its results, and the order of recordings in time."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Iterable, Sequence

from .discovery import FoundRecording
from .one_recording import Outcome
from ..recordings.bag_folder import natural_order


@dataclass(frozen=True)
class Entry:
    """A recording and its results."""

    name: str  # path as found
    path: str  # absolute path
    group: str  # robot, wall or day
    sha256: str  # of its content; '' if that could not be read
    outcome: Outcome  # results of a worker
    page: str = ''  # page of its diagnosis, relative to the folder of the run; '' if there is none
    number: int = 0  # place in time, from 1

    @classmethod
    def of(cls, found: FoundRecording, sha256: str, outcome: Outcome, page: str) -> 'Entry':
        """Return the entry of a found recording, without its number."""
        return cls(found.name, found.path, found.group, sha256, outcome, page)

    @property
    def report(self) -> dict[str, Any] | None:
        """Return the diagnosis; None if there is none, or if a check refused the recording."""
        report: dict[str, Any] | None = self.outcome['report']
        refused = report is not None and report['fit']['noise_floor_n'] is None
        return None if refused else report

    @property
    def families(self) -> list[str]:
        """Families of the named effects, strongest first."""
        return list(dict.fromkeys(effect['family'] for effect in self.effects))

    @property
    def effects(self) -> list[dict[str, Any]]:
        """Return the named effects."""
        return list(self.report['effects']) if self.report else []

    def corrected(self, name: str) -> tuple[float, float] | None:
        """Return a fitted parameter of the wall."""
        if self.report is None:
            return None
        found = self.report['corrected'][name]
        if found['value'] is None or found['std'] is None:
            return None
        return found['value'], found['std']


def distinct(entries: Iterable[Entry]) -> list[Entry]:
    """Leave out copies: the same content proves nothing a second time."""
    seen: dict[str, Entry] = {}
    for place, entry in enumerate(entries):
        seen.setdefault(entry.sha256 or f'unread {place}', entry)
    return list(seen.values())


def in_time(entries: Iterable[Entry]) -> list[Entry]:
    """Sort recordings by their first stamps, and number them."""
    named = sorted(entries, key=_by_name)
    order = sorted(range(len(named)), key=lambda place: (_start(named, place), place))
    return [replace(named[place], number=number) for number, place in enumerate(order, 1)]


def _by_name(entry: Entry) -> tuple[str, list[tuple[int, str]]]:
    return entry.group, natural_order(entry.name)


def _start(named: Sequence[Entry], place: int) -> float:
    """Return the first stamp [ns], or that between the neighbours of the group that have one."""
    own: int | None = named[place].outcome['start_ns']
    if own is not None:
        return own
    sides = (range(place - 1, -1, -1), range(place + 1, len(named)))
    stamps = [next((named[k].outcome['start_ns'] for k in side
                    if named[k].group == named[place].group
                    and named[k].outcome['start_ns'] is not None), None) for side in sides]
    known = [stamp for stamp in stamps if stamp is not None]
    return sum(known) / len(known) if known else -1.0
