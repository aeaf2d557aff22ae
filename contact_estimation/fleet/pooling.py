# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""One law for a group: several recordings together, each predicted by the others."""

from __future__ import annotations

from typing import Any, NamedTuple, Sequence

import numpy as np

from .findings import by_group, Change
from .fingerprint import Settings
from .one_recording import Outcome, process_pooled
from .table import distinct, Entry
from ..scheduling import Call

_LEAST = 3  # recordings: two to fit and one to leave out


class Pool(NamedTuple):
    """Recordings of a group that are diagnosed together."""

    group: str  # their group
    members: list[Entry]  # spread evenly over time, since the last change of what is named
    since: Change | None  # that change


class PooledResult(NamedTuple):
    """The pooled diagnosis of a group."""

    pool: Pool  # what was diagnosed
    whole: Outcome  # outcome with all members
    page: str  # its page, relative to the folder of the run; '' without
    left_out: list[Outcome]  # outcome of the others, tested on each member


def pools(entries: Sequence[Entry], found: Sequence[Change], most: int) -> list[Pool]:
    """Choose the recordings of each group that are diagnosed together."""
    chosen = []
    for group, members in by_group(entries).items():
        latest = max((change for change in found if change.group == group),
                     key=lambda change: change.number, default=None)
        since = members[latest.number - 1:] if latest else members
        known = [one for one in distinct(since) if one.report is not None]
        if min(len(known), most) >= _LEAST:
            places = np.linspace(0, len(known) - 1, min(most, len(known))).round().astype(int)
            chosen.append(Pool(group, [known[place] for place in places], latest))
    return chosen


def pooled_calls(pool: Pool, settings: Settings, with_page: bool) -> dict[str, Call]:
    """Return the diagnoses of a pool: the whole, then without each member in turn."""
    members = pool.members
    whole = settings.key('pooled', *(one.sha256 for one in members))
    calls = {whole: Call(process_pooled, ([one.path for one in members], [], settings,
                                          with_page))}
    for left_out in members:
        others = [one for one in members if one is not left_out]
        key = settings.key('left out', left_out.sha256, *(one.sha256 for one in others))
        arguments: tuple[Any, ...] = (
            [one.path for one in others], [left_out.path], settings, False)
        calls[key] = Call(process_pooled, arguments)
    return calls
