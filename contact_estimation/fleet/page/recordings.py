# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""All recordings, by group, with links to their own pages."""

from __future__ import annotations

from typing import Any

from .wording import start_of, words
from ..findings import by_group
from ..run import Fleet
from ..table import Entry


def prepare(fleet: Fleet) -> dict[str, Any]:
    """Return the recordings of each group."""
    groups = by_group(fleet.entries)
    return {'groups': [(group, [_row(entry) for entry in members])
                       for group, members in groups.items()]}


def _row(entry: Entry) -> dict[str, Any]:
    report = entry.outcome['report']
    return {
        'entry': entry, 'start': start_of(entry),
        'verdict': words(report['verdict']) if report else 'error',
        'names': ', '.join(words(effect['name']) for effect in entry.effects),
        'stiffness': entry.corrected('stiffness'), 'damping': entry.corrected('damping'),
    }
