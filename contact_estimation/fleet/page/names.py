# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Which names occur where: effects by group."""

from __future__ import annotations

from typing import Any, Sequence

from .wording import start_of, words
from ..findings import by_group
from ..run import Fleet
from ..table import Entry


def prepare(fleet: Fleet) -> dict[str, Any] | None:
    """Return the counts of each name in each group; None where nothing is named."""
    groups = by_group(fleet.entries)
    names = sorted({effect['name'] for entry in fleet.entries for effect in entry.effects})
    if not names:
        return None
    return {
        'names': [words(name) for name in names],
        'rows': [{'group': group,
                  'diagnosed': sum(entry.report is not None for entry in members),
                  'cells': [_cell(members, name) for name in names]}
                 for group, members in groups.items()],
    }


def _cell(members: Sequence[Entry], name: str) -> dict[str, Any] | None:
    """Return how often a name occurs, and where first."""
    named = [entry for entry in members
             if any(effect['name'] == name for effect in entry.effects)]
    if not named:
        return None
    return {'count': len(named), 'entry': named[0], 'start': start_of(named[0])}
