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
