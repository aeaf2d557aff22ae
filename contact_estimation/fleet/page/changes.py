# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Effects that are named from some recording on, and all names over time."""

from __future__ import annotations

from typing import Any

from .figures import plot_names
from .wording import probability, start_of, words
from ..run import Fleet


def prepare(fleet: Fleet) -> dict[str, Any] | None:
    """Return the changes and a figure of all names; None where nothing is named."""
    if not any(entry.families for entry in fleet.entries):
        return None
    return {
        'changes': [
            {'change': change, 'family': words(change.family), 'start': start_of(change.entry),
             'chance': probability(change.chance)}
            for change in fleet.changes
        ],
        'figure': plot_names(fleet.entries),
    }
