# Copyright 2026 contact_estimation authors
# SPDX-License-Identifier: Apache-2.0

"""Groups that differ from the others."""

from __future__ import annotations

from typing import Any

from .wording import probability, words
from ..findings import differences, QUANTITIES
from ..run import Fleet


def prepare(fleet: Fleet) -> dict[str, Any] | None:
    """Return a row for each difference; None with a single group."""
    if len({entry.group for entry in fleet.entries}) < 2:
        return None
    return {'rows': [
        {'one': one, 'chance': probability(one.chance),
         'what': ' '.join((QUANTITIES[one.what][0], f'[{QUANTITIES[one.what][1]}]'))
         if one.is_quantity else words(one.what)}
        for one in differences(fleet.entries)
    ]}
