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

"""Groups that differ from the others."""

from __future__ import annotations

from typing import Any

from .wording import probability, words
from ..differences import differences
from ..run import Fleet
from ..trends import QUANTITIES


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
